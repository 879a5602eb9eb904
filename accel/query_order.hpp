// An order of queries in which neighbours in space follow each other, so that one finds in the caches what
// the one before has fetched, and begins near its answer.
//
// The Morton curve through the queries' box (Morton 1966), 1024 cells along its longest side. Cost: some 20
// ns a query, once. Known weakness: a single query far from all others makes the cells large.
#pragma once

#include <span>

#include "accel/bvh/radix_sort.hpp"
#include "geometry/box.hpp"

namespace treeline::accel {

namespace detail {
/// Every third bit, from ten.
inline std::uint32_t spread_by_three(std::uint32_t x) {
  x = (x | x << 16) & 0x030000ffu;
  x = (x | x << 8) & 0x0300f00fu;
  x = (x | x << 4) & 0x030c30c3u;
  return (x | x << 2) & 0x09249249u;
}
}  // namespace detail

/// value: the numbers of the queries, in order along the curve; of those in one cell the lower first. The
/// queries are finite, and at most 2^32.
template <class T>
std::vector<SortItem<std::uint32_t>> along_curve(std::span<const geometry::Vec<T, 3>> queries, int threads) {
  std::vector<SortItem<std::uint32_t>> items(queries.size());
  const BuildTasks tasks(threads);
  tasks.run([&] {
    geometry::Box<double, 3> box;
    for (const auto& q : queries) box.grow(geometry::Vec3d(q));
    double longest = 0;
    for (int k = 0; k < 3; ++k) longest = std::max(longest, box.high[k] - box.low[k]);
    const double cells = longest > 0 ? 1023.999 / longest : 0;
    tasks.pieces(queries.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        std::uint32_t key = 0;
        for (int k = 0; k < 3; ++k) {
          const double cell = (static_cast<double>(queries[i][k]) - box.low[k]) * cells;
          key |= detail::spread_by_three(static_cast<std::uint32_t>(cell)) << k;
        }
        items[i] = {key, static_cast<std::uint32_t>(i)};
      }
    });
    radix_sort(items, tasks);
  });
  return items;
}

}  // namespace treeline::accel
