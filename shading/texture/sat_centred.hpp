// Sums in single precision of the values less about their mean (Hensley et al. 2005): sums of noise then grow
// with the square root of the texels, not with their number. A thousand times nearer for noise, thirty times
// for a ramp, of no use where the texture is bright in one half and dark in the other.
#pragma once

#include "shading/texture/summed_area_table.hpp"

namespace treeline::shading::texture {

struct CentredSums {
  using Entry = float;

  void sum(const Image& image, Table<Entry>& table, int threads) {
    find_middle(image);
    sum_up(CentredSource(image, middle_), image, table, threads);
    check_sums(image, table.view());
  }
  double value(double mean, int channel) const { return double(middle_[channel]) + mean; }

 private:
  /// Any constant near the mean will do: that of some 64 rows.
  void find_middle(const Image& image) {
    double sums[most_channels] = {};
    const int stride = image.height / 64 + 1;
    std::size_t rows = 0;
    for (int y = stride / 2; y < image.height; y += stride, ++rows)
      for (int x = 0; x < image.width; ++x)
        for (int c = 0; c < image.channels; ++c) sums[c] += double(image(x, y, c));
    for (int c = 0; c < most_channels; ++c)
      middle_[c] = static_cast<float>(sums[c] / (double(rows) * image.width));
  }

  float middle_[most_channels] = {};
};

using SatCentred = SummedAreaTable<CentredSums>;
static_assert(RegionAverager<SatCentred>);

}  // namespace treeline::shading::texture
