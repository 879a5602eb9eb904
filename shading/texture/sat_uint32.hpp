// Sums of 16-bit levels in 32-bit integers that wrap: as exact as 64 bits, at the bytes of float. Differences
// modulo 2^32 are right as long as the block's own sum is below it: 65535 * 65536 texels; larger blocks are
// summed in pieces. Levels as of sat_int64.hpp.
#pragma once

#include "shading/texture/summed_area_table.hpp"

namespace treeline::shading::texture {

struct Uint32Sums {
  using Entry = std::uint32_t;

  void sum(const Image& image, Table<Entry>& table, int threads) {
    levels = sum_levels(image, table, threads);
  }
  double value(double mean, int) const { return levels.value(mean); }

  Levels levels;
};

using SatUint32 = SummedAreaTable<Uint32Sums>;
static_assert(RegionAverager<SatUint32>);

}  // namespace treeline::shading::texture
