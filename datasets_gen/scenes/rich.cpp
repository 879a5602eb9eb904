// Scenes of many parts: fences, leaves, a city.
#include <algorithm>

#include "datasets_gen/noise.hpp"
#include "datasets_gen/scenes/parts.hpp"

namespace treeline::datasets {

using shading::Scene;

/// A fence of thin pickets, of uneven heights and gaps, in front of another: what is narrower than a texel or
/// a step of samples is lost or aliased.
Scene picket_fence(const SceneJob& j) {
  const double width = j.knobs[0];
  Parts parts;
  parts.floor(8, j.job.n / 4);
  const double pitch = 2 * width, length = 6;
  const auto pickets = std::size_t(length / pitch);
  const std::size_t cells = box_cells((j.job.n - j.job.n / 4) / (2 * pickets));
  for (std::size_t row = 0; row < 2; ++row)
    for (std::size_t k = 0; k < pickets; ++k) {
      Draws draws(j.job.seed, row * pickets + k);
      const double x = -0.5 * length + pitch * (double(k) + draws.uniform(0.1, 0.4)), z = -0.8 * double(row);
      parts.box({x, 0, z - 0.01}, {x + width, draws.uniform(1, 1.4), z + 0.01}, cells);
    }
  Scene r;
  r.mesh = std::move(parts.mesh), r.light = sun({0.5, -1, 1.2}, sun_angle);
  r.camera.position = {1.5, 3, 5.5}, r.camera.target = {0, 0.3, 0.8};
  return r;
}

/// The soup of leaves of the mesh "forest", and the ground that it stands on.
Scene leaves(const SceneJob& j) {
  const std::size_t ground = j.job.n / 10;
  const Job crowns{j.job.n - ground, j.job.seed, j.job.ticker};
  geometry::Mesh3f soup = forest(crowns);
  const double wide = 6 * std::sqrt(double(std::max<std::size_t>(16, crowns.n / 10'000)));  // as in forest
  Parts parts;
  parts.floor(1.2 * wide, ground, [&](double x, double z) {
    return 4 * fractal_noise(j.job.seed, {(x + 0.5 * wide) / 30, (0.5 * wide - z) / 30, 0.5}, 3);
  });
  for (auto& p : soup.vertices) p = {p[0] - float(0.5 * wide), p[2], float(0.5 * wide) - p[1]};
  parts.add(soup);
  Scene r;
  r.mesh = std::move(parts.mesh), r.light = sun({-0.5, -1, -0.35}, sun_angle);
  r.camera.position = {0.2 * wide, 14, 0.75 * wide}, r.camera.target = {0, 2, 0};
  return r;
}

/// Blocks of houses on a grid of streets, seen along one of them from a man's height to its end: what
/// cascades are for. Each house is a closed box that stands on the ground, some with a smaller one on top.
Scene city(const SceneJob& j) {
  constexpr double pitch = 24, street = 10;
  // A house has 12 faces, every third one 12 more.
  const std::size_t ground = j.job.n / 10;
  const std::size_t houses = std::max<std::size_t>(4, (j.job.n - ground) / 16);
  const std::size_t deep = std::max<std::size_t>(2, std::size_t(std::sqrt(2.0 * double(houses)) + 0.5));
  const std::size_t wide = std::max<std::size_t>(2, (houses + deep / 2) / deep);
  Parts parts;
  parts.floor(pitch * double(std::max(deep, wide) + 1), ground);
  const double x0 = -0.5 * pitch * double(wide - wide % 2), z0 = -0.5 * pitch * double(deep);
  for (std::size_t k = 0; k < wide * deep; ++k) {
    Draws draws(j.job.seed, k);
    const double x = x0 + pitch * double(k % wide) + 0.5 * street,
                 z = z0 + pitch * double(k / wide) + 0.5 * street;
    const double a = pitch - street - draws.uniform(0, 3), b = pitch - street - draws.uniform(0, 3);
    const double u = draws.uniform(), height = 6 + 6 * draws.uniform() + 50 * u * u * u * u;
    parts.box({x, 0, z}, {x + a, height, z + b});
    if (k % 3 == 0) parts.box({x + 2, height, z + 2}, {x + a - 3, height + 3, z + b - 3});
  }
  Scene r;
  r.mesh = std::move(parts.mesh), r.light = sun({0.6, -1, 0.35}, sun_angle);
  const double end = -z0 - 0.25 * pitch;  // in the street along x = 0
  r.camera.position = {0, 1.7, end}, r.camera.target = {0, 1.2, end - 10}, r.camera.height_angle = 0.9;
  return r;
}

}  // namespace treeline::datasets
