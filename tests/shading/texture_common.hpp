// Textures and footprints for the tests, and a witness of the mean that knows no closed form.
#pragma once

#include <gtest/gtest.h>

#include <numbers>

#include "geometry/random.hpp"
#include "shading/texture.hpp"

namespace treeline::shading::texture {

/// Random levels of 8 bits.
inline Image random_levels(int width, int height, int channels, std::uint64_t seed = 1) {
  Image r(width, height, channels);
  geometry::Pcg32 random(seed);
  for (float& v : r.values) v = static_cast<float>(random.below(256)) / 255.0f;
  return r;
}

/// a x + b y + c at texel centres.
inline Image plane(int width, int height, double a, double b, double c) {
  Image r(width, height, 1);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) r(x, y) = static_cast<float>(a * (x + 0.5) + b * (y + 0.5) + c);
  return r;
}

/// Of the texture's function at a place, borders going on.
inline double at(const Image& image, double x, double y, int channel) {
  return double(image(static_cast<int>(std::clamp(std::floor(x), 0.0, image.width - 1.0)),
                      static_cast<int>(std::clamp(std::floor(y), 0.0, image.height - 1.0)), channel));
}

/// The mean by samples on a fine grid in the footprint's own axes: midpoints of n x n cells; of a disc those
/// inside, of a Gaussian weighed.
inline double sampled_mean(const Image& image, const Footprint& f, int channel, int n) {
  const double reach = f.shape == Shape::gaussian ? gaussian_reach : 1;
  double sum = 0, weights = 0;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const double a = reach * ((2 * i + 1.0) / n - 1), b = reach * ((2 * j + 1.0) / n - 1);
      double w = 1;
      if (f.shape == Shape::disc && a * a + b * b > 1) w = 0;
      if (f.shape == Shape::gaussian) w = std::exp(-0.5 * (a * a + b * b));
      if (w > 0)
        sum += w * at(image, f.x + a * f.ux + b * f.vx, f.y + a * f.uy + b * f.vy, channel), weights += w;
    }
  return sum / weights;
}

/// One ulp of float at x, and at least that of a level of 16 bits over 256.
inline double ulp_at(double x) { return std::max(std::abs(x), 1.0 / 65535) * 0x1p-23; }

template <class A>
std::vector<float> mean_of(const A& averager, const Footprint& f) {
  std::vector<float> out(static_cast<std::size_t>(averager.channels()));
  averager.mean(f, out.data());
  return out;
}

}  // namespace treeline::shading::texture
