// What a table sums: the texture's values as they are, less a constant, or as whole steps of a range.
#pragma once

#include <limits>

#include "shading/texture/prefix_sums.hpp"

namespace treeline::shading::texture {

/// The rows of an image.
struct RowsOf {
  const float* values;
  std::size_t row_length;

  explicit RowsOf(const Image& image) : values(image.values.data()), row_length(image.index(0, 1)) {}
  const float* row(int y) const { return values + static_cast<std::size_t>(y) * row_length; }
};

template <class Entry>
struct PlainSource : RowsOf {
  using RowsOf::RowsOf;

  template <int channels>
  [[gnu::always_inline]] void load(const float* p, std::size_t, prefix::Register<Entry>& to) const {
    prefix::Vector<float, prefix::lanes<Entry>> v;
    std::memcpy(&v, p, sizeof v);
    to = __builtin_convertvector(v, prefix::Register<Entry>);
  }
  void leave() const {}
};

/// Less a constant of each channel.
struct CentredSource : RowsOf {
  CentredSource(const Image& image, const float (&middle)[most_channels]) : RowsOf(image) {
    for (std::size_t phase = 0; phase < 3; ++phase)
      for (int i = 0; i < prefix::lanes<float>; ++i)
        offset[phase][i] =
            middle[(phase + static_cast<std::size_t>(i)) % static_cast<std::size_t>(image.channels)];
  }

  template <int channels>
  [[gnu::always_inline]] void load(const float* p, std::size_t x, prefix::Register<float>& to) const {
    prefix::Register<float> v;
    std::memcpy(&v, p, sizeof v);
    // A register begins with channel 0 unless it holds three of each pixel.
    to = v - (channels == 3 ? offset[x % 3] : offset[0]);
  }
  void leave() const {}

  prefix::Register<float> offset[3];
};

/// 65536 levels over a range of values.
struct Levels {
  static constexpr int top = 65535;
  float low = 0, per_value = top;  ///< level = (value - low) * per_value, rounded

  /// Between two levels.
  double step() const { return per_value > 0 ? 1 / double(per_value) : 0; }
  double value(double level) const { return double(low) + level * step(); }

  /// Over the range of an image. Throws InvalidTexture where it is beyond that of float.
  static Levels over(const Image& image) {
    const auto [low, high] = std::ranges::minmax(image.values);
    const double range = double(high) - double(low), most = double(std::numeric_limits<float>::max());
    if (range > most) throw InvalidTexture("the values of the texture span more than float holds");
    return {low, range > 0 ? static_cast<float>(std::min(top / range, most)) : 0.0f};
  }
};

/// Values as levels; tells if there was one outside of the range.
template <class Entry>
struct LevelSource : RowsOf {
  LevelSource(const Image& image, const Levels& l, std::atomic<bool>& out)
      : RowsOf(image), levels(l), outside(&out) {}

  template <int channels>
  [[gnu::always_inline]] void load(const float* p, std::size_t, prefix::Register<Entry>& to) {
    prefix::Vector<float, prefix::lanes<Entry>> v;
    std::memcpy(&v, p, sizeof v);
    const auto level = __builtin_convertvector((v - levels.low) * levels.per_value + 0.5f, Ints);
    odd |= (level & ~Levels::top) | (Ints)(v != v);
    to = __builtin_convertvector(level, prefix::Register<Entry>);
  }
  void leave() const {
    int any = 0;
    for (int i = 0; i < prefix::lanes<Entry>; ++i) any |= odd[i];
    if (any != 0) outside->store(true, std::memory_order_relaxed);
  }

  using Ints = prefix::Vector<std::int32_t, prefix::lanes<Entry>>;
  Levels levels;
  std::atomic<bool>* outside;
  Ints odd{};
};

}  // namespace treeline::shading::texture
