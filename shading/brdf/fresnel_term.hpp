// Fresnel's factor of a material, by channel, and its average over a diffuse sky.
#pragma once

#include "shading/brdf/directions.hpp"
#include "shading/brdf/fresnel.hpp"
#include "shading/material.hpp"

namespace treeline::shading::brdf {

template <std::floating_point T>
class FresnelTerm {
 public:
  /// Of a material that check_material has accepted.
  explicit FresnelTerm(const Material& m)
      : kind_(m.fresnel),
        index_(T(m.index)),
        a_(m.fresnel == FresnelKind::conductor ? Colour<T>(m.conductor_index) : Colour<T>(m.reflectance)),
        b_(Colour<T>(m.conductor_extinction)) {}

  /// cosine: between the light and the facet's normal, in [0, 1].
  Colour<T> operator()(T cosine) const {
    switch (kind_) {
      case FresnelKind::schlick:
        return {fresnel_schlick(cosine, a_[0]), fresnel_schlick(cosine, a_[1]),
                fresnel_schlick(cosine, a_[2])};
      case FresnelKind::dielectric:
        return Colour<T>::filled(fresnel_dielectric(std::min(cosine, T(1)), index_));
      case FresnelKind::conductor: {
        const T c = std::min(cosine, T(1));
        return {fresnel_conductor(c, a_[0], b_[0]), fresnel_conductor(c, a_[1], b_[1]),
                fresnel_conductor(c, a_[2], b_[2])};
      }
      default:
        return Colour<T>::filled(T(1));
    }
  }

  /// F̄ = 2 ∫ F(μ) μ dμ. Costs some hundred evaluations: once per material.
  Colour<T> average() const {
    Colour<T> r = Colour<T>::filled(T(1));
    for (int i = 0; i < 3; ++i) {
      if (kind_ == FresnelKind::schlick) r[i] = fresnel_average_schlick(a_[i]);
      if (kind_ == FresnelKind::dielectric) r[i] = T(fresnel_average_dielectric(double(index_)));
      if (kind_ == FresnelKind::conductor) r[i] = T(fresnel_average_conductor(double(a_[i]), double(b_[i])));
    }
    return r;
  }

 private:
  FresnelKind kind_;
  T index_;
  Colour<T> a_, b_;  // reflectance; or index and extinction
};

}  // namespace treeline::shading::brdf
