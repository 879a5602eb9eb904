// A soup of small leaves in the crowns of trees on uneven ground: no shared corners, no order, much overlap
// of boxes.
#include "datasets_gen/noise.hpp"
#include "datasets_gen/recipe.hpp"

namespace treeline::datasets {

geometry::Mesh3f forest(const Job& job) {
  const std::size_t trees = std::max<std::size_t>(16, job.n / 10'000);
  const double side = 6 * std::sqrt(static_cast<double>(trees));  // metres; one tree per 36 m²
  geometry::Mesh3f mesh;
  mesh.vertices.resize(3 * job.n);
  mesh.faces.resize(job.n);
  job.each(job.n, [&](std::size_t i) {
    const std::uint64_t tree = i % trees;
    Draws wood(~job.seed, tree);
    const double x = wood.uniform(0, side), y = wood.uniform(0, side);
    const double ground = 4 * fractal_noise(job.seed, {x / 30, y / 30, 0.5}, 3);
    const double crown = wood.uniform(1.5, 3.5), tall = wood.uniform(1, 2) * crown;

    Draws draws(job.seed, i);
    // Crowns are denser at their surface, where the light is: the radius is the largest of six uniforms.
    double r = 0;
    for (int k = 0; k < 6; ++k) r = std::max(r, draws.uniform());
    const Vec3d d = draws.direction();
    const Vec3d at{x + crown * r * d[0], y + crown * r * d[1], ground + 2 + tall + tall * r * d[2]};
    const double size = draws.uniform(0.03, 0.08);
    const Vec3d tip = draws.direction(), other = draws.direction();
    const Vec3d across = scaled(cross_portable(tip, other), 0.5 * size);
    mesh.vertices[3 * i] = rounded(sum(at, scaled(tip, size)));
    mesh.vertices[3 * i + 1] = rounded(sum(at, across));
    mesh.vertices[3 * i + 2] = rounded(sum(at, scaled(across, -1)));
    const auto v = static_cast<std::uint32_t>(3 * i);
    mesh.faces[i] = {v, v + 1, v + 2};
  });
  return mesh;
}

}  // namespace treeline::datasets
