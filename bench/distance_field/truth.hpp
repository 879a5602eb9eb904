// What is true of a mesh: signed distances and first hits, by a tree in double over all faces.
//
// Inside is what the mesh encloses more than 0 times, by the columns of faces above a point, counted exactly
// (geometry/exact/column_grid.hpp): of shells that face the same way all within the outermost, of a mesh that
// is inside out nothing. Where the dataset is a damaged one, the mesh before the damage tells. A second
// witness, all faces one by one and sums of solid angles, agrees in the tests.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "geometry/mesh.hpp"
#include "geometry/ray.hpp"

namespace treeline::bench::distance_field {

class Truth {
 public:
  /// `whole`: the mesh that tells the sides, null where nothing does. Neither is kept.
  Truth(const geometry::Mesh3f& mesh, const geometry::Mesh3f* whole);
  ~Truth();

  bool has_sides() const;
  /// Signed if there are sides, else not negative.
  std::vector<double> distances(std::span<const geometry::Vec3d> points, int threads) const;
  /// Infinite for a miss.
  std::vector<double> hits(std::span<const geometry::Rayf> rays, int threads) const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace treeline::bench::distance_field
