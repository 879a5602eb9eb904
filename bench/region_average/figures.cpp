#include "bench/region_average/figures.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <map>

#include "shading/texture/footprint.hpp"

namespace treeline::bench::region_average {
namespace {

/// From a float of that size to the next.
double spacing(double x) {
  return x > 0 ? std::ldexp(1.0, std::ilogb(x) + 1 - std::numeric_limits<float>::digits) : 0;
}

bool whole(double x) { return x == std::floor(x); }

}  // namespace

std::optional<Figure> rounding_of_sums(std::span<const Footprint> asked, double mean) {
  std::map<std::array<double, 4>, double> boxes;  // and how often each is asked for
  for (const Footprint& f : asked) {
    const auto b = shading::texture::bounding_box(f);
    if (!(whole(b.x0) && whole(b.x1) && whole(b.y0) && whole(b.y1))) return std::nullopt;
    if (!(b.x1 > b.x0 && b.y1 > b.y0 && b.x0 >= 0 && b.y0 >= 0)) return std::nullopt;
    ++boxes[{b.x0, b.x1, b.y0, b.y1}];
  }
  double sum = 0, spread = 0;  // of squared errors: as expected, and the variance of that
  for (const auto& [b, times] : boxes) {
    const auto [x0, x1, y0, y1] = b;
    const double w = x1 - x0, h = y1 - y0;
    double variance = 0;
    for (double j = y0 + 1; j <= y1; ++j)
      for (const double x : {x0, x1}) {
        const double u = spacing(mean * x * j);
        variance += u * u / 12;
      }
    variance /= w * w * h * h;
    sum += times * variance;
    // A sum of k even errors has the kurtosis 3 - 1.2/k. A box shares half of them with the next one to its
    // left and to its right, if these are asked for, too: squares are then correlated by 1/4 each.
    spread += (1 + 2 * 0.25) * (2 - 1.2 / (2 * h)) * times * times * variance * variance;
  }
  if (!(sum > 0)) return std::nullopt;
  const double value = std::sqrt(sum / double(asked.size()));
  return Figure{value, 4 * 0.5 * value * std::sqrt(spread) / sum};
}

}  // namespace treeline::bench::region_average
