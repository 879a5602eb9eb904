// Which blocks a run has: those of the profile, or those that --dataset, --block and --stress choose.
#pragma once

#include <vector>

#include "bench/core/options.hpp"

namespace treeline::bench {

/// At least one. Throws UsageError for names, sizes or numbers that match nothing.
std::vector<BlockSpec> select_blocks(const Task&, const Options&);

/// The user's file as a dataset of the task's kind. Throws UsageError with the reader's words.
datasets::Dataset read_input(const std::string& file, datasets::Kind);

}  // namespace treeline::bench
