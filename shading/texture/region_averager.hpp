// What all methods for the mean of a region of a texture offer, and how they take batches of footprints.
#pragma once

#include <concepts>
#include <cstddef>
#include <span>
#include <stdexcept>
#include <string>

#include "accel/batch.hpp"
#include "shading/image.hpp"
#include "shading/texture/footprint.hpp"

namespace treeline::shading::texture {

/// A texture, or an option, that a method cannot take; says which and where.
struct InvalidTexture : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Textures have 1 to 4 channels, at least one texel, and sides that fit 24 bits.
inline constexpr int most_channels = 4, longest_side = 1 << 24;

/// mean(footprint, out) writes one mean per channel to out. Immutable between builds, and safe to ask from
/// many threads at once. One that is faster at many in a row has means(footprints, out), too.
template <class T>
concept RegionAverager = requires(const T& a, const Footprint& f, float* out) {
  { a.channels() } -> std::convertible_to<int>;
  { a.width() } -> std::convertible_to<int>;
  { a.height() } -> std::convertible_to<int>;
  { a.bytes() } -> std::convertible_to<std::size_t>;
  a.mean(f, out);
};

/// The means of many footprints: those of footprint i from out[i * channels] on. Neither they nor their order
/// depend on the number of threads. Throws accel::InvalidInput for less than one thread or a wrong size.
template <RegionAverager A>
void means(const A& averager, std::span<const Footprint> footprints, std::span<float> out, int threads = 1) {
  const auto channels = static_cast<std::size_t>(averager.channels());
  if (out.size() != footprints.size() * channels)
    throw accel::InvalidInput("there is room for " + std::to_string(out.size()) + " means; needed are " +
                              std::to_string(footprints.size() * channels));
  accel::parallel_ranges(footprints.size(), threads, [&](std::size_t begin, std::size_t end) {
    float* const to = out.data() + begin * channels;
    if constexpr (requires { averager.means(footprints, to); })
      averager.means(footprints.subspan(begin, end - begin), to);
    else
      for (std::size_t i = begin; i < end; ++i) averager.mean(footprints[i], to + (i - begin) * channels);
  });
}

/// Throws InvalidTexture for an image without texels, with more than four channels, or whose values are not
/// as many as its sides say.
inline void check_shape(const Image& image) {
  const auto text = [&] {
    return std::to_string(image.width) + " x " + std::to_string(image.height) + " texels of " +
           std::to_string(image.channels) + " channels";
  };
  if (image.width < 1 || image.height < 1) throw InvalidTexture("the texture has " + text());
  if (image.channels < 1 || image.channels > most_channels)
    throw InvalidTexture("the texture has " + text() + "; 1 to 4 channels are known");
  if (image.width > longest_side || image.height > longest_side)
    throw InvalidTexture("the texture has " + text() + "; a side may have 2^24 at most");
  if (image.values.size() != image.index(0, image.height))
    throw InvalidTexture("the texture has " + text() + ", but " + std::to_string(image.values.size()) +
                         " values");
}

/// Throws InvalidTexture naming the first texel that is not finite.
inline void check_finite(const Image& image) {
  for (std::size_t i = 0; i < image.values.size(); ++i) {
    if (std::isfinite(image.values[i])) continue;
    const auto c = static_cast<std::size_t>(image.channels), w = static_cast<std::size_t>(image.width);
    throw InvalidTexture("texel (" + std::to_string(i / c % w) + ", " + std::to_string(i / c / w) +
                         "), channel " + std::to_string(i % c) + " is not finite");
  }
}

/// Calls f(std::integral_constant<int, C>) with the number of channels, 1 to 4.
template <class F>
decltype(auto) with_channels(int channels, F&& f) {
  switch (channels) {
    case 1:
      return f(std::integral_constant<int, 1>{});
    case 2:
      return f(std::integral_constant<int, 2>{});
    case 3:
      return f(std::integral_constant<int, 3>{});
    default:
      return f(std::integral_constant<int, 4>{});
  }
}

}  // namespace treeline::shading::texture
