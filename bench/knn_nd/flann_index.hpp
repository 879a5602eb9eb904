// What FLANN's indices share: whole stretches of queries handed over as matrices, its native batch interface.
// `cores` stays 1: the threads are ours, as for every other method. The distance is its L2, whose loop of
// four is compiled with our flags.
#pragma once

#include <flann/flann.hpp>

#include "accel/batch.hpp"
#include "bench/core/registry.hpp"
#include "bench/knn_nd/method.hpp"

namespace treeline::bench::knn_nd {

/// FLANN copies the rows if it reorders them and else refers to them; it never writes to them.
inline flann::Matrix<float> flann_matrix(RowsView rows) {
  return {const_cast<float*>(rows.data), rows.rows, rows.columns, rows.stride * sizeof(float)};
}

/// {"checks": 32}, … The same steps of two as our own limits, so that neither frontier is coarser.
inline std::vector<Knobs> checks_to(int most) {
  std::vector<Knobs> r;
  for (int checks = 32; checks <= most; checks *= 2) r.push_back({{"checks", checks}});
  return r;
}

template <class FlannIndex>
class FlannRows final : public Index {
 public:
  template <class Params>
  FlannRows(const Input& input, const Params& params) : index_(flann_matrix(input.rows), params) {
    index_.buildIndex();
  }

  void nearest(RowsView queries, std::size_t k, const Knobs& knobs, int threads,
               std::span<Id> ids) const override {
    const int checks = knobs.contains("checks") ? knobs.at("checks").get<int>()
                                                : static_cast<int>(flann::FLANN_CHECKS_UNLIMITED);
    const flann::SearchParams params(checks);
    accel::parallel_ranges(queries.rows, threads, [&](std::size_t begin, std::size_t end) {
      constexpr std::size_t stretch = 256;
      std::vector<std::size_t> indices(stretch * k);
      std::vector<float> distances(stretch * k);
      for (; begin < end; begin += stretch) {
        const std::size_t count = std::min(stretch, end - begin);
        std::fill_n(indices.begin(), count * k, std::size_t{accel::no_id});
        flann::Matrix<std::size_t> index_rows(indices.data(), count, k);
        flann::Matrix<float> distance_rows(distances.data(), count, k);
        const RowsView part(queries.data + begin * queries.stride, count, queries.columns, queries.stride);
        index_.knnSearch(flann_matrix(part), index_rows, distance_rows, k, params);
        for (std::size_t i = 0; i < count * k; ++i) ids[begin * k + i] = static_cast<Id>(indices[i]);
      }
    });
  }

 private:
  FlannIndex index_;
};

}  // namespace treeline::bench::knn_nd
