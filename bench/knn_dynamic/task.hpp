// The task knn_dynamic: the nearest points of a cloud whose points come and go.
//
// Twice n points come, in batches; from the n-th on as many go as come (life.hpp). Timed is a whole life,
// from nothing to the last batch, per operation: a point that comes, a point that goes, a query. Its sets:
//   single, batches128, batches16, batches4: one point a batch, and n in 128, 16 or 4 batches; the oldest go.
//   random16: n in 16 batches; random points go.
//   asked16: as batches16, and the 8 nearest of every point of a batch are asked for after it.
//   knn8_after: queries alone, where batches128 has left off: what is left of their speed.
// Truth: brute force in double over the points that are there at that moment; what has gone is no answer.
// Methods that have no changes of their own build anew after every batch; where points come singly that is
// not waited for.
#pragma once

#include "bench/core/registered_task.hpp"
#include "bench/knn_dynamic/method.hpp"

namespace treeline::bench::knn_dynamic {

class KnnDynamicTask final : public RegisteredTask<Method> {
 public:
  KnnDynamicTask();
  std::string name() const override { return "knn_dynamic"; }
  int version() const override { return 1; }
  std::vector<BlockSpec> blocks(Profile) const override;
  /// Those of the task knn that must be answered and are finite.
  std::vector<BlockSpec> hard_blocks() const override;
  datasets::Kind dataset_kind() const override { return datasets::Kind::cloud; }
  std::unique_ptr<Block> open(const BlockSpec&, const RunContext&) const override;
  /// A cloud, or the vertices of a mesh: half of it is there at a time.
  std::unique_ptr<Block> open(datasets::Dataset, const RunContext&) const override;
  /// Points that come one by one weigh as much as batches; whoever has only one of these reads it alone.
  std::vector<std::string> advise_on() const override { return {"single", "asked16"}; }
};

}  // namespace treeline::bench::knn_dynamic
