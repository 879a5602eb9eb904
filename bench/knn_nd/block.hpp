// Rows with their questions and the truth, as the harness wants them.
#pragma once

#include <memory>
#include <vector>

#include "bench/core/task.hpp"
#include "bench/knn_nd/method.hpp"

namespace treeline::bench::knn_nd {

struct Questions {
  struct Set {
    std::string name;
    std::size_t k = 1;
  };
  std::vector<Set> sets;  // all asked at the same queries
  datasets::Vectors rows;
  bool hard = false;         // starts no threads and caches nothing
  bool must_answer = false;  // a refusal is a wrong answer
};

/// A block over vectors. The truth is computed when first needed, by all cores, and cached. Methods must
/// outlive the block.
std::unique_ptr<Block> open_block(const std::vector<Method>&, datasets::Dataset, Questions, int task_version,
                                  const RunContext&);

}  // namespace treeline::bench::knn_nd
