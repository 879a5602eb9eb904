// One mesh with its queries and their truth: what all methods of the task are asked, and how they are judged.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bench/closest_point/judge.hpp"
#include "bench/closest_point/method.hpp"
#include "bench/closest_point/queries.hpp"
#include "bench/core/mesh_block.hpp"

namespace treeline::bench::closest_point {

struct BlockInput : MeshInput {
  std::vector<PointSet> sets;
  std::size_t judged = SIZE_MAX;  // at most so many queries a set are judged, evenly spread
};

class ClosestPointBlock final : public MeshBlock<BlockInput, Method> {
 public:
  ClosestPointBlock(BlockInput input, const std::vector<Method>& methods);

  std::unique_ptr<Subject> build(std::size_t m, const Knobs& build_knobs, int threads) override;
  Errors check(std::size_t m, const Subject& subject, std::size_t query_set,
               const Knobs& query_knobs) override;
  std::size_t n() const override { return input_.mesh.size(); }
  /// Finds the truth of all sets now, for many who will need it.
  void find_truth();

 private:
  struct Truth {
    std::vector<std::size_t> queries;  // numbers of those judged
    std::vector<TrueClosest> answers;
  };
  const Truth& truth_of(std::size_t query_set);

  std::vector<std::optional<Truth>> truths_;
  Judge judge_;
};

}  // namespace treeline::bench::closest_point
