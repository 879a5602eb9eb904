// Sums in double precision: no error worth naming for textures, at 8 bytes a value. What squares and moments,
// which cancel, need.
#pragma once

#include "shading/texture/summed_area_table.hpp"

namespace treeline::shading::texture {

using DoubleSums = PlainSums<double>;
using SatDouble = SummedAreaTable<DoubleSums>;
static_assert(RegionAverager<SatDouble>);

}  // namespace treeline::shading::texture
