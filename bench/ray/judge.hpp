// Judging one answer to one ray, in double, against the truth.
//
// An answer is right if it is right for the ray as given (t within s of the truth, where s = eps/|direction|,
// on a triangle that reaches there), or for the same ray moved sideways by at most
//   eps = 32 · unit_roundoff · (largest |coordinate| of the ray's origin and of the triangles involved);
// the latter is called borderline. 32 covers the roundings of a ray test (subtraction of the origin, shear,
// two products, the division; about a dozen) with a factor of two or so to spare. The unit roundoff is
// float's, or double's for methods that claim to be exact; s has half an ulp of a float t added, since
// answers are floats.
//
// Involved are the triangles whose own ray tests must have gone wrong for the answer to come out: the one
// answered, the true one, and whatever else the ray meets before the answered t. A test of one triangle
// rounds differences of the origin and of that triangle's corners (or a point near them) and what follows
// from these, so its error is in proportion to their coordinates; a method that scales the mesh by a power of
// two rounds alike. What lies elsewhere in the mesh does not enter: in a tree the boxes around the triangle
// may be large, but the faces of a box that decide whether its part of the ray is empty are crossed near the
// hit. (A method that moves the mesh's centre to the origin would err by the size of the whole mesh. None
// here does.) So one stray triangle far away gives slack to the rays that meet it, and to no others.
//
// In detail an answer "triangle p at t" is borderline if
//   A. the point at t lies within eps of p, and t within s of [t_min, t_max]; and
//   B. some moved ray meets nothing before t - s.
// An answer "nothing" is borderline if some moved ray meets nothing between t_min + s and t_max - s. The
// moved rays are the ray itself and 48 parallels on three circles around it. Whether a moved ray hits is
// decided exactly. An any-hit answer "yes" is borderline if some triangle comes within its own eps
// of the ray.
//
// Approximate methods test each triangle on its own, so that rays slip between two triangles that share an
// edge, and t comes from terms that cancel for a triangle that is almost edge-on or thin. Such answers are
// false all the same and counted so, but excused: each triangle that was passed by, p apart, is missed by a
// moved ray of its own; and some moved ray hits p, with t within eps of p's plane, times p's longest side
// over its least height, for by so much cancels the determinant that t is divided by.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "bench/ray/method.hpp"
#include "bench/ray/truth.hpp"

namespace treeline::bench::ray {

enum class Verdict {
  right,
  borderline,
  false_hit,        // nothing there
  false_miss,       // passed through a surface
  wrong_t,          // the right triangle at a wrong t
  wrong_primitive,  // the right t on a triangle that is not there
};

struct Judged {
  Verdict verdict = Verdict::right;
  bool excused = false;  // false, but within what an approximate method claims
  double error = 0;  // min(1, |t - t_true| / t_true); 1 for a false hit or miss; borderline: see judge.cpp
  double signed_error = 0;  // (t - t_true) / t_true where both hit; else 0

  bool counts_as_right() const { return verdict == Verdict::right || verdict == Verdict::borderline; }
};

class Judge {
 public:
  /// unit_roundoff: of the arithmetic that the method claims to answer in; largest: largest_coordinate().
  Judge(const geometry::Mesh3f& mesh, double unit_roundoff, double largest)
      : mesh_(mesh), unit_roundoff_(unit_roundoff), largest_(largest) {}
  Judge(const geometry::Mesh3f& mesh, double unit_roundoff)
      : Judge(mesh, unit_roundoff, largest_coordinate(mesh)) {}

  /// The largest magnitude of a finite coordinate of a face's corner.
  static double largest_coordinate(const geometry::Mesh3f& mesh);

  /// ray_number keys a cache of the faces near a ray: use one number per ray.
  Judged closest(std::size_t ray_number, const geometry::Rayf& ray, const TrueHit& truth,
                 const RayAnswer& answer);
  Judged any(std::size_t ray_number, const geometry::Rayf& ray, const TrueHit& truth, bool answer);

  /// What an honest answer may be off by sideways if these triangles are involved; others than the mesh's and
  /// no_id do not count.
  double eps(const geometry::Rayf& ray, std::span<const accel::Id> faces) const;

 private:
  struct Case;
  struct Near {
    double distance = -1;
    std::vector<accel::Id> faces;
  };
  const std::vector<accel::Id>& near(std::size_t ray_number, const Case& c);
  std::vector<accel::Id> faces_near(const geometry::Rayd& ray, double distance);
  void widen(std::size_t ray_number, Case& c, double end);
  bool passes(const Case& c, std::span<const accel::Id> faces, double t_from, double t_to) const;
  bool slips(const Case& c, std::span<const accel::Id> faces, accel::Id answered, double t_from,
             double t_to) const;
  bool touches(const Case& c, accel::Id face) const;
  bool on_face(const Case& c, accel::Id face, double t) const;
  bool on_plane(const Case& c, accel::Id face, double t) const;

  const geometry::Mesh3f& mesh_;
  double unit_roundoff_;
  double largest_;
  std::optional<RunBoxes> boxes_;               // once they are asked for
  std::unordered_map<std::size_t, Near> near_;  // as far off as was asked for yet
};

std::string_view to_string(Verdict);

}  // namespace treeline::bench::ray
