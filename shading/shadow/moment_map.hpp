// Moments of a depth map that have been averaged beforehand: what variance, exponential and moment shadow
// maps are made of. K numbers a texel, blurred once, read with four texels' interpolation.
//
// Cost: 4 K bytes a texel; a blur of radius r adds 2 (2 r + 1) K operations a texel, summed anew for each (a
// running sum would leave the rounding of large exponentials behind in small ones). Known weakness: the
// filter has one width for all receivers.
#pragma once

#include <array>
#include <cmath>
#include <vector>

#include "shading/shadow/bias.hpp"

namespace treeline::shading::shadow {

/// The four texels whose centres are around a point, and the weights of bilinear interpolation; at the map's
/// border, the border's own.
struct TexelSquare {
  std::size_t index[4];
  float weight[4];

  TexelSquare(const MapPoint& m, int width, int height) {
    const float u = m.fx - 0.5f, v = m.fy - 0.5f;
    const int left = u < 0 ? m.x - 1 : m.x, top = v < 0 ? m.y - 1 : m.y;
    const float a = u < 0 ? u + 1 : u, b = v < 0 ? v + 1 : v;
    const auto x0 = std::size_t(std::max(left, 0)), x1 = std::size_t(std::min(left + 1, width - 1));
    const auto y0 = std::size_t(std::max(top, 0)), y1 = std::size_t(std::min(top + 1, height - 1));
    const auto w = std::size_t(width);
    index[0] = y0 * w + x0, index[1] = y0 * w + x1, index[2] = y1 * w + x0, index[3] = y1 * w + x1;
    weight[0] = (1 - a) * (1 - b), weight[1] = a * (1 - b), weight[2] = (1 - a) * b, weight[3] = a * b;
  }
};

template <int K>
struct MomentMap {
  LightView view;
  int width = 0, height = 0;
  int radius = 0;             ///< of the box it was blurred with, in texels
  std::vector<float> values;  ///< K a texel, row after row

  std::size_t bytes() const { return values.size() * sizeof(float); }
  std::array<float, K> around(const MapPoint& m) const {
    const TexelSquare s(m, width, height);
    const float* texel[4];
    for (int i = 0; i < 4; ++i) texel[i] = values.data() + std::size_t(K) * s.index[i];
    std::array<float, K> out;
    for (std::size_t k = 0; k < K; ++k)
      out[k] = s.weight[0] * texel[0][k] + s.weight[1] * texel[1][k] + s.weight[2] * texel[2][k] +
               s.weight[3] * texel[3][k];
    return out;
  }
};

namespace detail {

/// dst = mean of the texels up to `radius` left and right, as far as they are there. Scaled before they are
/// summed: large exponentials have no room for a sum.
inline void box_rows(const float* src, float* dst, int channels, int width, int radius) {
  const int n = width * channels;
  const float each = 1.0f / float(2 * radius + 1);
  std::fill(dst, dst + n, 0.0f);
  for (int j = -radius; j <= radius; ++j) {
    const int shift = j * channels, begin = std::max(0, -shift), end = std::min(n, n - shift);
    for (int i = begin; i < end; ++i) dst[i] += each * src[i + shift];
  }
  for (int x = 0; x < width; ++x) {
    const int held = std::min(x + radius, width - 1) - std::max(x - radius, 0) + 1;
    if (held == 2 * radius + 1) continue;
    const float share = float(2 * radius + 1) / float(held);
    for (int k = 0; k < channels; ++k) dst[x * channels + k] *= share;
  }
}

/// Box blur in place.
inline void blur(std::vector<float>& values, int channels, int width, int height, int radius, int threads) {
  if (radius == 0) return;
  const std::size_t stride = std::size_t(width) * std::size_t(channels);
  std::vector<float> across(values.size());
  accel::parallel_ranges(std::size_t(height), threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t y = begin; y < end; ++y)
      box_rows(values.data() + y * stride, across.data() + y * stride, channels, width, radius);
  });
  accel::parallel_ranges(std::size_t(height), threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t y = begin; y < end; ++y) {
      const std::size_t r = std::size_t(radius), y0 = y < r ? 0 : y - r,
                        y1 = std::min(std::size_t(height) - 1, y + r);
      float* out = values.data() + y * stride;
      std::fill_n(out, stride, 0.0f);
      const float share = 1.0f / float(y1 - y0 + 1);
      for (std::size_t j = y0; j <= y1; ++j) {
        const float* in = across.data() + j * stride;
        for (std::size_t i = 0; i < stride; ++i) out[i] += share * in[i];
      }
    }
  });
}

}  // namespace detail

struct MomentMapOptions {
  int radius = 1;  ///< of the blur, in texels; 0 for none
  int threads = 1;
};

/// moments_of(map, x, y) gives the array<float, K> of a texel. Throws InvalidScene for a map or options that
/// are none.
template <int K, class MomentsOf>
MomentMap<K> make_moment_map(const DepthMap& map, const MomentMapOptions& options, MomentsOf&& moments_of) {
  detail::check_map(map);
  detail::check_knob("radius", options.radius, 0, 1024);
  MomentMap<K> r{map.view, map.width, map.height, options.radius, {}};
  r.values.resize(map.first.size() * K);
  accel::parallel_ranges(std::size_t(map.height), options.threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t y = begin; y < end; ++y)
      for (int x = 0; x < map.width; ++x) {
        const std::array<float, K> m = moments_of(map, x, int(y));
        std::copy_n(m.data(), K, r.values.data() + map.index(x, int(y)) * K);
      }
  });
  detail::blur(r.values, K, map.width, map.height, options.radius, options.threads);
  return r;
}

}  // namespace treeline::shading::shadow
