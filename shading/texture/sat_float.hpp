// Sums in single precision: the textbook's table. Half the bytes of double; of random values of mean 1/2 a
// table of 2048² loses 5e-2 (of one texel) to 1e-3 (of 16²) in its last quarter.
#pragma once

#include "shading/texture/summed_area_table.hpp"

namespace treeline::shading::texture {

using FloatSums = PlainSums<float>;
using SatFloat = SummedAreaTable<FloatSums>;
static_assert(RegionAverager<SatFloat>);

}  // namespace treeline::shading::texture
