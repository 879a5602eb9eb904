// One pool of points with its lives, its questions and their truth, as the harness wants it.
#pragma once

#include "bench/knn_dynamic/method.hpp"
#include "datasets_gen/hard/hard_case.hpp"

namespace treeline::bench::knn_dynamic {

/// A block over a pool: half of its points are there at a time. Methods must outlive the block.
std::unique_ptr<Block> open_block(const std::vector<Method>&, datasets::Dataset, const RunContext&);

/// A block over a hard case of the task knn, whose points come and go in four batches.
std::unique_ptr<Block> open_hard_block(const std::vector<Method>&, datasets::HardCase, const RunContext&);

}  // namespace treeline::bench::knn_dynamic
