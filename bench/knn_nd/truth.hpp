// The right answers: brute force in double over the finite rows.
//
// Differences of floats carry one rounding of 2^-53 in double, and so does each sum: far below any float
// method. Cost: n d per query, vectorised: 1e5 rows of 32 columns in half a millisecond. Weakness: none but
// cost; the tests hold it against whole numbers.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "bench/knn_nd/method.hpp"

namespace treeline::bench::knn_nd {

/// Distances to the k nearest. A query with a NaN has no right answer but nothing: `answerable` 0. From an
/// infinite query every row is infinitely far.
struct Truth {
  std::size_t k = 0;  // columns: min(k asked, finite rows)
  std::vector<std::uint8_t> answerable;
  std::vector<double> distances;  // rows of k, ascending

  std::span<const double> row(std::size_t i) const { return {distances.data() + i * k, k}; }
};

double distance2(std::span<const float> p, std::span<const float> q);
bool is_finite(std::span<const float> row);
bool has_nan(std::span<const float> row);

Truth truth_of(RowsView rows, RowsView queries, std::size_t k, int threads);

/// As bytes, for the truth cache. Throws std::invalid_argument for bytes that are no truth of that many
/// queries.
std::string to_bytes(const Truth&);
Truth truth_from_bytes(std::string_view, std::size_t queries);

}  // namespace treeline::bench::knn_nd
