// The textbook's mipmap: one square wherever the footprint is, between the two levels whose texels are about
// as large (Williams 1983). The bilinear look-up has a tent of two texels for its kernel: at the level whose
// texels are as wide as the footprint it is too wide. A bias of -0.79 gives the kernel the variance of the
// box (best_bias). Cost: eight texels. Known weakness: an oblong footprint is taken for the square of its
// longer side, as in hardware.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <memory>

#include "shading/brdf/batch_registers.hpp"
#include "shading/texture/mip_chain.hpp"

namespace treeline::shading::texture {

/// Added to the level whose texels are as wide as the footprint, for a kernel of the same variance: a box of
/// w texels has w²/12. At a level whose texels are s wide the box filter has s²/12, and the look-up between
/// texels, a tent, s²/6: together s²/4, so that s is w / sqrt(3), log2 sqrt(3) = 0.79 levels finer.
inline constexpr double best_bias = -0.79;

namespace mip {

/// Half axes of the box that the footprint is taken for, and the longer of its sides.
struct Widths {
  double u, v;
  explicit Widths(const Footprint& f) {
    const double k = 2 * box_factor(f.shape);
    // Not hypot: it takes as long as the look-up, and no texture is 1e150 texels wide.
    u = k * std::sqrt(f.ux * f.ux + f.uy * f.uy);
    v = k * std::sqrt(f.vx * f.vx + f.vy * f.vy);
  }
};

/// To 7e-7, and exactly of powers of two, in a few instructions that loops can take many of at once. Below
/// the least normal number it is -126 or less. x not negative.
inline float log2_of(float x) {
  constexpr std::int32_t half = 0x3f3504f3;  // sqrt(1/2): mantissas are from there to sqrt(2)
  const auto bits = std::bit_cast<std::int32_t>(x);
  const std::int32_t exponent = (bits - half) >> 23;
  const float t = std::bit_cast<float>(bits - exponent * (1 << 23)) - 1;
  // log2(1 + t) / t at Chebyshev's points of that interval.
  float p = 0.16818659f;
  for (const float c : {-0.26796386f, 0.29611957f, -0.35952446f, 0.48061311f, -0.72136021f, 1.44269657f})
    p = p * t + c;
  return static_cast<float>(exponent) + t * p;
}

/// The level, fractional, whose texels are that wide.
inline float level_of(double width, double bias) {
  return log2_of(static_cast<float>(width)) + static_cast<float>(bias);
}
/// The square of the longer side of the box that the footprint is taken for.
inline float longer_squared(const Footprint& f) {
  const double k = 2 * box_factor(f.shape);
  const double u = f.ux * f.ux + f.uy * f.uy, v = f.vx * f.vx + f.vy * f.vy;
  return static_cast<float>(k * k * (u < v ? v : u));
}

/// The four texels that are nearest to a point of a level, before they are read.
struct Four {
  const float *above, *below;  ///< the two to the left
  std::size_t right;           ///< to the next one, in floats; 0 at the border
  float fx, fy, weight;

  /// (x, y) of the texture.
  Four(const MipChain& chain, const MipChain::Level& l, int channels, float x, float y, float w) : weight(w) {
    x = std::clamp(x * l.scale_x - 0.5f, 0.0f, static_cast<float>(l.width - 1));
    y = std::clamp(y * l.scale_y - 0.5f, 0.0f, static_cast<float>(l.height - 1));
    const int i = static_cast<int>(x), j = static_cast<int>(y);
    fx = x - static_cast<float>(i), fy = y - static_cast<float>(j);
    above = chain.texel(l, i, j);
    right = i + 1 < l.width ? static_cast<std::size_t>(channels) : 0;
    below = above + (j + 1 < l.height ? static_cast<std::size_t>(l.width * channels) : 0);
  }
  Four() = default;
  void prefetch() const { __builtin_prefetch(above), __builtin_prefetch(below); }

