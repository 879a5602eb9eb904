// The truth: the faces above a point, counted exactly.
//
// Method: geometry/exact/column_grid.hpp. A point is inside if the mesh winds around it, which for the meshes
// asked here is the same as an odd number of crossings. Cost: some microseconds a point. The tests hold it
// against sums of solid angles, which share no step with it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/mesh.hpp"

namespace treeline::bench::inside {

enum class Side : std::uint8_t { outside, inside, surface };

/// Faces with a coordinate that is not finite are left out; of points that are not finite it says `surface`,
/// as of those of which either answer is right.
std::vector<Side> true_sides(const geometry::Mesh3f& mesh, std::span<const geometry::Vec3f> points,
                             int threads);

/// How far it is clear what is inside where a mesh meets itself: of points that it winds around 0 times or
/// once every definition says the same; others some call inside and some outside.
struct Clarity {
  std::vector<std::uint8_t> clear;  // 1 or 0 of each point; 1 of those on the surface
  bool less_than_nothing = false;   // some point is wound around a negative number of times
};
Clarity clarity_of(const geometry::Mesh3f& mesh, std::span<const geometry::Vec3f> points, int threads);

}  // namespace treeline::bench::inside
