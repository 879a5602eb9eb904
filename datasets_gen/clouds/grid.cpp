// A regular grid of points. Its spacing is a power of two, so that distances tie exactly.
#include <algorithm>
#include <bit>

#include "datasets_gen/recipe.hpp"

namespace treeline::datasets {

geometry::Cloud3f grid(const Job& job) {
  std::size_t a = 1;
  while ((a + 1) * (a + 1) * (a + 1) <= job.n) ++a;
  std::size_t b = a;
  while (a * (b + 1) * (b + 1) <= job.n) ++b;
  const std::size_t c = (job.n + a * b / 2) / (a * b);
  const double spacing = 1.0 / static_cast<double>(std::bit_ceil(std::max({a, b, c})));
  return job.cloud(a * b * c, [&](std::size_t i) {
    return scaled(
        {static_cast<double>(i % a), static_cast<double>(i / a % b), static_cast<double>(i / (a * b))},
        spacing);
  });
}

}  // namespace treeline::datasets
