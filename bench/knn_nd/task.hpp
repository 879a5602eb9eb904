// The task knn_nd: which rows of a matrix of many columns are nearest to a query?
//
// Queries are rows of the dataset's own kind that the index does not hold: fresh ones of a recipe, rows held
// out of a file. Asked for the 1, 10 and 100 nearest (the last not in the quick profile), in random order.
// Truth: truth.hpp. Methods: one file for each structure, listed in CMakeLists.txt.
// The charted error is 1 - recall, not the excess of the distances as in the task knn: in many dimensions
// distances draw together, so that even a random row is hardly farther than the nearest (by a fifth among 1e5
// uniform rows of 128 columns) and an index that finds nothing would look right. What users of descriptors
// need is the true neighbours. The excess is kept beside it: metric.hpp.
#pragma once

#include "bench/core/registered_task.hpp"
#include "bench/knn_nd/method.hpp"

namespace treeline::bench::knn_nd {

class KnnNdTask final : public RegisteredTask<Method> {
 public:
  KnnNdTask();
  std::string name() const override { return "knn_nd"; }
  int version() const override { return 1; }
  std::vector<BlockSpec> blocks(Profile) const override;
  std::vector<BlockSpec> hard_blocks() const override;
  datasets::Kind dataset_kind() const override { return datasets::Kind::vectors; }
  std::unique_ptr<Block> open(const BlockSpec&, const RunContext&) const override;
  /// Vectors; or the points of a cloud or the vertices of a mesh, as rows of 3.
  std::unique_ptr<Block> open(datasets::Dataset, const RunContext&) const override;
  std::vector<std::string> advise_on() const override { return {"knn1", "knn10"}; }
};

}  // namespace treeline::bench::knn_nd
