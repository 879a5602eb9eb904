// Sweeps of a spinning laser scanner driven along a street, in scan order.
//
// 64 rings between -24.8° and +2° as on the Velodyne HDL-64E, 1.8 m above the ground, one sweep of 2048
// columns every half metre. The street: flat ground, houses on both sides, parked cars and poles (boxes), and
// a round wall at 90 m, so that every ray returns and the count is exact. Range noise: 2 cm. Units: metres.
// Density falls with the square of the distance: rings lie close near the car and far apart away from it.
#include <algorithm>
#include <vector>

#include "datasets_gen/recipe.hpp"

namespace treeline::datasets {
namespace {

constexpr std::size_t rings = 64, columns = 2048;
constexpr double lowest_turn = -24.8 / 360, highest_turn = 2.0 / 360;
constexpr double height = 1.8, wall_radius = 90, advance = 0.5, range_noise = 0.02;

struct Block {
  Vec3d low, high;

  /// Distance along a unit ray at which it enters the box, or `far` if it does not before.
  double enter(const Vec3d& o, const Vec3d& d, double far) const {
    double near = 0, out = far;
    for (int i = 0; i < 3; ++i) {
      if (d[i] == 0) {
        if (o[i] < low[i] || o[i] > high[i]) return far;
        continue;
      }
      const double a = (low[i] - o[i]) / d[i], b = (high[i] - o[i]) / d[i];
      near = std::max(near, std::min(a, b));
      out = std::min(out, std::max(a, b));
    }
    return near <= out && near > 0 ? near : far;
  }
};

std::vector<Block> street(std::uint64_t seed) {
  std::vector<Block> r;
  Draws draws(seed, 0);
  for (int side = -1; side <= 1; side += 2) {
    const auto add = [&](double x, double y, double wide, double deep, double tall) {
      const double near = side * y, far = side * (y + deep);
      r.push_back({{x, std::min(near, far), 0}, {x + wide, std::max(near, far), tall}});
    };
    for (double x = -80; x < 80;) {
      const double wide = draws.uniform(8, 20);
      const double back = draws.uniform(10, 14), deep = draws.uniform(8, 12), tall = draws.uniform(4, 15);
      add(x, back, wide, deep, tall);
      x += wide + draws.uniform(0, 6);
    }
    for (int car = 0; car < 5; ++car) {
      const double x = draws.uniform(-50, 50), y = draws.uniform(4, 5), tall = draws.uniform(1.4, 2);
      add(x, y, 4.2, 1.8, tall);
    }
    for (int pole = 0; pole < 4; ++pole) add(-60 + 35 * pole, 8, 0.2, 0.2, 6);
  }
  return r;
}

}  // namespace

geometry::Cloud3f lidar(const Job& job) {
  const std::vector<Block> blocks = street(~job.seed);
  // A small cloud is one thinned sweep, not a part of one.
  const std::size_t steps = std::min(columns, std::max<std::size_t>(1, (job.n + rings - 1) / rings));
  return job.cloud(job.n, [&](std::size_t i) {
    const std::size_t ring = i % rings, column = i / rings % steps, sweep = i / (rings * steps);
    const SinCos elevation =
        sincos_turns(lowest_turn + (highest_turn - lowest_turn) * static_cast<double>(ring) / (rings - 1));
    const SinCos azimuth = sincos_turns((static_cast<double>(column) + 0.5) / static_cast<double>(steps));
    const Vec3d d{elevation.cos * azimuth.cos, elevation.cos * azimuth.sin, elevation.sin};
    const Vec3d o{advance * static_cast<double>(sweep % 100), 0,
                  height};  // a hundred places, then round again

    // The round wall stands about the origin; then the ground; then the boxes.
    const double a = d[0] * d[0] + d[1] * d[1], b = o[0] * d[0], c = o[0] * o[0] - wall_radius * wall_radius;
    double range = (std::sqrt(b * b - a * c) - b) / a;
    if (d[2] < 0) range = std::min(range, -height / d[2]);
    for (const Block& block : blocks) range = block.enter(o, d, range);

    Draws draws(job.seed, i);
    const double noise =
        draws.uniform() + draws.uniform() + draws.uniform() + draws.uniform() - 2;  // variance 1/3
    return sum(o, scaled(d, range + range_noise * 1.7320508075688772 * noise));
  });
}

}  // namespace treeline::datasets
