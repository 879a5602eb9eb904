// Any index of ours over rows as a method: its own batches, its own work counters, its own limits.
#pragma once

#include "bench/core/registry.hpp"
#include "bench/knn_nd/method.hpp"

namespace treeline::bench::knn_nd {

/// {"epsilon": 0.2}, {"max_rows": 512}; {} is exact.
inline accel::RowSearch search_of(const Knobs& knobs) {
  accel::RowSearch search;
  if (knobs.contains("epsilon")) search.epsilon = knobs.at("epsilon").get<double>();
  if (knobs.contains("max_rows")) search.max_rows = knobs.at("max_rows").get<std::size_t>();
  return search;
}

inline std::vector<Knobs> row_limits(std::initializer_list<int> limits) {
  std::vector<Knobs> r;
  for (const int limit : limits) r.push_back({{"max_rows", limit}});
  return r;
}

template <accel::RowIndex Tree>
class RowsIndex final : public Index {
  using Neighbor = accel::Neighbor<float>;

 public:
  RowsIndex(const Input& input, const typename Tree::Options& options) : tree_(input.rows, options) {}

  void nearest(RowsView queries, std::size_t k, const Knobs& knobs, int threads,
               std::span<Id> ids) const override {
    thread_local std::vector<Neighbor> found;
    found.resize(ids.size());
    tree_.nearest(queries, k, search_of(knobs), std::span<Neighbor>(found), threads);
    for (std::size_t i = 0; i < ids.size(); ++i) ids[i] = found[i].id;
  }
  std::optional<accel::Work> nearest_work(RowsView queries, std::size_t k,
                                          const Knobs& knobs) const override {
    accel::Work work;
    std::vector<Neighbor> found(k);
    for (std::size_t i = 0; i < queries.rows; ++i)
      tree_.nearest(queries[i], k, search_of(knobs), std::span<Neighbor>(found), work);
    return work;
  }

 private:
  Tree tree_;
};

/// Rows that are not finite are left out, as stats().dropped says: answers are right over the rest.
template <class Tree>
std::unique_ptr<Index> build_rows(const Input& input, typename Tree::Options options, const Knobs& knobs) {
  options.non_finite = accel::NonFinite::drop;
  if (knobs.contains("leaf_size")) options.leaf_size = knobs.at("leaf_size").get<int>();
  return std::make_unique<RowsIndex<Tree>>(input, options);
}

}  // namespace treeline::bench::knn_nd
