// The rays that a mesh is asked: what a renderer would cast at it, and what a ray test finds hardest.
//
//   camera           a pinhole camera frames the mesh, strays apart; every second ray is aimed at a random
//                    triangle instead, from the camera or, where that misses, from near the triangle; closest
//                    hit; coherent (neighbouring pixels follow each other)
//   camera_shuffled  the same rays in random order: what coherence is worth
//   camera_any       the same rays; any hit
//   diffuse          from what those rays see, a little above the surface, cosine-distributed bounces;
//   closest
//                    hit; neighbouring origins, scattered directions
//   bounce2          the same from what the diffuse rays meet, in random order: scattered in both
//   random           through two random points of the mesh's box, from the first one on; closest hit
//   shadow           from what the camera's rays see to points on a round light above the mesh; any hit
//   before
//                    the light
//   axis             parallel to an axis, the other components 0 or -0, at a random triangle, from outside
//                    (stray_rays.hpp)
//   grazing          1e-4 to 1e-1 rad above a random triangle's plane, at a point of it (stray_rays.hpp)
//   edge             at edges that triangles share and vertices that they surround, by turns, as exactly as
//                    float can aim; closest hit; scattered (edge_rays.hpp)
// Where a ray misses, the bounce and the shadow ray start from another aimed ray, so that sets over soups and
// open meshes do not run dry. "A little above" is a few ulps of the point and 1e-4 of its triangle.
#pragma once

#include <cstdint>
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

/// The box from the 1 % to the 99 % quantile of the triangles' corners, a hundredth wider: one stray triangle
/// far away must not shrink the mesh to a dot.
geometry::Box3d robust_box(const geometry::Mesh3f& mesh);

/// A camera above and beside the mesh that frames its finite corners, the outermost 1 % on each side apart.
Camera frame(const geometry::Mesh3f& mesh, double aspect);

/// About `count` rays through the camera's picture, jittered, neighbours after each other.
std::vector<geometry::Rayf> primary_rays(const Camera& camera, std::size_t count, std::uint64_t seed);

/// How a method comes by an index over moved vertices: by building anew, or by refitting the one over the
/// mesh as it was.
enum class Update { none, rebuild, refit };

struct RaySet {
  std::string name;
  bool any = false;  // else closest hit
  std::vector<geometry::Rayf> rays{};
  std::size_t truth = 0;  // the set whose truth holds for this one too
  std::vector<std::uint32_t>
      place{};            // where each ray of that set stands in this one; empty: at its own place
  std::size_t frame = 0;  // of the moving mesh; 0: as it was built
  Update update = Update::none;
  bool outward = false;  // from a convex surface outward: a hit is a hit of the surface that the ray leaves
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
