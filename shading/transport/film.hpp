// The mean of each pixel's samples, how far it may be off, and how much of it is a single sample's.
//
// Problem: sums of floats stop growing (of ones, at 2^24 of them), and a mean without its error says little.
// Method: sums in double, which 1e8 samples bring out of true by 1e-8 at most (a float and a second float for
// what it lost, float_sums.hpp, takes the same room and is no better). The error is estimated from sets of
// samples that are independent of each other: of one sample each, or of as many as share a net of Sobol
// points. Cost: 120 bytes a pixel, some 5 ns a sample. Known weakness: an estimate from n sets is itself off
// by a share of 1 / sqrt(2 n), more where a few samples hold most of the light; kurtosis() and
// largest_share() tell of that.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>

#include "shading/image.hpp"
#include "shading/light/luminance.hpp"
#include "shading/transport/options.hpp"

namespace treeline::shading::transport {

class Film {
 public:
  /// `set`: of so many samples after each other, only the sum is independent of others. Throws InvalidOptions
  /// for an image without pixels and set < 1.
  Film(int width, int height, int set = 1) : width_(width), height_(height), set_(set) {
    if (width < 1 || height < 1)
      throw InvalidOptions("a film of " + std::to_string(width) + " × " + std::to_string(height) +
                           " has no pixels");
    if (set < 1) throw InvalidOptions("set is " + std::to_string(set) + "; it must be at least 1");
    pixels_.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  }

  int width() const { return width_; }
  int height() const { return height_; }
  std::size_t size() const { return pixels_.size(); }
  int set() const { return set_; }
  static constexpr std::size_t bytes_per_pixel() { return sizeof(Pixel); }
  /// Of this pixel so far.
  std::uint64_t samples(std::size_t pixel) const { return pixels_[pixel].samples; }
  /// A pixel, on average.
  double samples() const {
    double sum = 0;
    for (const Pixel& p : pixels_) sum += static_cast<double>(p.samples);
    return sum / static_cast<double>(pixels_.size());
  }

  /// One more sample. Threads may add to different pixels at the same time.
  void add(std::size_t pixel, const Rgb& radiance) {
    Pixel& p = pixels_[pixel];
    ++p.samples;
    for (int k = 0; k < 3; ++k) p.sum[k] += static_cast<double>(radiance[k]);
    const float bright = light::luminance(radiance);
    if (p.samples == 1) p.first = bright;
    const double y = static_cast<double>(bright) - static_cast<double>(p.first);
    p.power1 += y, p.power2 += y * y, p.power3 += y * y * y, p.power4 += y * y * (y * y);
    p.largest = std::max(p.largest, bright);
    if (set_ > 1 && p.samples % static_cast<std::uint64_t>(set_) != 0) return;
    for (int k = 0; k < 3; ++k) {
      const double of_set = p.sum[k] - p.closed[k];
      p.squares[k] += of_set * of_set, p.closed[k] = p.sum[k];
    }
  }

  /// Radiance, W / (m² sr); 0 without samples.
  geometry::Vec3d mean(std::size_t pixel) const {
    const Pixel& p = pixels_[pixel];
    return p.samples > 0 ? p.sum / static_cast<double>(p.samples) : geometry::Vec3d{};
  }
  /// Of mean(), by channel, an estimate; infinite below two whole sets. Samples beyond the last whole set
  /// count for the mean alone.
  geometry::Vec3d standard_error(std::size_t pixel) const {
    const Pixel& p = pixels_[pixel];
    const double n = static_cast<double>(p.samples / static_cast<std::uint64_t>(set_));
    if (n < 2) return geometry::Vec3d::filled(std::numeric_limits<double>::infinity());
    geometry::Vec3d error;
    for (int k = 0; k < 3; ++k) {
      const double mean = p.closed[k] / n;
      error[k] = std::sqrt(std::max(0.0, p.squares[k] / n - mean * mean) / (n - 1)) / set_;
    }
    return error;
  }
  /// Of the samples' luminance: fourth central moment over the squared variance; 3 for a normal distribution,
  /// large where few samples are much brighter than the rest. 0 where all are equal, but for rounding.
  double kurtosis(std::size_t pixel) const {
    const Pixel& p = pixels_[pixel];
    if (p.samples == 0) return 0;
    const double n = static_cast<double>(p.samples), m = p.power1 / n;
    const double variance = p.power2 / n - m * m;
    // Below this, what is left of the second moment may be the samples' own rounding.
    const double level = std::abs(light::luminance(p.sum)) / n * rounding;
    if (!(variance > level * level) || !(variance > rounding * p.power2 / n)) return 0;
    const double fourth = p.power4 / n - 4 * m * p.power3 / n + 6 * m * m * p.power2 / n - 3 * m * m * m * m;
    return fourth / (variance * variance);
  }
  /// Of the sum of the pixel's luminance, in [0, 1]: what its brightest sample brought.
  double largest_share(std::size_t pixel) const {
    const Pixel& p = pixels_[pixel];
    const double sum = light::luminance(p.sum);
    return sum > 0 ? static_cast<double>(p.largest) / sum : 0;
  }
  /// Root of the mean squared standard error of the pixels over the mean, both of the channels' average: an
  /// estimate of the image's relative error. Infinite below two whole sets; 0 for a black image.
  double relative_error() const {
    double squares = 0, sum = 0;
    for (std::size_t i = 0; i < pixels_.size(); ++i) {
      const geometry::Vec3d e = standard_error(i), m = mean(i);
      squares += dot(e, e) / 3, sum += (m[0] + m[1] + m[2]) / 3;
    }
    const double n = static_cast<double>(pixels_.size());
    return squares > 0 ? std::sqrt(squares / n) / (sum / n) : 0;
  }

  /// Three channels.
  Image image() const {
    return filled([&](std::size_t i) { return mean(i); });
  }
  /// Standard errors, three channels.
  Image errors() const {
    return filled([&](std::size_t i) { return standard_error(i); });
  }

 private:
  struct Pixel {
    geometry::Vec3d sum{}, closed{}, squares{};             // closed: of whole sets; squares: of their sums
    double power1 = 0, power2 = 0, power3 = 0, power4 = 0;  // of the luminance less that of the first sample
    std::uint64_t samples = 0;
    float first = 0, largest = 0;
  };
  static constexpr double rounding = 1e-6;  // of a sample's luminance, with room to spare

  template <class F>
  Image filled(F&& f) const {
    Image image(width_, height_, 3);
    for (std::size_t i = 0; i < pixels_.size(); ++i) {
      const geometry::Vec3d value = f(i);
      for (std::size_t k = 0; k < 3; ++k) image.values[3 * i + k] = static_cast<float>(value[int(k)]);
    }
    return image;
  }

  int width_, height_, set_;
  std::vector<Pixel> pixels_;
};

}  // namespace treeline::shading::transport
