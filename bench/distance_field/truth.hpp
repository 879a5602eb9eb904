// What is true of a mesh: signed distances and first hits, by a tree in double over all faces.
//
// The side is that of the closed mesh: where the dataset is a damaged one, of the mesh before the damage. A
// second witness, all faces one by one and the winding number, agrees in the tests.
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

  bool has_sides() const { return has_sides_; }
  /// Signed if there are sides, else not negative.
  std::vector<double> distances(std::span<const geometry::Vec3d> points, int threads) const;
  /// Infinite for a miss.
  std::vector<double> hits(std::span<const geometry::Rayf> rays, int threads) const;

 private:
  struct Trees;
  std::unique_ptr<Trees> trees_;
  bool has_sides_;
};

}  // namespace treeline::bench::distance_field
