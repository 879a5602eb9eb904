// Four channels of smooth veins, 256 levels each: what most textures of surfaces are like.
#include "datasets_gen/noise.hpp"
#include "datasets_gen/recipe.hpp"

namespace treeline::datasets {

shading::Image marble(const Job& job) {
  return job.image(4, [&](int x, int y, std::span<float> pixel) {
    const Vec3d p{x / 160.0 + 0.13, y / 160.0 + 0.71, 0.5};
    const double bent = p[0] + 2 * fractal_noise(job.seed, p, 6);
    const double vein = 0.5 + 0.5 * sincos_turns(1.5 * bent).sin;
    const double grain = fractal_noise(job.seed + 100, scaled(p, 8), 4);
    for (std::size_t c = 0; c < 4; ++c) {
      const double share = 0.4 + 0.15 * static_cast<double>(c);
      const double level = share * vein + (1 - share) * (0.5 + 0.5 * grain);
      pixel[c] = static_cast<float>(std::floor(std::min(std::max(level, 0.0), 1.0) * 255 + 0.5)) / 255.0f;
    }
  });
}

}  // namespace treeline::datasets
