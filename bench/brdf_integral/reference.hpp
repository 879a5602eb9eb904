// BRDFs of microfacets as textbooks write them, with angles, in double: the second witness beside
// shading/brdf, from which it takes nothing. Without compensation.
//
// Sources: Walter et al. 2007 (D, G1 of both distributions, with their angles), Heitz 2014 (masking by
// heights), Burley 2012 (D by both tangents), Born and Wolf 1999 (complex amplitudes at a boundary).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>

#include "geometry/vec.hpp"
#include "shading/material.hpp"

namespace treeline::bench::brdf_integral::reference {

using geometry::Vec3d;
using shading::Material;

/// Share of unpolarised light that a boundary reflects; index and extinction over those before it.
inline double fresnel(double cosine, double index, double extinction) {
  using Complex = std::complex<double>;
  const Complex n{index, extinction};
  const Complex far = std::sqrt(1.0 - (1 - cosine * cosine) / (n * n));  // cosine behind the boundary
  const Complex s = (cosine - n * far) / (cosine + n * far), p = (n * cosine - far) / (n * cosine + far);
  return 0.5 * (std::norm(s) + std::norm(p));
}

inline double schlick(double cosine, double head_on) {
  return head_on + (1 - head_on) * std::pow(1 - cosine, 5);
}

/// Roughness along the azimuth of w: of slopes, not of the half vector.
inline double alpha_along(const Material& m, double x, double y) {
  const double r2 = x * x + y * y;
  return r2 > 0 ? std::sqrt((m.alpha_x * m.alpha_x * x * x + m.alpha_y * m.alpha_y * y * y) / r2) : m.alpha_x;
}

inline double distribution(const Material& m, const Vec3d& h) {
  const double cos2 = h[2] * h[2], tan2 = (h[0] * h[0] + h[1] * h[1]) / cos2,
               azimuth = std::atan2(h[1], h[0]);
  const double c = std::cos(azimuth) / m.alpha_x, s = std::sin(azimuth) / m.alpha_y,
               e = tan2 * (c * c + s * s);
  const double area = std::numbers::pi * m.alpha_x * m.alpha_y * cos2 * cos2;
  return m.distribution == shading::Distribution::ggx ? 1 / (area * (1 + e) * (1 + e)) : std::exp(-e) / area;
}

inline double lambda(const Material& m, const Vec3d& w) {
  const double tangent = std::hypot(w[0], w[1]) / w[2], a = alpha_along(m, w[0], w[1]) * tangent;
  if (m.distribution == shading::Distribution::ggx) return 0.5 * (std::sqrt(1 + a * a) - 1);
  if (a < 0.1) return 0;  // below 1e-45
  const double v = 1 / a;
  return 0.5 * (std::erf(v) - 1) + std::exp(-v * v) / (2 * v * std::sqrt(std::numbers::pi));
}

/// Reflectance of the facets by channel.
inline std::array<double, 3> facet(const Material& m, double cosine) {
  std::array<double, 3> f{1, 1, 1};
  for (std::size_t c = 0; c < 3; ++c) {
    const int i = int(c);
    if (m.fresnel == shading::FresnelKind::schlick) f[c] = schlick(cosine, double(m.reflectance[i]));
    if (m.fresnel == shading::FresnelKind::dielectric) f[c] = fresnel(cosine, m.index, 0);
    if (m.fresnel == shading::FresnelKind::conductor)
      f[c] = fresnel(cosine, double(m.conductor_index[i]), double(m.conductor_extinction[i]));
  }
  return f;
}

/// By channel, per steradian; zero below the surface. Of diffuse surfaces and microfacets.
inline std::array<double, 3> brdf(const Material& m, const Vec3d& wi, const Vec3d& wo) {
  if (!(wi[2] > 0 && wo[2] > 0)) return {};
  if (m.kind == shading::SurfaceKind::diffuse) {
    const double inv_pi = 1 / std::numbers::pi;
    return {double(m.reflectance[0]) * inv_pi, double(m.reflectance[1]) * inv_pi,
            double(m.reflectance[2]) * inv_pi};
  }
  const Vec3d h = normalized(wi + wo);
  const double li = lambda(m, wi), lo = lambda(m, wo);
  const double g = m.masking == shading::Masking::correlated ? 1 / (1 + li + lo) : 1 / ((1 + li) * (1 + lo));
  const double f = distribution(m, h) * g / (4 * wi[2] * wo[2]);
  std::array<double, 3> r = facet(m, std::min(1.0, dot(wi, h)));
  for (double& x : r) x *= f;
  return r;
}

}  // namespace treeline::bench::brdf_integral::reference