  /// Adds `weight` times what lies between them.
  template <int channels>
  void add(float* out) const {
    const float *p = above, *q = below;
    if constexpr (channels >= 3) {  // as four; behind the last texel there is room to read on
      using Register = prefix::Vector<float, 4>;
      const auto load = [](const float* from, Register& v) { std::memcpy(&v, from, sizeof v); };
      Register p0, p1, q0, q1;
      load(p, p0), load(p + right, p1), load(q, q0), load(q + right, q1);
      const Register a = p0 + fx * (p1 - p0), b = q0 + fx * (q1 - q0), sum = weight * (a + fy * (b - a));
      for (int c = 0; c < channels; ++c) out[c] += sum[c];
    } else {
      for (std::size_t c = 0; c < channels; ++c) {
        const float a = p[c] + fx * (p[c + right] - p[c]), b = q[c] + fx * (q[c + right] - q[c]);
        out[c] += weight * (a + fy * (b - a));
      }
    }
  }
};

/// The finer of the two levels on both sides of a fractional one, and the other's share.
struct BetweenLevels {
  int finer;
  float share;
  BetweenLevels(const MipChain& chain, float level) {
    level = level > 0 ? std::min(level, static_cast<float>(chain.levels() - 1)) : 0.0f;  // also if no number
    finer = static_cast<int>(level), share = level - static_cast<float>(finer);
  }
};

/// Adds `weight` times the pyramid at (x, y) of the texture, at a fractional level.
template <int channels>
void add_trilinear(const MipChain& chain, float x, float y, float level, float weight, float* out) {
  const BetweenLevels at(chain, level);
  Four(chain, chain.level(at.finer), channels, x, y, weight * (1 - at.share)).template add<channels>(out);
  if (at.share > 0)
    Four(chain, chain.level(at.finer + 1), channels, x, y, weight * at.share).template add<channels>(out);
}

/// What look-ups need of each level, an array a figure, so that registers of queries can gather from them.
struct LevelTable {
  static constexpr int most = 32;
  float scale_x[most], scale_y[most], last_x[most], last_y[most];
  float stride[most], begin[most];  ///< in floats; the bits of whole numbers

  /// Whether all places of the chain are numbers of 32 bits.
  static bool fits(const MipChain& chain) {
    return chain.levels() <= most && chain.bytes() / sizeof(float) < (std::size_t{1} << 31);
  }
  LevelTable() = default;
  explicit LevelTable(const MipChain& chain) {
    const auto bits = [](auto x) { return std::bit_cast<float>(static_cast<std::int32_t>(x)); };
    for (int l = 0; l < chain.levels(); ++l) {
      const MipChain::Level& level = chain.level(l);
      scale_x[l] = level.scale_x, scale_y[l] = level.scale_y;
      last_x[l] = static_cast<float>(level.width - 1), last_y[l] = static_cast<float>(level.height - 1);
      stride[l] = bits(level.width * chain.channels()), begin[l] = bits(level.begin);
    }
  }
};

namespace registers = brdf::batch;  // as many floats as fit into one, and gathering by lane
using registers::Floats;
using registers::Ints;

/// A register of look-ups, each of one level: where their four texels are, and what lies between them.
struct Places {
  Ints above, below, right;  ///< of the two to the left, in floats, and to the next one: 0 at the border
  Floats fx, fy;

  Places(const LevelTable& levels, int channels, Ints level, Floats x, Floats y) {
    const Floats last_x = registers::gathered(levels.last_x, level);
    const Floats last_y = registers::gathered(levels.last_y, level);
    const auto place = [&](Floats at, const float* scale, Floats last) {
      const Floats inner = at * registers::gathered(scale, level) - 0.5f;
      return registers::least(registers::largest(inner, Floats{}), last);
    };
    const Floats u = place(x, levels.scale_x, last_x), v = place(y, levels.scale_y, last_y);
    const Ints i = __builtin_convertvector(u, Ints), j = __builtin_convertvector(v, Ints);
    const Floats left = __builtin_convertvector(i, Floats), top = __builtin_convertvector(j, Floats);
    fx = u - left, fy = v - top;
    const Ints stride = registers::bits_of(registers::gathered(levels.stride, level));
    above = registers::bits_of(registers::gathered(levels.begin, level)) + j * stride + i * channels;
    below = above + ((top < last_y) & stride);
    right = (left < last_x) & channels;
  }

