// How much of the light a surface gives back: towards one viewer under a sky of radiance 1 (by reciprocity,
// of the light from one direction), and on average over viewers by their cosine.
//
// By quadrature in double (albedo_quadrature.hpp), to 1e-8 where the quadrature is. Cost: 1 to 4 ms towards
// one viewer, some tens of them for an average, some thousands for one of an anisotropic surface.
#pragma once

#include "shading/brdf/albedo_quadrature.hpp"
#include "shading/brdf/bsdf.hpp"

namespace treeline::shading::brdf {

/// ∫ f cosθ dω of a material and its reflection (whose tables take longer to make than this takes); of glass,
/// light that passes counts as given back. wo above the surface.
inline Colour<double> directional_albedo(const Material& m, const Bsdf<double>& bsdf,
                                         const Direction<double>& wo) {
  if (m.kind == SurfaceKind::glass) return Colour<double>::filled(1);
  if (m.kind != SurfaceKind::microfacet) return Colour<double>(m.reflectance);
  return integrate_by_normals(m.alpha_x, m.alpha_y, wo,
                              [&](const Direction<double>& wi) { return bsdf.eval(wi, wo) * wi[2]; });
}
/// Throws InvalidMaterial.
inline Colour<double> directional_albedo(const Material& m, const Direction<double>& wo) {
  return directional_albedo(m, Bsdf<double>(m), wo);
}

/// (1/π) ∫ g(wo) cosθ dω over viewers, of a g that changes with the cosine as fast as near the horizon of
/// these roughnesses, and is symmetric about both tangents.
template <int N = 8, class G>
auto average_over_viewers(double ax, double ay, G&& g) {
  constexpr double pi = std::numbers::pi;
  const auto around = [&](double mu) {
    const double sine = std::sqrt((1 - mu) * (1 + mu));
    if (ax == ay) return g(Direction<double>{sine, 0, mu});
    decltype(g(Direction<double>{})) sum{};
    const auto part = [&](double from, double to) {
      sum += geometry::integrate<N>(
          [&](double phi) {
            const double c = sine * std::cos(phi), s = sine * std::sin(phi);
            return g(ax < ay ? Direction<double>{c, s, mu} : Direction<double>{s, c, mu}) * (2 / pi);
          },
          from, to);
    };
    detail::graded(0, 0.5 * pi, std::min(ax, ay) / std::max(ax, ay), part);  // from the smoother tangent
    return sum;
  };
  decltype(g(Direction<double>{})) sum{};
  detail::graded(0, 1, std::min({0.5 * ax, 0.5 * ay, 0.5}), [&](double from, double to) {
    sum += geometry::integrate<N>([&](double mu) { return around(mu) * (2 * mu); }, from, to);
  });
  return sum;
}

/// Throws InvalidMaterial.
inline Colour<double> average_albedo(const Material& m) {
  if (m.kind != SurfaceKind::microfacet) return directional_albedo(m, {0, 0, 1});
  const Bsdf<double> bsdf(m);
  return average_over_viewers(m.alpha_x, m.alpha_y, [&](const Direction<double>& wo) {
    return integrate_by_normals<8>(m.alpha_x, m.alpha_y, wo,
                                   [&](const Direction<double>& wi) { return bsdf.eval(wi, wo) * wi[2]; });
  });
}

}  // namespace treeline::shading::brdf
