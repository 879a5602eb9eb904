#include "bench/inside/truth.hpp"

#include "accel/batch.hpp"
#include "geometry/exact/column_grid.hpp"

namespace treeline::bench::inside {

std::vector<Side> true_sides(const geometry::Mesh3f& mesh, std::span<const geometry::Vec3f> points,
                             int threads) {
  const geometry::ColumnGrid columns(mesh);
  std::vector<Side> sides(points.size(), Side::surface);
  accel::parallel_ranges(points.size(), threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (!geometry::is_finite(points[i])) continue;
      const geometry::Enclosure found = columns(points[i]);
      if (!found.on_surface) sides[i] = found.winding != 0 ? Side::inside : Side::outside;
    }
  });
  return sides;
}

}  // namespace treeline::bench::inside
