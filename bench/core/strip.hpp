// Strips of pictures: configurations of one method that differ in nothing but one knob, from its least to its
// most.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bench/core/row.hpp"

namespace treeline::bench {

/// A method's knobs, and how far off it is with them.
struct Configuration {
  Knobs build, query;
  double error = 0;
};

struct Strip {
  std::string knob;                ///< a number
  std::vector<std::size_t> steps;  ///< places of the configurations, by its value
  double change = 0;               ///< of the error, from the worst step to the best
};

/// The longest that there is of a single knob, the first if several are; nothing where no knob has `least`
/// steps.
std::optional<Strip> strip_of(std::span<const Configuration>, std::size_t least = 3);

/// The knob's value at a step.
const Knobs& value_at(const Configuration&, const std::string& knob);

}  // namespace treeline::bench
