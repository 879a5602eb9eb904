// Several trilinear probes of one pyramid on a grid: the footprint, whatever its angle, is cut into n x n
// equal parts, and each asks a level of its own size. Cost: eight texels a probe. Known weakness: parts weigh
// the same, so that a Gaussian is a box here; of an oblong footprint the parts are oblong, too, and taken for
// squares of their longer side.
#pragma once

#include "shading/texture/trilinear.hpp"

namespace treeline::shading::texture {

namespace mip {

/// The mean of a grid of parts, n along u and m along v.
template <int channels>
void probe(const MipChain& chain, const Footprint& f, int n, int m, float level, float* out) {
  std::fill_n(out, channels, 0.0f);
  const double k = box_factor(f.shape);
  const float weight = 1.0f / static_cast<float>(n * m);
  for (int j = 0; j < m; ++j)
    for (int i = 0; i < n; ++i) {
      const double a = k * ((2 * i + 1.0) / n - 1), b = k * ((2 * j + 1.0) / m - 1);
      add_trilinear<channels>(chain, static_cast<float>(f.x + a * f.ux + b * f.vx),
                              static_cast<float>(f.y + a * f.uy + b * f.vy), level, weight, out);
    }
}

}  // namespace mip

/// A grid of parts, as many along both axes.
class MultiProbe : public OnMipChain {
 public:
  explicit MultiProbe(const Image& image, int side = 2, double bias = best_bias, int threads = 1)
      : MultiProbe(std::make_shared<const MipChain>(image, threads), side, bias) {}
  explicit MultiProbe(std::shared_ptr<const MipChain> chain, int side = 2, double bias = best_bias)
      : OnMipChain(std::move(chain)), side_(side), bias_(bias) {
    if (side < 1 || side > 64)
      throw InvalidTexture("probes along a side are " + std::to_string(side) + "; it must be 1 to 64");
  }
  void mean(const Footprint& f, float* out) const {
    const mip::Widths w(f);
    const float level = mip::level_of(std::max(w.u, w.v) / side_, bias_);
    with_channels(channels(), [&](auto count) { mip::probe<count>(chain(), f, side_, side_, level, out); });
  }

 private:
  int side_;
  double bias_;
};
static_assert(RegionAverager<MultiProbe>);

}  // namespace treeline::shading::texture
