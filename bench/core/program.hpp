// The parts of a benchmark program that need no timing; run_program() in task.hpp is the whole.
#pragma once

#include <string>

#include "bench/core/options.hpp"

namespace treeline::bench {

/// --list: every block and method with its knobs, one per line.
std::string format_list(const Task&, const Options&);

}  // namespace treeline::bench
