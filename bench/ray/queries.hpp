// The rays that a mesh is asked: what a renderer would cast at it, and what a ray test finds hardest.
//
//   camera      a pinhole camera frames the mesh, strays apart; every second ray is aimed at a random
//               triangle instead, from the camera or, where that misses, from near the triangle; closest hit;
//               coherent (neighbouring pixels follow each other)
//   camera_any  the same rays; any hit
//   diffuse     from what those rays see, a little above the surface, cosine-distributed bounces; closest
//               hit; shuffled, so scattered in origin and direction
//   shadow      from what those rays see to points on a round light above the mesh; any hit before the light
//   edge        at edges that triangles share and vertices that they surround, by turns, as exactly as float
//               can aim; closest hit; scattered (edge_rays.hpp)
// Where a ray misses, the bounce and the shadow ray start from another aimed ray, so that sets over soups and
// open meshes do not run dry. "A little above" is a few ulps of the point and 1e-4 of its triangle.
#pragma once

#include <string>
#include <vector>

#include "geometry/mesh.hpp"
#include "geometry/ray.hpp"

namespace treeline::bench::ray {

struct Camera {
  geometry::Vec3d origin, right, up, forward;  // orthonormal
  double half_width = 0, half_height = 0;      // of the image plane at distance 1

  /// x and y in [0, 1], from the top left of the picture.
  geometry::Rayf ray(double x, double y) const;
};

/// A camera above and beside the mesh that frames its finite corners, the outermost 1 % on each side apart.
Camera frame(const geometry::Mesh3f& mesh, double aspect);

struct RaySet {
  std::string name;
  bool any = false;  // else closest hit
  std::vector<geometry::Rayf> rays;
  std::size_t truth = 0;  // the set whose truth holds for this one too
};

/// Throws std::invalid_argument that names the sets without rays: they would measure nothing, and their rows
/// say that no error was found.
void refuse_empty(const std::vector<RaySet>&);

/// About `count` rays a set (the largest square not above it). Throws std::invalid_argument for a mesh that
/// no ray meets, or that leaves a set empty.
std::vector<RaySet> make_ray_sets(const geometry::Mesh3f& mesh, std::size_t count, std::uint64_t seed,
                                  int threads);

/// 64-bit hash of rays, for the key of cached truths.
std::uint64_t hash_of(const std::vector<geometry::Rayf>& rays);

}  // namespace treeline::bench::ray
