// The kernels: squared distances of a run of rows from a query, and projections onto a direction.
//
// Rows are padded with zeros to a multiple of 8 scalars and aligned to 64 bytes. Two accumulators of 8 lanes,
// whatever the machine's vectors hold, so that a distance has the same bits on every path of a program: the
// order of the additions is fixed, and each kernel is one function that is never inlined, so that a compiler
// cannot fuse one copy of it and not another.
// Rows are measured to the end. To leave a row once its sum exceeds the k-th best was tried, looking every
// 16, 32, 64 or 128 columns: at 128 clustered columns an exact search then took 150, 119, 107 and 110 µs,
// against 102 without (one core, AVX2).
#pragma once

#include <cstddef>
#include <cstdint>

namespace treeline::accel {

inline constexpr std::size_t row_lanes = 8, row_alignment = 64;

constexpr std::size_t padded_columns(std::size_t columns) {
  return (columns + row_lanes - 1) / row_lanes * row_lanes;
}

template <class T>
struct RowVector {
  using Type __attribute__((vector_size(row_lanes * sizeof(T)))) = T;
};

// A macro, since a function that takes a vector changes its calling convention with the instruction set.
#define TREELINE_ROW_SUM(sum, v)                                                                            \
  {                                                                                                         \
    const auto by4 = __builtin_shufflevector(v, v, 0, 1, 2, 3) + __builtin_shufflevector(v, v, 4, 5, 6, 7); \
    const auto by2 = __builtin_shufflevector(by4, by4, 0, 1) + __builtin_shufflevector(by4, by4, 2, 3);     \
    sum = by2[0] + by2[1];                                                                                  \
  }

/// Writes the squared distances from query to rows places[0] … places[count - 1], or, where places is null, 0
/// … count - 1.
template <class T>
[[gnu::noinline]] void measure_rows(const T* rows, std::size_t stride, const std::uint32_t* places,
                                    std::size_t count, const T* query, T* distances2) {
  using V = typename RowVector<T>::Type;
  const std::size_t vectors = stride / row_lanes;
  const V* const q = reinterpret_cast<const V*>(query);
  for (std::size_t i = 0; i < count; ++i) {
    const V* const p = reinterpret_cast<const V*>(rows + (places ? places[i] : i) * stride);
    V even{}, odd{};
    std::size_t v = 0;
    for (; v + 2 <= vectors; v += 2) {
      const V d = p[v] - q[v], e = p[v + 1] - q[v + 1];
      even += d * d, odd += e * e;
    }
    if (v < vectors) {
      const V d = p[v] - q[v];
      even += d * d;
    }
    const V both = even + odd;
    TREELINE_ROW_SUM(distances2[i], both)
  }
}

/// direction · row, both padded.
template <class T>
[[gnu::noinline]] T project_row(const T* row, const T* direction, std::size_t stride) {
  using V = typename RowVector<T>::Type;
  const V* const p = reinterpret_cast<const V*>(row);
  const V* const n = reinterpret_cast<const V*>(direction);
  const std::size_t vectors = stride / row_lanes;
  V even{}, odd{};
  std::size_t v = 0;
  for (; v + 2 <= vectors; v += 2) even += p[v] * n[v], odd += p[v + 1] * n[v + 1];
  if (v < vectors) even += p[v] * n[v];
  const V both = even + odd;
  T sum;
  TREELINE_ROW_SUM(sum, both)
  return sum;
}

#undef TREELINE_ROW_SUM

}  // namespace treeline::accel
