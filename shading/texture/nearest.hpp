// No filter at all: the texel at the footprint's centre. The least that can be stored and read; what every
// other method is held against. Its build is a plain copy of the texture.
#pragma once

#include "shading/texture/region_averager.hpp"

namespace treeline::shading::texture {

class Nearest {
 public:
  explicit Nearest(const Image& image) { rebuild(image); }
  void rebuild(const Image& image) {
    check_shape(image);
    image_ = image;
  }

  int width() const { return image_.width; }
  int height() const { return image_.height; }
  int channels() const { return image_.channels; }
  std::size_t bytes() const { return image_.values.size() * sizeof(float); }

  void mean(const Footprint& f, float* out) const {
    const auto inside = [](double x, int n) {
      return static_cast<int>(std::clamp(std::floor(x), 0.0, n - 1.0));
    };
    const float* texel = image_.values.data() + image_.index(inside(f.x, width()), inside(f.y, height()));
    for (int c = 0; c < channels(); ++c) out[c] = texel[c];
  }

 private:
  Image image_;
};
static_assert(RegionAverager<Nearest>);

}  // namespace treeline::shading::texture
