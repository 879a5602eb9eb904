// The mean by its definition: every texel times the area that the footprint covers of it, in double. Right
// for every footprint; O(texels) a query. Boxes along the axes go row by row, whole texels without a product.
#pragma once

#include <algorithm>
#include <cstring>

#include "shading/texture/coverage.hpp"
#include "shading/texture/region_averager.hpp"
#include "shading/texture/texel_runs.hpp"

namespace treeline::shading::texture {

class BruteForce {
 public:
  explicit BruteForce(const Image& image) { rebuild(image); }
  void rebuild(const Image& image) {
    check_shape(image);
    check_finite(image);
    image_ = image;
  }

  int width() const { return image_.width; }
  int height() const { return image_.height; }
  int channels() const { return image_.channels; }
  std::size_t bytes() const { return image_.values.size() * sizeof(float); }

  void mean(const Footprint& f, float* out) const {
    with_channels(channels(), [&](auto count) {
      double sums[count] = {};
      const bool flat = f.shape == Shape::box && f.aligned();
      if (flat || !sum_all<count>(f, sums))
        sum_rows<count>(flat ? bounding_box(f) : Box{f.x, f.y, f.x, f.y}, sums);
      for (int c = 0; c < count; ++c) out[c] = static_cast<float>(sums[c]);
    });
  }

 private:
  /// The sum over pixels [begin, end) of a row. Eight lanes at a time where they hold whole pixels.
  template <int channels>
  static void sum_run(const float* row, int begin, int end, double (&sums)[channels]) {
    int x = begin;
    if constexpr (channels != 3) {
      typedef float Floats __attribute__((vector_size(32)));
      typedef double Doubles __attribute__((vector_size(64)));
      constexpr int pixels = 8 / channels;
      Doubles all{};
      for (; x + pixels <= end; x += pixels) {
        Floats v;
        std::memcpy(&v, row + x * channels, sizeof v);
        all += __builtin_convertvector(v, Doubles);
      }
      for (int i = 0; i < 8; ++i) sums[i % channels] += all[i];
    }
    for (; x < end; ++x)
      for (int c = 0; c < channels; ++c) sums[c] += double(row[x * channels + c]);
  }

  template <int channels>
  void sum_rows(const Box& box, double (&sums)[channels]) const {
    const TexelRuns across = texel_runs(box.x0, box.x1, width()), down = texel_runs(box.y0, box.y1, height());
    for (std::size_t j = 0; j < 3; ++j)
      for (int y = down.edge[j]; y < down.edge[j + 1]; ++y)
        for (std::size_t i = 0; i < 3; ++i) {
          double run[channels] = {};
          sum_run<channels>(image_.values.data() + image_.index(0, y), across.edge[i], across.edge[i + 1],
                            run);
          for (int c = 0; c < channels; ++c) sums[c] += down.weight[j] * across.weight[i] * run[c];
        }
  }

  /// False if no texel is covered.
  template <int channels>
  bool sum_all(const Footprint& f, double (&sums)[channels]) const {
    const double right = width() - 1, low = height() - 1;
    const double whole = for_each_texel(f, [&](double i, double j, double weight) {
      const auto x = static_cast<int>(std::clamp(i, 0.0, right)),
                 y = static_cast<int>(std::clamp(j, 0.0, low));
      const float* texel = image_.values.data() + image_.index(x, y);
      for (int c = 0; c < channels; ++c) sums[c] += weight * double(texel[c]);
    });
    if (!(whole > 0)) return false;
    for (double& s : sums) s /= whole;
    return true;
  }

  Image image_;
};
static_assert(RegionAverager<BruteForce>);

}  // namespace treeline::shading::texture
