// The points that a mesh is asked about.
//
//   near            1e-3 of the diagonal off a random point of a random face, in a random direction
//   near_sorted     the same points along a Morton curve: each near the one before
//   uniform         anywhere in the mesh's box
//   uniform_sorted  the same points along a Morton curve
//   far             two to four diagonals away from the middle of the box, in a random direction
//   centre          within 1e-2 of the diagonal of the middle of the box
//   on_vertex       shares two coordinates with a vertex, the third being anywhere in the box: rays along
//                   that axis meet it
// Unless they are sorted, in random order: our trees put a batch in order by themselves, and peers, which are
// asked one point after the other, gain as much from a caller who does. Faces are drawn by their number, so
// that dense parts are asked as often as they are dense.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "geometry/mesh.hpp"

namespace treeline::bench::inside {

struct PointSet {
  std::string name;
  std::vector<geometry::Vec3f> points;
};

struct SetSizes {
  std::size_t near = 0;  // near, on_vertex: cheap queries, of which many are needed lest caches hold them all
  std::size_t other = 0;  // all others
};

/// About a mesh, which must have a face with finite corners (else std::invalid_argument). `few`: only near
/// and uniform, and not sorted.
std::vector<PointSet> make_point_sets(const geometry::Mesh3f& mesh, const SetSizes& sizes, bool few,
                                      std::uint64_t seed);

/// 64-bit hash of points, for the key of cached truths.
std::uint64_t hash_of(const std::vector<geometry::Vec3f>& points);

}  // namespace treeline::bench::inside
