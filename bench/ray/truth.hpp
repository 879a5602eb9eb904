// The truth of a ray query: every triangle tried, without an error.
//
// Problem: rays through shared edges and vertices are decided by the sign of a triple product that may be
// zero; in double its rounding can decide either way.
// Method: brute force. Runs of faces whose box is passed by are left out, which is most of them where faces
// of like numbers are neighbours; of the rest, a double filter throws out the triangles whose edge signs are
// certain and mixed; what is left is decided, and t is rounded once, by geometry/exact/ray_triangle.hpp, for
// coordinates of any size.
// Cost: n / 64 boxes a ray, about 10 ns each; at most n filters of about 1 ns; some 100 ns for each triangle
// left.
//
// Conventions, the same for every judge and oracle of this task:
//   - triangles are closed sets, hit from both sides; a ray is the closed interval [t_min, t_max];
//   - a ray in the plane of a triangle does not hit it, and a triangle of no area is never hit;
//   - a triangle with a coordinate that is not finite is left out; a ray that is not finite hits nothing.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "accel/concepts.hpp"
#include "geometry/mesh.hpp"
#include "geometry/ray.hpp"

namespace treeline::bench::ray {

struct TrueHit {
  double t = std::numeric_limits<double>::infinity();
  accel::Id primitive = accel::no_id;  // ties: the lowest id

  explicit operator bool() const { return primitive != accel::no_id; }
  bool operator==(const TrueHit&) const = default;
};

/// The nearest hit of one ray in double coordinates among the given faces of the mesh.
TrueHit exact_closest(const geometry::Mesh3f& mesh, std::span<const accel::Id> faces,
                      const geometry::Rayd& ray);

/// The nearest hit of each ray among all triangles. threads = 1 starts no thread pool.
std::vector<TrueHit> true_closest(const geometry::Mesh3f& mesh, std::span<const geometry::Rayf> rays,
                                  int threads);

/// Boxes of runs of faces, by their numbers.
class RunBoxes {
 public:
  static constexpr std::size_t run = 64;  // faces

  explicit RunBoxes(const geometry::Mesh3f& mesh);

  std::size_t size() const { return boxes_.size(); }
  /// Whether the line of the finite ray may come within a distance of a finite face of run i: where not, it
  /// is certain.
  bool may_pass(std::size_t i, const geometry::Rayd& ray, double distance) const;

 private:
  std::vector<geometry::Box3d> boxes_;
};

/// Faces that come within a distance of the ray's line (a superset), and are finite: what a moved ray may
/// hit. `boxes` are of the mesh.
std::vector<accel::Id> faces_near(const geometry::Mesh3f& mesh, const RunBoxes& boxes,
                                  const geometry::Rayd& ray, double distance);

}  // namespace treeline::bench::ray
