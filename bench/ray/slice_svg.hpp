// The cells of a tree cut by a plane, as an SVG picture.
#pragma once

#include <string>
#include <vector>

#include "accel/concepts.hpp"

namespace treeline::bench::ray {

/// Deeper cells are darker. Throws std::runtime_error naming the file if it cannot be written.
void write_slice_svg(const std::string& file, const std::vector<accel::SliceCell>& cells);

}  // namespace treeline::bench::ray
