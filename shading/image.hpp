// Images: rows of pixels from the top, channels interleaved, linear values. Data only.
#pragma once

#include <cstddef>
#include <vector>

namespace treeline::shading {

struct Image {
  int width = 0, height = 0, channels = 0;
  std::vector<float> values;

  Image() = default;
  Image(int w, int h, int c, float fill = 0)
      : width(w), height(h), channels(c), values(std::size_t(w) * std::size_t(h) * std::size_t(c), fill) {}

  std::size_t index(int x, int y, int channel = 0) const {
    return (std::size_t(y) * std::size_t(width) + std::size_t(x)) * std::size_t(channels) +
           std::size_t(channel);
  }
  float& operator()(int x, int y, int channel = 0) { return values[index(x, y, channel)]; }
  float operator()(int x, int y, int channel = 0) const { return values[index(x, y, channel)]; }
};

}  // namespace treeline::shading
