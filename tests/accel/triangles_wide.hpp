// Rays for tests of the wide tree over triangles: of all kinds, those that strain the box test included.
#pragma once

#include "tests/accel/triangles_common.hpp"

namespace treeline::accel::test {

using V = Vec<float, 3>;
using R = Ray<float>;

inline std::vector<R> random_rays(std::size_t n, std::uint64_t seed, V centre = {}, float scale = 1) {
  Pcg32 random(seed, 1);
  std::vector<R> rays;
  for (std::size_t i = 0; i < n; ++i) {
    R ray{in_cube(random, 2.0f) * scale + centre, in_cube(random, 1.0f)};
    if (i % 4 == 1) ray.direction[static_cast<int>(i / 4 % 3)] = i % 8 == 1 ? 0.0f : -0.0f;
    if (i % 16 == 2) ray.direction = {0, 0, i % 32 == 2 ? 1.0f : -1.0f};
    if (i % 16 == 3) ray.direction[0] = std::numeric_limits<float>::denorm_min() * 3;
    if (i % 5 == 0) ray.t_min = scale * 0.5f, ray.t_max = scale * 1.5f;
    if (i % 7 == 0) ray.t_min = -scale * 2;
    if (i % 11 == 0) ray.direction = ray.direction * 1e-3f;
    rays.push_back(ray);
  }
  return rays;
}

}  // namespace treeline::accel::test
