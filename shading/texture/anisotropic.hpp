// Trilinear probes along the footprint's longer axis, as many as it is longer than the other one: what
// hardware calls anisotropic filtering (McCormack et al. 1999). Cost: eight texels a probe. Known weakness:
// across the shorter axis there is one probe, whose kernel is a mipmap's; weights are equal, so that a
// Gaussian is a box.
#pragma once

#include "shading/texture/multi_probe.hpp"

namespace treeline::shading::texture {

/// Parts along the longer axis, at most so many; each is a square of the shorter side.
class Anisotropic : public OnMipChain {
 public:
  explicit Anisotropic(const Image& image, int most = 16, double bias = best_bias, int threads = 1)
      : Anisotropic(std::make_shared<const MipChain>(image, threads), most, bias) {}
  explicit Anisotropic(std::shared_ptr<const MipChain> chain, int most = 16, double bias = best_bias)
      : OnMipChain(std::move(chain)), most_(most), bias_(bias) {
    if (most < 1 || most > 256)
      throw InvalidTexture("probes are at most " + std::to_string(most) + "; it must be 1 to 256");
  }
  void mean(const Footprint& f, float* out) const {
    const mip::Widths w(f);
    const double longer = std::max(w.u, w.v), shorter = std::min(w.u, w.v);
    const double parts = std::ceil(longer / shorter - 1e-6);  // a square of rounded sides is one part
    const int n = parts < most_ ? std::max(1, static_cast<int>(parts)) : most_;
    const float level = mip::level_of(std::max(shorter, longer / n), bias_);
    with_channels(channels(), [&](auto count) {
      mip::probe<count>(chain(), f, w.u >= w.v ? n : 1, w.u >= w.v ? 1 : n, level, out);
    });
  }

 private:
  int most_;
  double bias_;
};
static_assert(RegionAverager<Anisotropic>);

}  // namespace treeline::shading::texture
