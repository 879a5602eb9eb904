// How far an answer is off, and whether its method may be.
#pragma once

#include <string_view>

#include "bench/closest_point/method.hpp"
#include "bench/closest_point/truth.hpp"

namespace treeline::bench::closest_point {

enum class Verdict {
  right,
  missing,          // no answer where there is one
  surplus,          // an answer where there is none: an empty mesh, or a query that is not finite
  no_triangle,      // names a triangle that the mesh does not have or that is not finite
  wrong_distance,   // the point answered, or the distance, is nearer or farther than the claim allows
  off_triangle,     // the point answered is farther off the triangle named than the claim allows
  farther_triangle  // another triangle is nearer than the one named by more than the claim allows
};
std::string_view to_string(Verdict);

struct Judged {
  Verdict verdict = Verdict::right;
  /// Over the diagonal: the larger of | |query - point| - true distance | and the point's distance from the
  /// triangle that is named. 1 where there is no answer, or none should be.
  double error = 0;
  double signed_error = 0;    // over the diagonal: |query - point| - true distance
  double off_triangle = 0;    // over the diagonal
  double relative = 0;        // of the distance as the method gives it, at most 1; 0 where the true one is 0
  bool farther = false;       // the triangle named is farther than the nearest, ties apart
  bool much_farther = false;  // by more than 1e-6 of the diagonal
};

/// What a method claims, and in what arithmetic.
struct Promise {
  Claim claim = Claim::exact;
  double roundoff = 0;
  bool names_triangles = true;
  bool in_float = false;  // its answers are floats: what they hold at most, and how near they are at least
};

class Judge {
 public:
  /// The mesh must stay.
  explicit Judge(const geometry::Mesh3f& mesh);

  Judged operator()(const geometry::Vec3f& query, const TrueClosest& truth, const Answer& answer,
                    const Promise& promise) const;
  /// Of the box of the finite triangles; of a single point, its largest coordinate, or 1.
  double diagonal() const { return diagonal_; }
  /// Below this error, over the diagonal, methods that answer in float cannot be told apart.
  double floor() const { return floor_; }

 private:
  const geometry::Mesh3f& mesh_;
  double diagonal_ = 1, floor_ = 0;
};

}  // namespace treeline::bench::closest_point
