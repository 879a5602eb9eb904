// The right answers to a sample of a query set, by DoubleScan, and the sample itself.
#pragma once

#include <string>
#include <type_traits>
#include <vector>

#include "bench/knn/double_scan.hpp"

namespace treeline::bench::knn {

/// Numbers of `count` queries out of `size`, evenly spread.
std::vector<std::uint32_t> spread_sample(std::size_t size, std::size_t count);

/// How many queries to check among n points: all where that costs little, at least 100.
std::size_t checked_queries(std::size_t n, std::size_t queries);

/// Distances to the k nearest. A query with a NaN has no right answer but nothing: `answerable` 0. From an
/// infinite query every point is infinitely far.
struct NearestTruth {
  std::size_t k = 0;                  // columns: min(k asked, finite points)
  std::vector<std::uint32_t> sample;  // query numbers
  std::vector<std::uint8_t> answerable;
  std::vector<double> distances;  // sample.size() rows of k, ascending

  std::span<const double> row(std::size_t i) const { return {distances.data() + i * k, k}; }
};

/// Ids that a radius or box query must and may return.
struct RangeTruth {
  std::vector<std::uint32_t> sample;
  std::vector<std::uint8_t> answerable;
  std::vector<RangeAnswer> answers;
};

template <class T>
using Queries = std::span<const std::type_identity_t<geometry::Vec<T, 3>>>;
template <class T>
using Boxes = std::span<const std::type_identity_t<geometry::Box<T, 3>>>;

template <class T>
NearestTruth nearest_truth(const ScanOf<T>&, Queries<T> queries, std::size_t k,
                           std::vector<std::uint32_t> sample, int threads);
template <class T>
RangeTruth within_truth(const ScanOf<T>&, Queries<T> queries, double radius,
                        std::vector<std::uint32_t> sample, int threads);
template <class T>
RangeTruth inside_truth(const ScanOf<T>&, Boxes<T> boxes, std::vector<std::uint32_t> sample, int threads);

/// As bytes, for the truth cache. from_bytes throws std::invalid_argument for bytes that are not such a
/// truth.
std::string to_bytes(const NearestTruth&);
std::string to_bytes(const RangeTruth&);
NearestTruth nearest_from_bytes(std::string_view);
RangeTruth range_from_bytes(std::string_view);

}  // namespace treeline::bench::knn
