// Points uniform in the unit cube and in the unit ball: the benchmark everyone publishes, and the easiest
// one.
#include <algorithm>

#include "datasets_gen/recipe.hpp"

namespace treeline::datasets {

geometry::Cloud3f uniform_cube(const Job& job) {
  return job.cloud(job.n, [&](std::size_t i) { return Draws(job.seed, i).in_box({0, 0, 0}, {1, 1, 1}); });
}

geometry::Cloud3f uniform_ball(const Job& job) {
  return job.cloud(job.n, [&](std::size_t i) {
    Draws draws(job.seed, i);
    // The largest of three uniforms has the distribution r³ of a ball's radius: no cube root needed.
    const double r = std::max({draws.uniform(), draws.uniform(), draws.uniform()});
    return scaled(draws.direction(), r);
  });
}

}  // namespace treeline::datasets
