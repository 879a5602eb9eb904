// Points of run-time dimension, as rows of a dense matrix: descriptors, feature vectors, anything of 2 to a
// few hundred columns. What trees over them are built from, what they are asked, and how far a search may
// cut corners.
//
// In high dimension an exact search costs as much as looking at every row unless the rows fill few of the
// dimensions they live in (Weber, Schek and Blott 1998); hence the limits of RowSearch.
#pragma once

#include <concepts>
#include <cstddef>
#include <limits>
#include <span>

#include "accel/concepts.hpp"

namespace treeline::accel {

/// KdTree<Rows<float>>. T is float or double.
template <class T = float>
struct Rows {
  using Scalar = T;
};

/// A matrix that lies elsewhere: `rows` rows of `columns` scalars, `stride` scalars from one row to the next.
template <class T>
struct RowsView {
  const T* data = nullptr;
  std::size_t rows = 0, columns = 0, stride = 0;

  RowsView() = default;
  RowsView(const T* first, std::size_t row_count, std::size_t column_count, std::size_t row_stride)
      : data(first), rows(row_count), columns(column_count), stride(row_stride) {}
  RowsView(const T* first, std::size_t row_count, std::size_t column_count)
      : RowsView(first, row_count, column_count, column_count) {}

  std::span<const T> operator[](std::size_t i) const { return {data + i * stride, columns}; }
};

/// How far a search may cut corners. As it stands it cuts none.
struct RowSearch {
  static constexpr std::size_t unlimited = std::numeric_limits<std::size_t>::max();

  /// The i-th distance found is at most (1 + epsilon) times the true i-th, but for rounding.
  double epsilon = 0;
  /// Stop after so many leaves or rows, best leaves first, but not before k rows are found. Whatever has not
  /// been seen by then is missed: no bound. Either limit also lets a search pass over what seems far.
  std::size_t max_leaves = unlimited, max_rows = unlimited;

  bool limited() const { return max_leaves != unlimited || max_rows != unlimited; }
};

template <class Primitives>
class Forest;

/// Nearest rows to a query of as many scalars. As NeighborIndex: nearest first, ties by lower id; writes
/// min(k, size) answers to out and returns how many; the batch writes k per query, padded with no_id.
/// Throws InvalidInput for k = 0, a query of the wrong length or that is not finite, limits of 0, a negative
/// epsilon.
template <class I>
concept RowIndex = requires(const I& index, std::span<const typename I::Scalar> q, std::size_t k,
                            std::span<Neighbor<typename I::Scalar>> out, RowsView<typename I::Scalar> queries,
                            const RowSearch& search, int threads, Work& work) {
  { index.nearest(q, k, out) } -> std::same_as<std::size_t>;
  { index.nearest(q, k, out, work) } -> std::same_as<std::size_t>;
  { index.nearest(q, k, search, out) } -> std::same_as<std::size_t>;
  { index.nearest(q, k, search, out, work) } -> std::same_as<std::size_t>;
  index.nearest(queries, k, out, threads);
  index.nearest(queries, k, search, out, threads);
  { index.size() } -> std::same_as<std::size_t>;
  { index.columns() } -> std::same_as<std::size_t>;
  { index.bytes() } -> std::same_as<std::size_t>;
  { index.stats() } -> std::same_as<TreeStats>;
};

}  // namespace treeline::accel
