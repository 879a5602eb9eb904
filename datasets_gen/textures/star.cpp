// A star of spokes, fine in its middle, over rings that are fine at the border: every frequency up to that of
// the pixels, in every direction. Sampled at pixel centres, in 256 levels.
#include "datasets_gen/recipe.hpp"

namespace treeline::datasets {

namespace {

/// The angle of (x, y) in a measure that grows evenly enough around it: 0 to 8, without a library's
/// arctangent.
double octants(double x, double y) {
  const double a = std::abs(x), b = std::abs(y), t = a + b > 0 ? 2 * b / (a + b) : 0;
  const double quarter = x < 0 ? 4 - t : t;
  return y < 0 ? 8 - quarter : quarter;
}

}  // namespace

shading::Image star(const Job& job) {
  const double side = std::sqrt(static_cast<double>(job.n)), phase = Draws(job.seed, 0).uniform();
  return job.image(1, [&](int x, int y, std::span<float> pixel) {
    const double u = (x + 0.5) / side - 0.5, v = (y + 0.5) / side - 0.5, r2 = u * u + v * v;
    // Spokes within the inner quarter of the area, beyond it rings: cos(k r²) is as fine as a pixel at
    // distance pi side / k from the middle.
    const double turns = r2 < 0.0625 ? 12 * octants(u, v) + phase : 0.5 * side * r2 + phase;
    const double wave = 0.5 + 0.5 * sincos_turns(turns).cos;
    pixel[0] = static_cast<float>(std::floor(wave * 255 + 0.5)) / 255.0f;
  });
}

}  // namespace treeline::datasets
