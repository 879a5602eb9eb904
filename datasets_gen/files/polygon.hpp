// Triangles that fill a polygon of a file. Internal to the readers.
//
// Problem: a fan from the first corner fills convex polygons alone; of others it makes triangles that overlap
// and look both ways. Method: the polygon is seen along the axis it faces most (Newell's normal); where some
// corner turns the other way, ears are cut off (Meisters 1975), turns decided exactly. Cost: O(n) for convex
// ones, up to O(n³) for others, whose corners are limited. Known weakness: polygons that do not lie in a
// plane are filled as they look from that side.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "geometry/vec.hpp"

namespace treeline::datasets::files {

/// Corners of triangles, by their numbers in a polygon.
using Filling = std::vector<std::array<std::size_t, 3>>;
/// Corners that a polygon which is not convex may have.
inline constexpr std::size_t most_concave_corners = 1000;

/// n - 2 triangles, those of a fan where that will do (convex, on a
/// line, or not finite). None where there is no way: the outline crosses itself or goes around
/// twice, or has too many corners.
std::optional<Filling> fill_polygon(std::span<const geometry::Vec3f> corners);
/// From the first corner to all others.
Filling fan(std::size_t corners);

}  // namespace treeline::datasets::files
