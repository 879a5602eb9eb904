#include "bench/inside/truth.hpp"

#include <atomic>

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

Clarity clarity_of(const geometry::Mesh3f& mesh, std::span<const geometry::Vec3f> points, int threads) {
  const geometry::ColumnGrid columns(mesh);
  Clarity r{std::vector<std::uint8_t>(points.size(), 1)};
  std::atomic<bool> less = false;
  accel::parallel_ranges(points.size(), threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (!geometry::is_finite(points[i])) continue;
      const geometry::Enclosure found = columns(points[i]);
      if (found.on_surface) continue;
      r.clear[i] = found.winding == 0 || found.winding == 1;
      if (found.winding < 0) less = true;
    }
  });
  r.less_than_nothing = less;
  return r;
}

}  // namespace treeline::bench::inside
