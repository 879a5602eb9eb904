// One cloud with its questions and their truth, as the harness wants it.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "bench/core/task.hpp"
#include "bench/knn/method.hpp"
#include "datasets_gen/hard/hard_case.hpp"

namespace treeline::bench::knn {

/// What a block asks: at most so many queries in each of the named sets of questions.hpp; no name: in all.
/// With a suffix, "_self" at the end of a set's name becomes it.
struct Asked {
  std::size_t queries = 0;
  std::vector<std::string> sets;
  std::string suffix{};
  bool brute_force = true;  // that, too, is asked
};

/// A block over a cloud or the vertices of a mesh; over its doubles where it has them, for which other
/// methods are offered. Truths are computed when first needed, by all cores, and cached. Methods must outlive
/// the block.
std::unique_ptr<Block> open_block(const std::vector<Method>&, datasets::Dataset, const Asked&,
                                  int task_version, const RunContext&);

/// A block over a hard case. Starts no threads. Where the case must be answered, a refusal is a wrong answer.
std::unique_ptr<Block> open_hard_block(const std::vector<Method>&, datasets::HardCase, int task_version,
                                       const RunContext&);

}  // namespace treeline::bench::knn
