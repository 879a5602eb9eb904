// Sums of 16-bit levels in 64-bit integers: exact, of any block. Textures of 8 or 16 bits lose nothing;
// others are rounded to one of 65536 levels over [0, 1], or over their range where they leave it.
#pragma once

#include "shading/texture/summed_area_table.hpp"

namespace treeline::shading::texture {

struct Int64Sums {
  using Entry = std::int64_t;

  void sum(const Image& image, Table<Entry>& table, int threads) {
    levels = sum_levels(image, table, threads);
  }
  double value(double mean, int) const { return levels.value(mean); }

  Levels levels;
};

using SatInt64 = SummedAreaTable<Int64Sums>;
static_assert(RegionAverager<SatInt64>);

}  // namespace treeline::shading::texture
