// Black and white by the sign of a rough height: blobs, bays and threads of every size, as of leaves.
#include "datasets_gen/noise.hpp"
#include "datasets_gen/recipe.hpp"

namespace treeline::datasets {

shading::Image mask(const Job& job) {
  return job.image(1, [&](int x, int y, std::span<float> pixel) {
    const double height = fractal_noise(job.seed, {x / 96.0 + 0.37, y / 96.0 + 0.61, 0.5}, 7);
    pixel[0] = height > 0.08 ? 1.0f : 0.0f;  // a quarter to a third of it
  });
}

}  // namespace treeline::datasets
