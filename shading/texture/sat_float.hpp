// Sums in single precision: the textbook's table. Half the bytes of double; of random values of mean 1/2 a
// table of 2048² loses 5e-2 (of one texel) to 1e-3 (of 16²) in its last quarter.
#pragma once

#include "shading/texture/summed_area_table.hpp"

namespace treeline::shading::texture {

struct FloatSums {
  using Entry = float;

  void sum(const Image& image, Table<Entry>& table, int threads) {
    sum_up(PlainSource<Entry>(image), image, table, threads);
    check_sums(image, table.view());
  }
  double value(double mean, int) const { return mean; }
};

using SatFloat = SummedAreaTable<FloatSums>;
static_assert(RegionAverager<SatFloat>);

}  // namespace treeline::shading::texture