  /// Adds to out[lane · channels + c]; nothing where the weight is 0.
  template <int channels>
  void add(const float* values, Floats weight, float* out) const {
    if constexpr (channels <= 2) {
      for (int c = 0; c < channels; ++c) {
        const float* const p = values + c;
        const Floats a0 = registers::gathered(p, above), a1 = registers::gathered(p, above + right);
        const Floats b0 = registers::gathered(p, below), b1 = registers::gathered(p, below + right);
        const Floats a = a0 + fx * (a1 - a0), b = b0 + fx * (b1 - b0);
        Floats before;
        for (std::size_t k = 0; k < registers::lanes; ++k)
          before[k] = out[k * channels + static_cast<std::size_t>(c)];
        const Floats after = before + weight * (a + fy * (b - a));  // fused as one by one: to the same bits
        const Floats sum = weight > Floats{} ? after : before;
        for (std::size_t k = 0; k < registers::lanes; ++k)
          out[k * channels + static_cast<std::size_t>(c)] = sum[k];
      }
    } else {  // a look-up's channels in a register of their own
      for (std::size_t k = 0; k < registers::lanes; ++k, out += channels) {
        if (!(weight[k] > 0)) continue;
        Four four;
        four.above = values + above[k], four.below = values + below[k];
        four.right = static_cast<std::size_t>(right[k]), four.fx = fx[k], four.fy = fy[k],
        four.weight = weight[k];
        four.template add<channels>(out);
      }
    }
  }
};

}  // namespace mip

/// A pyramid to look up, of its own or shared with other ways to do so.
class OnMipChain {
 public:
  explicit OnMipChain(std::shared_ptr<const MipChain> chain) : chain_(std::move(chain)) {}
  OnMipChain(const Image& image, int threads) : chain_(std::make_shared<const MipChain>(image, threads)) {}

  int width() const { return chain_->width(); }
  int height() const { return chain_->height(); }
  int channels() const { return chain_->channels(); }
  std::size_t bytes() const { return chain_->bytes(); }
  const MipChain& chain() const { return *chain_; }

 private:
  std::shared_ptr<const MipChain> chain_;
};

class Trilinear : public OnMipChain {
 public:
  explicit Trilinear(const Image& image, double bias = 0, int threads = 1)
      : OnMipChain(image, threads), bias_(bias) {}
  explicit Trilinear(std::shared_ptr<const MipChain> chain, double bias = 0)
      : OnMipChain(std::move(chain)), bias_(bias) {}

  void mean(const Footprint& f, float* out) const { means({&f, 1}, out); }
  /// A block of queries at a time, their levels first. Where the finest of these is not too large, each
  /// further step is taken for a register of queries, which gather from the levels and their texels: 1.3 to 2
  /// times as fast as one by one (Xeon with AVX-512). Else memory is what takes the time: all places of a
  /// block are found and fetched before one is read.
  void means(std::span<const Footprint> footprints, float* out) const {
    const auto bias = static_cast<float>(bias_);
    with_channels(channels(), [&](auto count) {
      std::fill_n(out, footprints.size() * count, 0.0f);
      const bool by_registers = footprints.size() >= block && mip::LevelTable::fits(chain());
      mip::LevelTable table;
      if (by_registers) table = mip::LevelTable(chain());
      for (std::size_t i = 0; i < footprints.size(); i += block) {
        const auto part = footprints.subspan(i, std::min(block, footprints.size() - i));
        float* const to = out + i * count;
        float level[block];
        for (std::size_t k = 0; k < part.size(); ++k) level[k] = mip::longer_squared(part[k]);
        for (std::size_t k = 0; k < part.size(); ++k) level[k] = 0.5f * mip::log2_of(level[k]) + bias;
        if (by_registers && part.size() == block && cached(finest_of(level)))
          gather<count>(table, part, level, to);
        else
          look_up<count>(part, level, to);
      }
    });
  }

