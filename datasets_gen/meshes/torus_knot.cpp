// A trefoil: a rough tube around a (2, 3) torus knot; closed, and its box is mostly empty.
// The tube's frame is the normal of the torus that the knot winds on: periodic by itself, so the seam closes
// exactly.
#include "datasets_gen/noise.hpp"
#include "datasets_gen/recipe.hpp"

namespace treeline::datasets {

geometry::Mesh3f torus_knot(const Job& job) {
  constexpr double p = 2, q = 3, torus = 1, belly = 0.4, tube = 0.15;
  constexpr double turn = 6.283185307179586;
  constexpr double slenderness = 15.5;  // length of the knot over the girth of the tube: near-square quads
  const std::size_t around = std::max<std::size_t>(
      3, static_cast<std::size_t>(std::sqrt(static_cast<double>(job.n) / 2 / slenderness) + 0.5));
  const std::size_t along = (job.n / 2 + around / 2) / around;

  geometry::Mesh3f mesh;
  mesh.vertices.resize(around * along);
  mesh.faces.resize(2 * around * along);
  job.each(
      mesh.vertices.size(),
      [&](std::size_t i) {
        const double s = static_cast<double>(i / around) / static_cast<double>(along);
        const SinCos u = sincos_turns(p * s), v = sincos_turns(q * s);
        const double ring = torus + belly * v.cos;
        const Vec3d centre{ring * u.cos, ring * u.sin, belly * v.sin};
        const Vec3d normal{v.cos * u.cos, v.cos * u.sin,
                           v.sin};  // of the torus: unit, and square to the tangent
        const Vec3d tangent = unit_portable({turn * (-p * ring * u.sin - q * belly * v.sin * u.cos),
                                             turn * (p * ring * u.cos - q * belly * v.sin * u.sin),
                                             turn * (q * belly * v.cos)});
        const Vec3d side = cross_portable(tangent, normal);
        const SinCos w = sincos_turns(static_cast<double>(i % around) / static_cast<double>(around));
        const Vec3d out = sum(scaled(normal, w.cos), scaled(side, w.sin));
        const Vec3d smooth = sum(centre, scaled(out, tube));
        mesh.vertices[i] =
            rounded(sum(smooth, scaled(out, 0.03 * fractal_noise(job.seed, scaled(smooth, 6), 4))));
      },
      0.9);
  job.each(
      around * along,
      [&](std::size_t quad) {
        const std::size_t i = quad / around, j = quad % around, i1 = (i + 1) % along, j1 = (j + 1) % around;
        const auto at = [&](std::size_t k, std::size_t l) {
          return static_cast<std::uint32_t>(k * around + l);
        };
        mesh.faces[2 * quad] = {at(i, j), at(i1, j1), at(i1, j)};
        mesh.faces[2 * quad + 1] = {at(i, j), at(i, j1), at(i1, j1)};
      },
      0.1);
  return mesh;
}

}  // namespace treeline::datasets
