// The order of a query set along a Morton curve: what a caller does who sorts before asking.
#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <vector>

#include "geometry/box.hpp"

namespace treeline::bench {

/// The order along a Morton curve of 2^16 cells a side over the points' own box: result[i] is the number of
/// the query that comes i-th.
inline std::vector<std::uint32_t> morton_order(const std::vector<geometry::Vec3f>& points) {
  geometry::Box3d box;
  for (const geometry::Vec3f& p : points) box.grow(geometry::Vec3d(p));
  std::vector<std::uint64_t> keys;
  keys.reserve(points.size());
  for (const geometry::Vec3f& p : points) {
    std::uint64_t key = 0;
    for (int k = 0; k < 3; ++k) {
      const double extent = box.high[k] - box.low[k];
      const double share = extent > 0 ? (p[k] - box.low[k]) / extent : 0;
      const auto cell = static_cast<std::uint64_t>(std::clamp(share, 0.0, 1.0) * 65535);
      for (int bit = 0; bit < 16; ++bit) key |= (cell >> bit & 1) << (3 * bit + k);
    }
    keys.push_back(key);
  }
  std::vector<std::uint32_t> order(points.size());
  std::iota(order.begin(), order.end(), 0u);
  std::ranges::stable_sort(order, {}, [&](std::uint32_t i) { return keys[i]; });
  return order;
}

}  // namespace treeline::bench
