// The points that a mesh is asked about: near it, anywhere, far away, where everything is about as near, and
// where rounding has least to hold on to.
//
//   near           1e-3 of the diagonal off a random point of a random triangle, in a random direction
//   near_sorted    the same points along a Morton curve: each near the one before
//   uniform        anywhere in the mesh's box
//   uniform_sorted the same points along a Morton curve
//   far            two to four diagonals away from the middle of the box, in a random direction
//   centre         within 1e-2 of the diagonal of the middle of the box
//   on_vertex      by turns a vertex itself, a point that shares two coordinates with one, and one that
//   shares
//                  one; the others are moved by up to 1e-3 of the diagonal
// Unless they are sorted, queries are in random order. Triangles are drawn by their number, so that dense
// parts are asked as often as they are dense; triangles that are not finite are asked nowhere.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "bench/closest_point/method.hpp"

namespace treeline::bench::closest_point {

struct PointSet {
  std::string name;
  Queries points{};
  std::size_t truth = 0;  // the set whose truth holds for this one too
  /// Where each query of that set stands in this one; empty: at its own place.
  std::vector<std::uint32_t> place{};
};

struct SetSizes {
  std::size_t near = 0;  // near, on_vertex: cheap queries, of which many are needed lest caches hold them all
  std::size_t other = 0;   // uniform, far
  std::size_t centre = 0;  // the dearest
};

/// The box of the finite triangles; empty if there are none.
geometry::Box3d box_of(const geometry::Mesh3f& mesh);

/// Throws std::invalid_argument for a mesh without a finite triangle.
std::vector<PointSet> make_point_sets(const geometry::Mesh3f& mesh, const SetSizes& sizes,
                                      std::uint64_t seed);

/// 64-bit hash of points, for the key of cached truths.
std::uint64_t hash_of(const std::vector<geometry::Vec3f>& points);

}  // namespace treeline::bench::closest_point
