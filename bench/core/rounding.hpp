// What it costs that a file's coordinates became floats, and what helps: said with the advice. (The reader's
// note says it too, before it is known what will be measured.)
#pragma once

#include <string>

#include "bench/core/task.hpp"

namespace treeline::bench {

/// For a mesh of which float loses more than a millionth of its extent (as georeferenced ones do): what to
/// subtract from its coordinates while they are still doubles, and what float moves them by then. Empty where
/// nothing is worth doing. The number to subtract is round, so that it can be typed and adds no rounding.
std::string format_remedy(const datasets::Dataset& input);

/// Lines below the advice; empty where float holds the coordinates as they are. in_double: the task measured
/// the doubles (Block::in_double).
std::string format_rounding(const datasets::Dataset& input, bool in_double);

}  // namespace treeline::bench
