// What a surface does to light, of any material: the function, a sampler, and the sampler's density.
//
// One type for all kinds, told apart by a switch, so that a renderer keeps one array of them.
// Conventions: local frame, z = normal; wi towards the light, wo towards the viewer, both away from the
// surface; the cosine is not part of the function. Opaque surfaces have one side: seen from below, they
// reflect nothing.
#pragma once

#include "shading/brdf/check_material.hpp"
#include "shading/brdf/fresnel_term.hpp"
#include "shading/brdf/glass.hpp"
#include "shading/brdf/lambert.hpp"
#include "shading/brdf/microfacet.hpp"

namespace treeline::shading::brdf {

template <std::floating_point T>
struct BsdfSample {
  Direction<T> wi{0, 0, 1};
  Colour<T> weight{};  ///< f |cosθi| / pdf; all zero: the light is lost
  T pdf = 0;           ///< per steradian; 0 where `delta`, and where the light is lost
  bool delta = false;  ///< wi is the only direction, with all of the weight
};

template <std::floating_point T>
class Bsdf {
 public:
  /// Throws InvalidMaterial.
  explicit Bsdf(const Material& m)
      : kind_((check_material(m), m.kind)),
        distribution_(m.distribution),
        masking_(m.masking),
        ax_(T(m.alpha_x)),
        ay_(T(m.alpha_y)),
        index_(T(m.index)),
        reflectance_(m.reflectance),
        fresnel_(m) {}

  /// Mirror or glass: eval and pdf are 0, only sampling meets the reflection.
  bool delta() const { return kind_ == SurfaceKind::mirror || kind_ == SurfaceKind::glass; }

  /// By channel, per steradian, without the cosine.
  Colour<T> eval(const Direction<T>& wi, const Direction<T>& wo) const {
    if (delta() || !(wi[2] > T(0) && wo[2] > T(0))) return {};
    if (kind_ == SurfaceKind::diffuse) return reflectance_ * lambert(wi, wo);
    return with_facets([&](const auto& facets) {
      return fresnel_(geometry::dot(wi, half_vector(wi, wo))) * facets.eval(wi, wo);
    });
  }

  /// Density of sample's wi, per steradian.
  T pdf(const Direction<T>& wi, const Direction<T>& wo) const {
    if (delta() || !(wi[2] > T(0) && wo[2] > T(0))) return T(0);
    if (kind_ == SurfaceKind::diffuse) return lambert_pdf(wi);
    return with_facets([&](const auto& facets) { return facets.pdf(wi, wo); });
  }

  /// choice, u, v: independent and uniform in [0, 1). wo below the surface is inside of glass.
  BsdfSample<T> sample(const Direction<T>& wo, T choice, T u, T v) const {
    if (kind_ == SurfaceKind::glass) {
      const GlassSample<T> s = sample_glass(wo, index_, choice);
      return {s.wi, Colour<T>::filled(s.weight), T(0), true};
    }
    if (!(wo[2] > T(0))) return {};
    if (kind_ == SurfaceKind::mirror) return {mirrored(wo), reflectance_, T(0), true};
    if (kind_ == SurfaceKind::diffuse) {
      const Direction<T> wi = sample_lambert(u, v);
      return wi[2] > T(0) ? BsdfSample<T>{wi, reflectance_, lambert_pdf(wi), false} : BsdfSample<T>{};
    }
    return with_facets([&](const auto& facets) {
      const Direction<T> wi = facets.sample(wo, u, v);
      if (!(wi[2] > T(0))) return BsdfSample<T>{};
      const Colour<T> f = fresnel_(geometry::dot(wi, half_vector(wi, wo)));
      return BsdfSample<T>{wi, f * facets.weight(wi, wo), facets.pdf(wi, wo), false};
    });
  }

 private:
  template <class F>
  auto with_facets(F&& f) const {
    if (distribution_ == Distribution::ggx) return f(Microfacets<Ggx<T>>{{ax_, ay_}, masking_});
    return f(Microfacets<Beckmann<T>>{{ax_, ay_}, masking_});
  }

  SurfaceKind kind_;
  Distribution distribution_;
  Masking masking_;
  T ax_, ay_, index_;
  Colour<T> reflectance_;
  FresnelTerm<T> fresnel_;
};

}  // namespace treeline::shading::brdf
