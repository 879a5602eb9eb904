// One mesh with its queries and their truth: what all methods of the task are asked, and how they are judged.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bench/closest_point/judge.hpp"
#include "bench/closest_point/method.hpp"
#include "bench/closest_point/queries.hpp"

namespace treeline::bench::closest_point {

struct BlockInput {
  geometry::Mesh3f mesh;
  std::vector<PointSet> sets;
  std::uint64_t seed = 0, dataset_hash = 0;
  bool quick = false;             // time is short
  std::size_t judged = SIZE_MAX;  // at most so many queries a set are judged, evenly spread
  int threads = 1;                // for the truth; 1 starts no thread pool
  std::string truth_cache;
  int version = 0;
};

class ClosestPointBlock final : public Block {
 public:
  ClosestPointBlock(BlockInput input, const std::vector<Method>& methods);

  const std::vector<QuerySet>& query_sets() const override { return query_sets_; }
  void warm_up(std::size_t m, int threads) override;
  std::unique_ptr<Subject> build(std::size_t m, const Knobs& build_knobs, int threads) override;
  Errors check(std::size_t m, const Subject& subject, std::size_t query_set,
               const Knobs& query_knobs) override;
  std::size_t n() const override { return input_.mesh.size(); }
  std::uint64_t seed() const override { return input_.seed; }
  std::uint64_t dataset_hash() const override { return input_.dataset_hash; }
  bool quick() const override { return input_.quick; }
  /// Finds the truth of all sets now, for many who will need it.
  void find_truth();

 private:
  struct Truth {
    std::vector<std::size_t> queries;  // numbers of those judged
    std::vector<TrueClosest> answers;
  };
  const Truth& truth_of(std::size_t query_set);

  BlockInput input_;
  const std::vector<Method>& methods_;
  std::vector<QuerySet> query_sets_;
  std::vector<std::optional<Truth>> truths_;
  Judge judge_;
};

}  // namespace treeline::bench::closest_point
