// The rows a tree keeps: a padded, aligned copy with ids, in the order of its leaves. Coordinates are finite;
// bad rows are refused or dropped on the way in.
//
// Range: rows so large or so small that squared distances would overflow or vanish are scaled by a power of
// two, which is exact but for coordinates that underflow. With u the magnitude of a typical row and no row
// beyond 2^60 u, distances of 2^-48 u and more come out right in float (2^500 and 2^-400 in double); rows
// that are nearer yet may tie. Queries so far away that their distances overflow have the rows ranked one by
// one in a wider type.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <new>
#include <string>
#include <vector>

#include "accel/point_set.hpp"
#include "accel/rows/distance.hpp"
#include "accel/rows/rows.hpp"

namespace treeline::accel {

/// Puts vectors of scalars where the kernels want them.
template <class T>
struct RowAllocator {
  using value_type = T;
  RowAllocator() = default;
  template <class U>
  RowAllocator(const RowAllocator<U>&) {}
  T* allocate(std::size_t n) {
    return static_cast<T*>(::operator new(n * sizeof(T), std::align_val_t(row_alignment)));
  }
  void deallocate(T* p, std::size_t) { ::operator delete(p, std::align_val_t(row_alignment)); }
  bool operator==(const RowAllocator&) const = default;
};
template <class T>
using AlignedScalars = std::vector<T, RowAllocator<T>>;

template <class T>
struct RowSet {
  static constexpr std::size_t largest_size = (std::size_t{1} << 31) - 1, largest_columns = 1 << 16;
  /// Between scaled coordinates below 2^this, squared distances of 2^16 columns stay finite.
  static constexpr int largest_exponent = std::numeric_limits<T>::max_exponent / 2 - 10;
  using Wide = typename SquareType<T>::Type;

  std::size_t columns = 0, stride = 0, dropped = 0;
  std::vector<Id> ids;
  AlignedScalars<T> scalars;
  T scale = 1, inverse_scale = 1;  // powers of two; scalars are the rows' times scale

  RowSet(RowsView<T> rows, const BuildOptions& options) : columns(rows.columns) {
    check(rows, options);
    stride = padded_columns(columns);
    ids.reserve(rows.rows);
    for (std::size_t i = 0; i < rows.rows; ++i) {
      if (finite(rows[i])) {
        ids.push_back(static_cast<Id>(i));
      } else if (options.non_finite == NonFinite::refuse) {
        throw InvalidInput("row " + std::to_string(i) + " has a coordinate that is not finite");
      } else {
        ++dropped;
      }
    }
    if (dropped > 0) ids.shrink_to_fit();
    choose_scale(rows);
    scalars.assign(ids.size() * stride, T(0));
    for (std::size_t i = 0; i < ids.size(); ++i) load(rows[ids[i]], scalars.data() + i * stride);
  }

  std::size_t size() const { return ids.size(); }
  const T* row(std::size_t i) const { return scalars.data() + i * stride; }
  std::size_t bytes() const { return ids.capacity() * sizeof(Id) + scalars.capacity() * sizeof(T); }

  /// Copies and scales one row of as many columns; what lies between columns and stride must be 0.
  void load(std::span<const T> from, T* to) const {
    for (std::size_t a = 0; a < columns; ++a) to[a] = from[a] * scale;
  }
  /// Whether all distances from a loaded query are finite.
  bool in_range(const T* query) const {
    const T limit = std::ldexp(T(1), largest_exponent);
    return std::all_of(query, query + columns, [&](T x) { return std::abs(x) < limit; });
  }
  T unscaled_square(T distance2) const { return distance2 * inverse_scale * inverse_scale; }

  /// The rows in another order: order[i] is the present place of the row that comes to place i.
  void reorder(const std::vector<std::uint32_t>& order) {
    AlignedScalars<T> moved(scalars.size());
    std::vector<Id> moved_ids(ids.size());
    for (std::size_t i = 0; i < order.size(); ++i) {
      std::copy_n(row(order[i]), stride, moved.data() + i * stride);
      moved_ids[i] = ids[order[i]];
    }
    scalars = std::move(moved), ids = std::move(moved_ids);
  }

  /// All rows by distance in the wider type, from a query that is neither scaled nor padded: the k best.
  void rank_widely(std::span<const T> query, std::span<Neighbor<T>> out) const {
    std::vector<std::pair<Wide, Id>> all(size());
    for (std::size_t i = 0; i < size(); ++i) {
      Wide sum = 0;
      for (std::size_t a = 0; a < columns; ++a) {
        const Wide d = static_cast<Wide>(row(i)[a]) * static_cast<Wide>(inverse_scale) - query[a];
        sum += d * d;
      }
      all[i] = {sum, ids[i]};
    }
    const auto end = all.begin() + static_cast<std::ptrdiff_t>(out.size());
    std::partial_sort(all.begin(), end, all.end());
    for (std::size_t i = 0; i < out.size(); ++i) {
      const bool fits = all[i].first <= static_cast<Wide>(std::numeric_limits<T>::max());
      out[i] = {fits ? static_cast<T>(all[i].first) : std::numeric_limits<T>::infinity(), all[i].second};
    }
  }

  static bool finite(std::span<const T> row) {
    return std::all_of(row.begin(), row.end(), [](T x) { return std::isfinite(x); });
  }

 private:
  static void check(const RowsView<T>& rows, const BuildOptions& options) {
    if (options.leaf_size < 1)
      throw InvalidInput("leaf_size is " + std::to_string(options.leaf_size) + "; it must be at least 1");
    if (rows.columns == 0) throw InvalidInput("rows have 0 columns; they must have at least 1");
    if (rows.columns > largest_columns)
      throw InvalidInput("rows have " + std::to_string(rows.columns) + " columns; they may have " +
                         std::to_string(largest_columns));
    if (rows.stride < rows.columns && rows.rows > 1)
      throw InvalidInput("stride is " + std::to_string(rows.stride) + "; it must be at least the " +
                         std::to_string(rows.columns) + " columns");
    if (rows.rows > largest_size)
      throw InvalidInput(std::to_string(rows.rows) + " rows; a tree holds at most " +
                         std::to_string(largest_size));
  }

  void choose_scale(const RowsView<T>& rows) {
    using Limits = std::numeric_limits<T>;
    constexpr int high = largest_exponent - 1;
    constexpr int low = Limits::min_exponent / 2 + 2 * Limits::digits;  // gaps may be 2^-2digits of the whole
    T largest = 0;
    std::vector<T> sample;
    const std::size_t step = ids.size() / 1024 + 1;
    for (std::size_t i = 0; i < ids.size(); ++i) {
      T magnitude = 0;
      for (const T x : rows[ids[i]]) magnitude = std::max(magnitude, std::abs(x));
      largest = std::max(largest, magnitude);
      if (magnitude > 0 && i % step == 0) sample.push_back(magnitude);
    }
    if (largest == 0) return;
    if (sample.empty()) sample.push_back(largest);
    const auto middle = sample.begin() + static_cast<std::ptrdiff_t>(sample.size() / 2);
    std::nth_element(sample.begin(), middle, sample.end());
    const int typical = std::ilogb(*middle), highest = std::ilogb(largest);
    int shift = typical < low ? std::min(-typical, Limits::max_exponent - 2) : 0;
    shift = std::min(shift, high - highest);  // outliers, too, must be told from infinity
    scale = std::ldexp(T(1), shift), inverse_scale = std::ldexp(T(1), -shift);
  }
};

}  // namespace treeline::accel
