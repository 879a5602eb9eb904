// White noise of 256 levels: every pixel by itself. Means of it tell at once what a filter leaves out, and
// its running sums grow as those of no natural image.
#include "datasets_gen/recipe.hpp"

namespace treeline::datasets {

shading::Image noise(const Job& job) {
  return job.image(1, [&](int x, int y, std::span<float> pixel) {
    const std::uint64_t key = static_cast<std::uint64_t>(y) << 32 | static_cast<std::uint64_t>(x);
    pixel[0] = static_cast<float>(Draws(job.seed, key).below(256)) / 255.0f;
  });
}

}  // namespace treeline::datasets
