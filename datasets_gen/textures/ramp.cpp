// A plane: what a depth map holds of a floor. Float's own digits, no levels; the seed tilts it.
#include "datasets_gen/recipe.hpp"

namespace treeline::datasets {

shading::Image ramp(const Job& job) {
  const double side = std::sqrt(static_cast<double>(job.n)), across = Draws(job.seed, 0).uniform(0.3, 0.7);
  return job.image(1, [&](int x, int y, std::span<float> pixel) {
    pixel[0] = static_cast<float>(across * ((x + 0.5) / side) + (1 - across) * ((y + 0.5) / side));
  });
}

}  // namespace treeline::datasets
