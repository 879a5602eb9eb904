// What the trees over rows share beside their rule: the set's box or centre, and the way from a loaded query
// to either search.
#pragma once

#include "accel/rows/row_queries.hpp"
#include "accel/rows/split_direction.hpp"

namespace treeline::accel {

/// The rows' extent along each column.
template <class T>
struct RowBox {
  std::vector<T> low, high;

  explicit RowBox(const RowSet<T>& set) {
    if (set.size() == 0) return;
    low.assign(set.row(0), set.row(0) + set.columns), high = low;
    for (std::size_t i = 1; i < set.size(); ++i)
      for (std::size_t a = 0; a < set.columns; ++a) {
        low[a] = std::min(low[a], set.row(i)[a]);
        high[a] = std::max(high[a], set.row(i)[a]);
      }
  }
};

template <class T, class Visitor, class W>
void search_along_columns(const RowSet<T>& set, std::span<const RowTree<T>> trees, const RowBox<T>& box,
                          const RowSearch& limits, RowScratch<T>& scratch, Visitor& visitor, W& work) {
  const AxisKeys<T> keys{scratch.query.data()};
  RowSearcher searcher(set, limits.limited() ? trees : trees.first(1), limits,
                       limits.limited() && trees.size() > 1, scratch, visitor, work);
  if (limits.limited()) return searcher.best_bin_first(keys);
  scratch.offsets.resize(set.columns);
  T bound = 0;
  for (std::size_t a = 0; a < set.columns; ++a) {
    scratch.offsets[a] = interval_offset(box.low[a], box.high[a], scratch.query[a]);
    bound += scratch.offsets[a] * scratch.offsets[a];
  }
  searcher.depth_first(keys, AxisBounds<T>{scratch.offsets.data()}, 0, bound);
}

/// The origin of projections, and how far rows are from it.
template <class T>
struct RowCentre {
  AlignedScalars<T> at;  // stride scalars
  T radius = 0;          // but for rounding

  explicit RowCentre(const RowSet<T>& set) : at(set.stride) {
    std::vector<double> mean(set.columns, 0);
    for (std::size_t i = 0; i < set.size(); ++i)
      for (std::size_t a = 0; a < set.columns; ++a) mean[a] += static_cast<double>(set.row(i)[a]);
    for (std::size_t a = 0; a < set.columns; ++a)
      at[a] = static_cast<T>(mean[a] / static_cast<double>(std::max<std::size_t>(set.size(), 1)));
    T largest = 0, distance2;
    for (std::uint32_t i = 0; i < set.size(); ++i) {
      measure_rows(set.row(0), set.stride, &i, 1, at.data(), &distance2);
      largest = std::max(largest, distance2);
    }
    radius = std::sqrt(largest);
  }
};

template <class T, class Visitor, class W>
void search_across_directions(const RowSet<T>& set, std::span<const RowTree<T>> trees,
                              const RowCentre<T>& centre, bool copies, const RowSearch& limits,
                              RowScratch<T>& scratch, Visitor& visitor, W& work) {
  scratch.relative.resize(set.stride);
  for (std::size_t a = 0; a < set.stride; ++a) scratch.relative[a] = scratch.query[a] - centre.at[a];
  const DirectionKeys<T> keys{scratch.relative.data(), set.stride};
  RowSearcher searcher(set, limits.limited() ? trees : trees.first(1), limits,
                       copies || (limits.limited() && trees.size() > 1), scratch, visitor, work);
  if (limits.limited()) return searcher.best_bin_first(keys);
  const T length = std::sqrt(project_row(scratch.relative.data(), scratch.relative.data(), set.stride));
  // Underflow may take up to the smallest normal number from each product.
  const T slack = geometry::tolerance::plane_bound<T>(static_cast<int>(set.columns)) *
                      (centre.radius + length) * T(1.01) +
                  static_cast<T>(set.columns) * std::numeric_limits<T>::min();
  searcher.depth_first(keys, DirectionBounds<T>{slack}, 0, T(0));
}

}  // namespace treeline::accel
