// What the families of hard cases share. One function per family, each in a file of its own name.
// Internal to the library of datasets.
#pragma once

#include "datasets_gen/hard/hard_case.hpp"
#include "datasets_gen/portable.hpp"

namespace treeline::datasets::hard {

std::vector<HardCase> ties_duplicates();
std::vector<HardCase> lines_planes_outliers();
std::vector<HardCase> degenerate_triangles();
std::vector<HardCase> far_from_origin();
std::vector<HardCase> edge_vertex_rays();
std::vector<HardCase> axis_parallel_rays();
std::vector<HardCase> nan_infinity();
std::vector<HardCase> empty_one_kn();
std::vector<HardCase> float_range();
std::vector<HardCase> radius_borders();
std::vector<HardCase> grazing_rays();
std::vector<HardCase> self_intersection();
std::vector<HardCase> box_rays();
std::vector<HardCase> closest_points();

// ---- points --------------------------------------------------------------------------------------------

/// Points uniform in a box.
std::vector<geometry::Vec3f> random_points(std::uint64_t seed, std::size_t n, const Vec3d& low = {0, 0, 0},
                                           const Vec3d& high = {1, 1, 1});
/// Every step-th point of a cloud, as queries from the cloud itself.
std::vector<geometry::Vec3f> every(const std::vector<geometry::Vec3f>& points, std::size_t step);

// ---- meshes --------------------------------------------------------------------------------------------

/// A closed rough sphere of about 20·f² faces, star-shaped about its centre. Its coordinates are multiples of
/// 2^-12, so that the difference of any two is a float, and a ray can be aimed at a vertex without rounding.
geometry::Mesh3f snapped_sphere(std::size_t f, std::uint64_t seed = 1);
inline constexpr double snap = 1.0 / 4096;

/// The square [0,1]² in the plane x = 0 (its sides along y and z) in cells² squares of two triangles each.
geometry::Mesh3f wall(std::uint32_t cells);
/// The surface of [-1,1]³, closed, each side in cells² squares of two triangles.
geometry::Mesh3f cube(std::uint32_t cells);

/// Appends a triangle with corners of its own.
void add_triangle(geometry::Mesh3f& mesh, const geometry::Vec3f& a, const geometry::Vec3f& b,
                  const geometry::Vec3f& c);

// ---- rays ----------------------------------------------------------------------------------------------

/// From points on a sphere of the given radius to points in a ball of a third of it.
std::vector<geometry::Rayf> rays_from_around(std::uint64_t seed, std::size_t n, double radius,
                                             const Vec3d& centre = {0, 0, 0});
/// The ray from a to b, which it reaches at t = 1.
inline geometry::Rayf ray_to(const geometry::Vec3f& a, const geometry::Vec3f& b) {
  return {.origin = a, .direction = b - a};
}

}  // namespace treeline::datasets::hard
