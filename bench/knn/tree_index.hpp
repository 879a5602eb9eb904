// Any tree of ours (brute force included) as a method: its own batches, its own work counters.
//
// Query knobs: batch (false: a call for each query, as an application without batches would), epsilon and
// leaves (see NearestOptions).
#pragma once

#include "accel/batch.hpp"
#include "accel/concepts.hpp"
#include "bench/core/registry.hpp"
#include "bench/knn/method.hpp"

namespace treeline::bench::knn {

inline bool one_by_one(const Knobs& knobs) {
  return knobs.contains("batch") && !knobs.at("batch").get<bool>();
}

template <class T>
accel::NearestOptions<T> options_of(const Knobs& knobs) {
  accel::NearestOptions<T> options;
  if (knobs.contains("epsilon")) options.epsilon = knobs.at("epsilon").get<double>();
  if (knobs.contains("leaves")) options.max_leaves = knobs.at("leaves").get<std::size_t>();
  return options;
}

template <class Tree>
requires accel::NeighborIndex<Tree> && accel::Inspectable<Tree>
class TreeIndex final : public IndexOf<typename Tree::Scalar> {
  using T = typename Tree::Scalar;
  using Point = typename Tree::Point;
  using Box = typename Tree::Box;
  using Neighbor = accel::Neighbor<T>;

 public:
  /// drawn: false for a second method over a tree that another one shows already.
  TreeIndex(const InputOf<T>& input, const typename Tree::Options& options, bool drawn = true)
      : tree_(input.points, options), drawn_(drawn) {}

  void nearest(std::span<const Point> queries, std::size_t k, const Knobs& knobs, int threads,
               std::span<Id> ids) const override {
    const auto options = options_of<T>(knobs);
    const bool batch = !one_by_one(knobs);
    in_chunks(queries.size(), threads, [&](std::size_t begin, std::size_t end) {
      thread_local std::vector<Neighbor> found;
      found.resize((end - begin) * k);
      if (batch)
        tree_.nearest(queries.subspan(begin, end - begin), k, options, std::span<Neighbor>(found));
      else
        for (std::size_t i = begin; i < end; ++i) {
          const std::span<Neighbor> row(&found[(i - begin) * k], k);
          for (std::size_t n = tree_.nearest(queries[i], k, options, row); n < k; ++n) row[n] = {};
        }
      for (std::size_t i = 0; i < found.size(); ++i) ids[begin * k + i] = found[i].id;
    });
  }

  void within(std::span<const Point> queries, T radius, const Knobs&, int threads,
              Lists<Id>& ids) const override {
    accel::parallel_lists(queries.size(), threads, ids, [&](std::size_t i, std::vector<Id>& list) {
      thread_local std::vector<Neighbor> found;
      tree_.within(queries[i], radius, found);
      const std::size_t before = list.size();
      list.resize(before + found.size());
      for (std::size_t j = 0; j < found.size(); ++j) list[before + j] = found[j].id;
    });
  }

  void inside(std::span<const Box> boxes, const Knobs&, int threads, Lists<Id>& ids) const override {
    tree_.inside(boxes, ids, threads);
  }

  std::optional<Visits> nearest_visits(std::span<const Point> queries, std::size_t k,
                                       const Knobs& knobs) const override {
    Visits visits;
    std::vector<Neighbor> found(k);
    for (const Point& q : queries)
      tree_.nearest(q, k, options_of<T>(knobs), std::span<Neighbor>(found), visits);
    return visits;
  }
  std::optional<Visits> within_visits(std::span<const Point> queries, T radius) const override {
    Visits visits;
    std::vector<Neighbor> found;
    for (const Point& q : queries) found.clear(), tree_.within(q, radius, found, visits);
    return visits;
  }
  std::optional<Visits> inside_visits(std::span<const Box> boxes) const override {
    Visits visits;
    std::vector<Id> found;
    for (const Box& b : boxes) found.clear(), tree_.inside(b, found, visits);
    return visits;
  }

  std::vector<accel::SliceCell> slice(int axis, double offset) const override {
    return drawn_ ? tree_.slice(axis, offset) : std::vector<accel::SliceCell>{};
  }

 private:
  /// Answers are kept as ids alone, as the peers' are; in chunks, so that the distances never leave the
  /// cache.
  template <class F>
  static void in_chunks(std::size_t n, int threads, F&& f) {
    accel::parallel_ranges(n, threads, [&](std::size_t begin, std::size_t end) {
      for (; begin < end; begin += accel::batch_chunk) f(begin, std::min(begin + accel::batch_chunk, end));
    });
  }

  Tree tree_;
  bool drawn_;
};

/// Points that are not finite are left out, as stats().dropped says: answers are right over the rest.
template <class Tree>
std::unique_ptr<IndexOf<typename Tree::Scalar>> build_tree(const InputOf<typename Tree::Scalar>& input,
                                                           typename Tree::Options options, const Knobs& knobs,
                                                           bool drawn = true) {
  options.non_finite = accel::NonFinite::drop;
  if constexpr (requires { options.leaf_size; })
    if (knobs.contains("leaf_size")) options.leaf_size = knobs.at("leaf_size").get<int>();
  return std::make_unique<TreeIndex<Tree>>(input, options, drawn);
}

}  // namespace treeline::bench::knn
