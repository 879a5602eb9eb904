// Thin curved threads in empty space, as in cosmic webs and power lines: one-dimensional, far apart.
#include <array>

#include "datasets_gen/recipe.hpp"

namespace treeline::datasets {
namespace {

/// A closed curve: a centre and three harmonics of falling height.
struct Thread {
  Vec3d centre;
  std::array<Vec3d, 3> sine, cosine;

  Thread(std::uint64_t seed, std::uint64_t number) {
    Draws draws(seed, number);
    centre = draws.in_box({0, 0, 0}, {1, 1, 1});
    for (int h = 0; h < 3; ++h) {
      sine[h] = scaled(draws.direction(), 0.3 / (h + 1));
      cosine[h] = scaled(draws.direction(), 0.3 / (h + 1));
    }
  }
  Vec3d at(double turn) const {
    Vec3d p = centre;
    for (int h = 0; h < 3; ++h) {
      const SinCos a = sincos_turns(turn * (h + 1));
      p = sum(p, sum(scaled(sine[h], a.sin), scaled(cosine[h], a.cos)));
    }
    return p;
  }
};

}  // namespace

geometry::Cloud3f filaments(const Job& job) {
  constexpr std::size_t count = 32;
  constexpr double thickness = 5e-4;  // standard deviation; the threads span about 1
  std::vector<Thread> threads;
  for (std::size_t k = 0; k < count; ++k) threads.emplace_back(~job.seed, k);
  return job.cloud(job.n, [&](std::size_t i) {
    Draws draws(job.seed, i);
    const Thread& thread = threads[draws.below(count)];
    const Vec3d on = thread.at(draws.uniform());
    return sum(on, scaled(draws.normal(), thickness));
  });
}

}  // namespace treeline::datasets
