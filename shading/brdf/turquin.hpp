// Gives back the light that a single bounce between facets loses by scaling the single bounce up (Turquin
// 2019, "Practical multiple scattering compensation for microfacet models"): f · (1 + F0 (1 - E(o)) / E(o)).
//
// Keeps the lobe's shape, needs one look-up and no average. A white furnace stays white for F0 = 1. Known
// weakness: not reciprocal: f(i,o) / f(o,i) is E(i) / E(o) at F0 = 1, for GGX at α = 1 up to 2.48 between
// head-on and cosθ = 0.1.
#pragma once

#include <memory>

#include "shading/brdf/albedo_table.hpp"

namespace treeline::shading::brdf {

template <std::floating_point T>
class Turquin {
 public:
  /// normal: Fresnel's factor at normal incidence.
  Turquin(std::shared_ptr<const AlbedoTable> table, const Colour<T>& normal)
      : table_(std::move(table)), normal_(normal) {}

  /// What to multiply the single bounce with; wo above the surface.
  Colour<T> scale(const Direction<T>& wo) const {
    const T e = (*table_)(wo);
    return Colour<T>::filled(T(1)) + normal_ * ((T(1) - e) / e);
  }

 private:
  std::shared_ptr<const AlbedoTable> table_;
  Colour<T> normal_;
};

}  // namespace treeline::shading::brdf