 private:
  static constexpr std::size_t block = 64;
  static constexpr std::size_t cached_bytes = std::size_t{1}
                                              << 23;  // of a level: some share of the last cache

  /// The finest of the levels that a whole block reads.
  const MipChain::Level& finest_of(const float* level) const {
    mip::Floats all = mip::registers::floats(INFINITY);
    for (std::size_t k = 0; k < block; k += mip::registers::lanes)
      all = mip::registers::least(mip::registers::WholeRegister{k}.load(level), all);
    float finest = INFINITY;
    for (std::size_t i = 0; i < mip::registers::lanes; ++i) finest = std::min(finest, all[i]);
    return chain().level(mip::BetweenLevels(chain(), finest).finer);
  }
  bool cached(const MipChain::Level& l) const {
    const std::size_t texels = static_cast<std::size_t>(l.width) * static_cast<std::size_t>(l.height);
    return texels * static_cast<std::size_t>(channels()) * sizeof(float) <= cached_bytes;
  }
  /// A whole block.
  template <int channels>
  void gather(const mip::LevelTable& table, std::span<const Footprint> part, const float* level,
              float* out) const {
    namespace registers = mip::registers;
    using mip::Floats, mip::Ints;
    float x[block], y[block];
    for (std::size_t k = 0; k < block; ++k)
      x[k] = static_cast<float>(part[k].x), y[k] = static_cast<float>(part[k].y);
    const Floats last = registers::floats(static_cast<float>(chain().levels() - 1));
    const float* const values = chain().texel(chain().level(0), 0, 0);
    for (std::size_t k = 0; k < block; k += registers::lanes, out += registers::lanes * channels) {
      const registers::WholeRegister at{k};
      const Floats px = at.load(x), py = at.load(y), wanted = at.load(level);
      const Floats l =
          registers::kept(wanted > Floats{}, registers::least(wanted, last));  // also if no number
      const Ints finer = __builtin_convertvector(l, Ints);
      const Floats share = l - __builtin_convertvector(finer, Floats);
      const Ints between = share > Floats{};  // where there is no coarser level, it is 0
      mip::Places(table, channels, finer, px, py).template add<channels>(values, 1.0f - share, out);
      std::int32_t any = 0;
      for (std::size_t i = 0; i < registers::lanes; ++i) any |= between[i];
      if (any != 0)
        mip::Places(table, channels, finer - between, px, py).template add<channels>(values, share, out);
    }
  }
  template <int channels>
  void look_up(std::span<const Footprint> part, const float* level, float* out) const {
    mip::Four finer[block], coarser[block];
    for (std::size_t k = 0; k < part.size(); ++k) {
      const mip::BetweenLevels at(chain(), level[k]);
      const auto x = static_cast<float>(part[k].x), y = static_cast<float>(part[k].y);
      finer[k] = mip::Four(chain(), chain().level(at.finer), channels, x, y, 1 - at.share);
      finer[k].prefetch();
      coarser[k].weight = 0;
      if (!(at.share > 0)) continue;
      coarser[k] = mip::Four(chain(), chain().level(at.finer + 1), channels, x, y, at.share);
      coarser[k].prefetch();
    }
    for (std::size_t k = 0; k < part.size(); ++k, out += channels) {
      finer[k].template add<channels>(out);
      if (coarser[k].weight > 0) coarser[k].template add<channels>(out);
    }
  }

  double bias_;
};
static_assert(RegionAverager<Trilinear>);

}  // namespace treeline::shading::texture
