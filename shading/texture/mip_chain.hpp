// A pyramid of textures, each half as wide and high as the one before (Williams 1983), by a box filter that
// weighs every texel by the area it has in the coarser one, so that odd sides lose no weight: three taps
// there (Guthe and Heckbert 2005), two elsewhere. Cost: a third more bytes; one read of each level.
#pragma once

#include <algorithm>
#include <cstring>
#include <utility>

#include "shading/texture/prefix_sums.hpp"
#include "shading/texture/region_averager.hpp"

namespace treeline::shading::texture {

class MipChain {
 public:
  struct Level {
    int width, height;
    std::size_t begin;       ///< of its values
    float scale_x, scale_y;  ///< its texels over those of the texture
  };

  explicit MipChain(const Image& image, int threads = 1) { rebuild(image, threads); }

  /// Throws InvalidTexture where check_shape does, and for values that are not finite.
  void rebuild(const Image& image, int threads = 1) {
    check_shape(image);
    accel::check_threads(threads);
    lay_out(image);
    std::memcpy(values_.data(), image.values.data(), image.values.size() * sizeof(float));
    for (std::size_t l = 1; l < levels_.size(); ++l) {
      // Small levels are not worth a thread. As many rows as make a chunk's worth of work.
      const auto rows = static_cast<std::size_t>(levels_[l].height);
      const bool alone = levels_[l].width * levels_[l].height < 1 << 14;
      with_channels(channels_, [&](auto count) {
        if (alone) return halve<count>(l, 0, rows);
        const std::size_t part = 16, parts = (rows + part - 1) / part;
        accel::parallel_ranges(parts * accel::batch_chunk, threads, [&](std::size_t begin, std::size_t end) {
          halve<count>(l, begin / accel::batch_chunk * part,
                       std::min(rows, (end + accel::batch_chunk - 1) / accel::batch_chunk * part));
        });
      });
    }
    for (int c = 0; c < channels_; ++c)
      if (!std::isfinite(values_[levels_.back().begin + static_cast<std::size_t>(c)])) {
        check_finite(image);
        throw InvalidTexture("the means of the texture are beyond the range of float");
      }
  }

  int width() const { return levels_[0].width; }
  int height() const { return levels_[0].height; }
  int channels() const { return channels_; }
  int levels() const { return static_cast<int>(levels_.size()); }
  std::size_t bytes() const { return values_.size() * sizeof(float); }
  const Level& level(int l) const { return levels_[static_cast<std::size_t>(l)]; }
  const float* texel(const Level& l, int x, int y) const {
    return values_.data() + l.begin +
           (static_cast<std::size_t>(y) * static_cast<std::size_t>(l.width) + static_cast<std::size_t>(x)) *
               static_cast<std::size_t>(channels_);
  }

 private:
  void lay_out(const Image& image) {
    if (!levels_.empty() && width() == image.width && height() == image.height && channels_ == image.channels)
      return;
    channels_ = image.channels;
    levels_.clear();
    std::size_t end = 0;
    for (int w = image.width, h = image.height;; w = std::max(1, w / 2), h = std::max(1, h / 2)) {
      levels_.push_back({w, h, end, static_cast<float>(double(w) / image.width),
                         static_cast<float>(double(h) / image.height)});
      end += static_cast<std::size_t>(w) * static_cast<std::size_t>(h) * static_cast<std::size_t>(channels_);
      if (w == 1 && h == 1) break;
    }
    values_ = std::vector<float>(end + 1);  // look-ups of three channels read a fourth
  }

  /// Rows [from, to) of level l from level l - 1.
  template <int channels>
  void halve(std::size_t l, std::size_t from, std::size_t to) {
    const Level &fine = levels_[l - 1], &coarse = levels_[l];
    const bool even = fine.width == 2 * coarse.width && fine.height == 2 * coarse.height;
    for (std::size_t y = from; y < to; ++y) {
      float* out = const_cast<float*>(texel(coarse, 0, static_cast<int>(y)));
      even ? halve_even<channels>(fine, coarse, static_cast<int>(y), out)
           : halve_any<channels>(fine, coarse, static_cast<int>(y), out);
    }
  }

  template <int channels>
  void halve_even(const Level& fine, const Level& coarse, int y, float* out) const {
    const float *a = texel(fine, 0, 2 * y), *b = texel(fine, 0, 2 * y + 1);
    int x = 0;
    if constexpr (channels != 3 && prefix::lanes<float> >= 2 * channels) {
      using V = prefix::Register<float>;
      constexpr int n = prefix::lanes<float>;
      for (; (x + n / channels) <= coarse.width; x += n / channels) {
        V p[4];
        std::memcpy(p, a + 2 * x * channels, 2 * sizeof(V)),
            std::memcpy(p + 2, b + 2 * x * channels, 2 * sizeof(V));
        const V r = halves<channels>(p[0] + p[2], p[1] + p[3], std::make_integer_sequence<int, n>{});
        std::memcpy(out + x * channels, &r, sizeof r);
      }
    }
    for (; x < coarse.width; ++x)
      for (int c = 0; c < channels; ++c) {
        const int i = 2 * x * channels + c;
        out[x * channels + c] = ((a[i] + b[i]) + (a[i + channels] + b[i + channels])) * 0.25f;
      }
  }
  /// Of the pixels of two registers those at even places and those at odd ones, each pair's mean.
  template <int channels, int... i>
  [[gnu::always_inline]] static prefix::Register<float> halves(prefix::Register<float> a,
                                                               prefix::Register<float> b,
                                                               std::integer_sequence<int, i...>) {
    const auto even = __builtin_shufflevector(a, b, (i / channels * 2 * channels + i % channels)...);
    const auto odd = __builtin_shufflevector(a, b, ((i / channels * 2 + 1) * channels + i % channels)...);
    return (even + odd) * 0.25f;
  }

  /// The taps of a texel of m coarser ones, of n: at most three, and their weights, which sum to 1.
  struct Taps {
    int first;
    float weight[3];
  };
  static Taps taps(int at, int n, int m) {
    if (n == m) return {at, {1, 0, 0}};
    const double size = double(n) / m, begin = at * size, end = begin + size;
    Taps t{static_cast<int>(begin), {}};
    for (int k = 0; k < 3; ++k) {
      const double low = std::max(begin, double(t.first + k)), high = std::min(end, t.first + k + 1.0);
      t.weight[k] = static_cast<float>(std::max(0.0, high - low) / size);
    }
    return t;
  }
  template <int channels>
  void halve_any(const Level& fine, const Level& coarse, int y, float* out) const {
    const Taps down = taps(y, fine.height, coarse.height);
    for (int x = 0; x < coarse.width; ++x) {
      const Taps across = taps(x, fine.width, coarse.width);
      float sum[channels] = {};
      for (int j = 0; j < 3; ++j)
        for (int i = 0; i < 3; ++i) {
          const float w = down.weight[j] * across.weight[i];
          if (!(w > 0)) continue;  // may lie outside
          const float* p = texel(fine, std::min(across.first + i, fine.width - 1),
                                 std::min(down.first + j, fine.height - 1));
          for (int c = 0; c < channels; ++c) sum[c] += w * p[c];
        }
      for (int c = 0; c < channels; ++c) out[x * channels + c] = sum[c];
    }
  }

  int channels_ = 0;
  std::vector<Level> levels_;
  std::vector<float> values_;
};

}  // namespace treeline::shading::texture
