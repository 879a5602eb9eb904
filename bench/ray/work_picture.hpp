// Heat maps: what each pixel's ray costs in nodes and triangles, one panel a tree, all in one scale.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "accel/concepts.hpp"
#include "shading/image.hpp"

namespace treeline::bench::ray {

/// Images of one size beside each other, `columns` a row, with a gap between them.
shading::Image beside(std::span<const shading::Image> panels, int columns);

/// Steps (nodes and triangles) from none, black, to `most`, white, by way of blue, red and yellow.
shading::Image heat_map(std::span<const accel::Work> work, int width, int height, double most);

/// The number of steps that all but one in a hundred rays of each panel stay below.
double common_scale(std::span<const std::vector<accel::Work>> panels);

}  // namespace treeline::bench::ray
