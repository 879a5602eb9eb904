// Materials: what a surface does to light, as data. What is done with them is in shading/brdf.
#pragma once

#include <string>

#include "geometry/vec.hpp"

namespace treeline::shading {

/// Radiance, reflectance or index by channel: red, green, blue.
using Rgb = geometry::Vec3f;

enum class SurfaceKind { diffuse, mirror, glass, microfacet };
enum class Distribution { ggx, beckmann };
/// How shadowing and masking of microfacets go together: independent of each other, or by their heights.
enum class Masking { separable, correlated };
/// One: a surface that reflects all. Schlick: from `reflectance` at normal incidence.
enum class FresnelKind { one, schlick, dielectric, conductor };
/// What gives back the light that single scattering between microfacets loses. Textbook and directional are
/// colour terms found in teaching that count light twice and that are not reciprocal.
enum class Compensation { none, kulla_conty, kulla_conty_textbook, kulla_conty_directional, turquin };

struct Material {
  std::string name;
  SurfaceKind kind = SurfaceKind::diffuse;
  /// Albedo of a diffuse surface, share that a mirror reflects, reflectance of Schlick at normal incidence.
  Rgb reflectance{0.5f, 0.5f, 0.5f};
  /// Radiance that leaves the front of its faces, the same in all directions; W / (m² sr).
  Rgb emission{};
  // Of microfacets; roughness along the two tangents.
  Distribution distribution = Distribution::ggx;
  Masking masking = Masking::correlated;
  double alpha_x = 0.3, alpha_y = 0.3;
  FresnelKind fresnel = FresnelKind::one;
  Compensation compensation = Compensation::none;
  /// Refractive index of glass and dielectrics: inside over outside. Of conductors, index and extinction.
  double index = 1.5;
  Rgb conductor_index{0.2f, 0.92f, 1.1f}, conductor_extinction{3.9f, 2.45f, 2.14f};  // gold
};

}  // namespace treeline::shading
