// What theory says that a table of running sums loses in rounding: the figure beside the measured error.
#pragma once

#include <optional>
#include <span>

#include "bench/region_average/method.hpp"

namespace treeline::bench::region_average {

struct Figure {
  double value;  ///< RMS error of the means that are asked for, in the texture's unit
  double slack;  ///< four standard deviations of what is measured, as so many means are asked for
};

/// Of a table in T = float whose texels are independent of each other, of mean `mean` > 0, for boxes of whole
/// texels inside of the texture. Nothing for other footprints.
///
/// An entry (x, j) is that above it and the sum of row j's first x texels. That addition is rounded once, by
/// an error that is even over the spacing u of floats at mean · x j, the size of the sum; what the row's own
/// sum lost before is smaller by about j. Over h rows of a box two columns' errors add up, 2 h of variance
/// u²/12 each; those of the rows above are in both of the column's entries and cancel. So a mean of w x h
/// texels is off by u √(h/6)/(w h): 0.41 u for a texel. As u grows with the sum, twice the sides lose four
/// times as much.
std::optional<Figure> rounding_of_sums(std::span<const Footprint>, double mean);

}  // namespace treeline::bench::region_average
