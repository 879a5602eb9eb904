// The task knn: which points of a cloud are nearest, within a radius, or inside a box?
//
// Questions: questions.hpp. Truth: truth.hpp. Errors: metric.hpp. Methods: one file each, listed in
// CMakeLists.txt.
#pragma once

#include "bench/core/registered_task.hpp"
#include "bench/knn/method.hpp"

namespace treeline::bench::knn {

class KnnTask final : public RegisteredTask<Method> {
 public:
  KnnTask();
  std::string name() const override { return "knn"; }
  int version() const override { return 2; }
  std::vector<BlockSpec> blocks(Profile) const override;
  /// Hard cases for points. A query that is not finite has no neighbours: silence and refusal are right.
  std::vector<BlockSpec> hard_blocks() const override;
  std::vector<BlockSpec> scaling_blocks(Profile) const override;
  datasets::Kind dataset_kind() const override { return datasets::Kind::cloud; }
  std::unique_ptr<Block> open(const BlockSpec&, const RunContext&) const override;
  /// A cloud, or the vertices of a mesh.
  std::unique_ptr<Block> open(datasets::Dataset, const RunContext&) const override;
  std::vector<std::string> advise_on() const override { return {"knn8_self", "knn8_off", "radius_self"}; }
  void pictures(const BlockSpec&, const RunContext&, const std::string& folder) const override;
};

}  // namespace treeline::bench::knn
