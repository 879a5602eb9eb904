// Rays that come from no camera: through the mesh's box at random, along the axes, and almost in the plane of
// a triangle.
//
// Random rays are the least coherent there are: over a large tree each waits for memory. Axis rays have
// directions with two zeros, of either sign, for which the reciprocals of a slab test are infinite. Grazing
// rays meet triangles whose determinant cancels: t slides along the ray, and a thin triangle is hit or missed
// by rounding.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "accel/concepts.hpp"
#include "geometry/mesh.hpp"
#include "geometry/ray.hpp"

namespace treeline::bench::ray {

/// From one uniform point of the box towards another.
std::vector<geometry::Rayf> random_rays(const geometry::Box3d& box, std::size_t count, std::uint64_t seed);

/// Faces that are finite and have an area, which rays can be aimed at.
std::vector<accel::Id> solid_faces(const geometry::Mesh3f& mesh);

/// At points of random triangles of these faces, along an axis, from half the box's extent outside of it.
/// Triangles that are flat along the axis are passed over while others are drawn.
std::vector<geometry::Rayf> axis_rays(const geometry::Mesh3f& mesh, std::span<const accel::Id> faces,
                                      const geometry::Box3d& box, std::size_t count, std::uint64_t seed);

/// At points of random triangles of these faces from eight of their longest sides off, at angles to their
/// planes that are uniform in the logarithm from 1e-4 to 1e-1.
std::vector<geometry::Rayf> grazing_rays(const geometry::Mesh3f& mesh, std::span<const accel::Id> faces,
                                         std::size_t count, std::uint64_t seed);

}  // namespace treeline::bench::ray
