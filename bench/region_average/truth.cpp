#include "bench/region_average/truth.hpp"

#include <algorithm>
#include <cmath>

#include "accel/batch.hpp"
#include "shading/texture/coverage.hpp"

namespace treeline::bench::region_average {
namespace {

namespace texture = shading::texture;

/// Sums with what they rounded off.
struct Sum {
  double sum = 0, lost = 0;

  void add(double x) {
    const double t = sum + x;
    lost += std::abs(sum) >= std::abs(x) ? (sum - t) + x : (x - t) + sum;
    sum = t;
  }
  double value() const { return sum + lost; }
};

void mean_of(const Image& image, Footprint f, double* out) {
  if (f.shape == texture::Shape::box && f.aligned()) {
    // A point or a line: so thin that it stays within the texels it lies in. Texels far outside are one.
    const double thin = 1e-6;
    if (f.ux == 0) f.ux = thin, f.x = std::floor(f.x) + 0.5;
    if (f.vy == 0) f.vy = thin, f.y = std::floor(f.y) + 0.5;
  }
  Sum sums[4], weights;
  const auto clamped = [](double i, int n) { return static_cast<int>(std::clamp(i, 0.0, n - 1.0)); };
  texture::for_each_texel(f, [&](double i, double j, double w) {
    const std::size_t at = image.index(clamped(i, image.width), clamped(j, image.height));
    weights.add(w);
    for (int c = 0; c < image.channels; ++c)
      sums[c].add(w * double(image.values[at + static_cast<std::size_t>(c)]));
  });
  for (int c = 0; c < image.channels; ++c) out[c] = sums[c].value() / weights.value();
}

}  // namespace

std::vector<double> true_means(const Image& image, std::span<const Footprint> footprints, int threads) {
  const auto channels = static_cast<std::size_t>(image.channels);
  std::vector<double> out(footprints.size() * channels);
  accel::parallel_ranges(footprints.size(), threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) mean_of(image, footprints[i], out.data() + i * channels);
  });
  return out;
}

}  // namespace treeline::bench::region_average
