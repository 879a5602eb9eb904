// Sums in double precision: no error worth naming for textures, at 8 bytes a value. What squares and moments,
// which cancel, need.
#pragma once

#include "shading/texture/summed_area_table.hpp"

namespace treeline::shading::texture {

struct DoubleSums {
  using Entry = double;

  void sum(const Image& image, Table<Entry>& table, int threads) {
    sum_up(PlainSource<Entry>(image), image, table, threads);
    check_sums(image, table.view());
  }
  double value(double mean, int) const { return mean; }
};

using SatDouble = SummedAreaTable<DoubleSums>;
static_assert(RegionAverager<SatDouble>);

}  // namespace treeline::shading::texture
