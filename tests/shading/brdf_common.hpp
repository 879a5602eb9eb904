// Materials and directions for the tests of shading/brdf.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "geometry/vec.hpp"
#include "shading/material.hpp"

namespace treeline::shading::brdf::test {

/// Facets that reflect all.
inline Material facets(Distribution distribution, Masking masking, double ax, double ay) {
  Material m;
  m.kind = SurfaceKind::microfacet;
  m.distribution = distribution, m.masking = masking;
  m.alpha_x = ax, m.alpha_y = ay;
  m.name = std::string(distribution == Distribution::ggx ? "ggx" : "beckmann") +
           (masking == Masking::separable ? " separable " : " correlated ") + std::to_string(ax) + " " +
           std::to_string(ay);
  return m;
}
inline Material ggx(double alpha) { return facets(Distribution::ggx, Masking::correlated, alpha, alpha); }

/// Both distributions with both maskings, smooth to rough, isotropic and anisotropic.
inline std::vector<Material> all_facets() {
  std::vector<Material> all;
  for (const auto d : {Distribution::ggx, Distribution::beckmann})
    for (const auto m : {Masking::separable, Masking::correlated})
      for (const auto& [x, y] :
           {std::pair{0.02, 0.02}, {0.1, 0.1}, {0.3, 0.3}, {1.0, 1.0}, {0.05, 0.5}, {0.9, 0.2}})
        all.push_back(facets(d, m, x, y));
  return all;
}

/// A matt surface and facets, those also with every kind of Fresnel's factor.
inline std::vector<Material> opaque_materials() {
  std::vector<Material> all = all_facets();
  for (const auto f : {FresnelKind::schlick, FresnelKind::dielectric, FresnelKind::conductor}) {
    all.push_back(ggx(0.4));
    all.back().fresnel = f;
    all.back().name += " fresnel " + std::to_string(int(f));
    all.back().reflectance = {0.04f, 0.5f, 0.9f};
  }
  all.emplace_back();
  all.back().name = "diffuse";
  return all;
}

/// Towards a viewer at this cosine and azimuth.
template <class T = double>
geometry::Vec<T, 3> at(double cosine, double azimuth = 0) {
  const double sine = std::sqrt((1 - cosine) * (1 + cosine));
  return {T(sine * std::cos(azimuth)), T(sine * std::sin(azimuth)), T(cosine)};
}

}  // namespace treeline::shading::brdf::test
