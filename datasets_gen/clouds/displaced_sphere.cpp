// Points on a rough closed surface, as a scanned object gives: two-dimensional in three dimensions.
#include "datasets_gen/noise.hpp"
#include "datasets_gen/recipe.hpp"

namespace treeline::datasets {

geometry::Cloud3f displaced_sphere(const Job& job) {
  return job.cloud(job.n, [&](std::size_t i) {
    const Vec3d d = Draws(job.seed, i).direction();
    return scaled(d, 1 + 0.3 * fractal_noise(job.seed, scaled(d, 2), 5));
  });
}

}  // namespace treeline::datasets
