// Rays aimed at edges that triangles share, and at vertices that triangles surround.
//
// Problem: rays through the middle of triangles tell ray tests apart by rounding only. At a shared edge a
//   test that decides for each of the two triangles by other roundings lets rays through a closed surface.
// Method: draw a face, and a point of one of its edges or one of its corners; look at it from the camera or,
//   where it is hidden, on the silhouette or seen edge-on from there, from above or below it, up to four
//   triangle sizes off. A target will do if the faces at the edge lie on both sides of it as seen from the
//   ray's origin; at a vertex this must hold of every edge there, so that the faces surround it. Then each
//   ray moved a little sideways hits a face, too, and a miss is false beyond doubt. Corners at equal
//   positions count as one.
// Exactness: the direction is the float nearest to target - origin, not normalised, and t = 1 is the target;
//   of a few points of the edge the one is taken whose ray, so rounded, passes nearest to it.
// Cost: O(n log n) to find the faces around each vertex, then a few rays through a tree each.
// Known weakness: where nothing drawn will do (soups, open strips), the ray goes to whatever was drawn
//   first, a rim most often: any answer is right there.
#pragma once

#include <functional>
#include <vector>

#include "accel/concepts.hpp"
#include "geometry/mesh.hpp"
#include "geometry/ray.hpp"

namespace treeline::bench::ray {

using FirstHit = std::function<accel::Hit<float>(const geometry::Rayf&)>;

/// At most `count` rays in random order, at an edge and at a vertex by turns; fewer only if float cannot hold
/// them.
std::vector<geometry::Rayf> edge_rays(const geometry::Mesh3f& mesh, const FirstHit& first_hit,
                                      const geometry::Vec3d& eye, std::size_t count, std::uint64_t seed);

}  // namespace treeline::bench::ray
