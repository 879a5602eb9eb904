// What a material must be so that its reflection is defined: refused otherwise, with field and figure.
#pragma once

#include <cmath>
#include <stdexcept>
#include <string>

#include "shading/material.hpp"

namespace treeline::shading::brdf {

/// Message: material, field, what it is and what it must be.
struct InvalidMaterial : std::invalid_argument {
  using std::invalid_argument::invalid_argument;
};

/// Below this roughness D and f leave the range of float (f up to 1 / (π α⁴) at grazing); a mirror instead.
inline constexpr double smallest_alpha = 1e-9;
/// Slopes of 10 and more: a surface of needles, of which no more is known.
inline constexpr double largest_alpha = 10;

/// Throws InvalidMaterial.
inline void check_material(const Material& m) {
  const auto refuse = [&](const std::string& field, const std::string& what) {
    throw InvalidMaterial("material '" + m.name + "': " + field + " " + what);
  };
  const auto within = [&](const std::string& field, double value, double low, double high) {
    if (!(value >= low && value <= high))
      refuse(field, "is " + std::to_string(value) + ", must be in [" + std::to_string(low) + ", " +
                        std::to_string(high) + "]");
  };
  const auto colour = [&](const std::string& field, const Rgb& c, double low, double high) {
    for (int i = 0; i < 3; ++i) within(field + "[" + std::to_string(i) + "]", double(c[i]), low, high);
  };
  const auto index = [&] { within("index", m.index, 0.01, 100); };

  colour("emission", m.emission, 0, std::numeric_limits<float>::max());
  switch (m.kind) {
    case SurfaceKind::diffuse:
    case SurfaceKind::mirror:
      return colour("reflectance", m.reflectance, 0, 1);
    case SurfaceKind::glass:
      return index();
    case SurfaceKind::microfacet:
      break;
    default:
      refuse("kind", "is none of the known ones");
  }
  if (m.distribution != Distribution::ggx && m.distribution != Distribution::beckmann)
    refuse("distribution", "is none of the known ones");
  if (m.masking != Masking::separable && m.masking != Masking::correlated)
    refuse("masking", "is none of the known ones");
  if (m.compensation < Compensation::none || m.compensation > Compensation::turquin)
    refuse("compensation", "is none of the known ones");
  within("alpha_x", m.alpha_x, smallest_alpha, largest_alpha);
  within("alpha_y", m.alpha_y, smallest_alpha, largest_alpha);
  switch (m.fresnel) {
    case FresnelKind::one:
      return;
    case FresnelKind::schlick:
      return colour("reflectance", m.reflectance, 0, 1);
    case FresnelKind::dielectric:
      return index();
    case FresnelKind::conductor:
      colour("conductor_index", m.conductor_index, 0, 1e4);
      return colour("conductor_extinction", m.conductor_extinction, 0, 1e4);
    default:
      refuse("fresnel", "is none of the known ones");
  }
}

}  // namespace treeline::shading::brdf
