// What a surface does to light, of any material: the function, a sampler, and the sampler's density.
//
// One type for all kinds, told apart by a switch, so that a renderer keeps one array of them.
// Light that facets reflect more than once: by a second lobe, sampled by the cosine (kulla_conty.hpp), or by
// a scale (turquin.hpp); their tables are made when the surface is, and shared by its copies. Cost: a table
// takes 5 to 70 ms of an isotropic surface, up to a second of an anisotropic one. Conventions: local frame, z
// = normal; wi towards the light, wo towards the viewer, both away from the surface; the cosine is not part
// of the function. Opaque surfaces have one side: seen from below, they reflect nothing.
#pragma once

#include <optional>

#include "shading/brdf/check_material.hpp"
#include "shading/brdf/fresnel_term.hpp"
#include "shading/brdf/glass.hpp"
#include "shading/brdf/kulla_conty.hpp"
#include "shading/brdf/lambert.hpp"
#include "shading/brdf/microfacet.hpp"
#include "shading/brdf/turquin.hpp"

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
        ggx_(T(m.alpha_x), T(m.alpha_y)),
        beckmann_{T(m.alpha_x), T(m.alpha_y)},
        index_(T(m.index)),
        reflectance_(m.reflectance),
        fresnel_(m) {
    if (kind_ != SurfaceKind::microfacet || m.compensation == Compensation::none) return;
    const auto table = std::make_shared<const AlbedoTable>(m);
    if (m.compensation == Compensation::turquin)
      turquin_.emplace(table, fresnel_(T(1)));
    else
      kulla_conty_.emplace(table, m.compensation, fresnel_.average());
  }

  /// Mirror or glass: eval and pdf are 0, only sampling meets the reflection.
  bool delta() const { return kind_ == SurfaceKind::mirror || kind_ == SurfaceKind::glass; }

  /// By channel, per steradian, without the cosine.
  Colour<T> eval(const Direction<T>& wi, const Direction<T>& wo) const {
    if (delta() || !(wi[2] > T(0) && wo[2] > T(0))) return {};
    if (kind_ == SurfaceKind::diffuse) return reflectance_ * lambert(wi, wo);
    return with_facets([&](const auto& facets) {
      const Direction<T> m = wi + wo;  // as long as twice the cosine between either and the half vector
      const T square = geometry::dot(m, m);
      const Colour<T> once = once_colour(wo, T(0.5) * std::sqrt(square)) * facets.eval(wi, wo, m, square);
      return kulla_conty_ ? once + kulla_conty_->eval(wi, wo) : once;
    });
  }

  /// Density of sample's wi, per steradian.
  T pdf(const Direction<T>& wi, const Direction<T>& wo) const {
    if (delta() || !(wi[2] > T(0) && wo[2] > T(0))) return T(0);
    if (kind_ == SurfaceKind::diffuse) return lambert_pdf(wi);
    return with_facets([&](const auto& facets) {
      const T once = facets.pdf(wi, wo), many = many_share(wo);
      return many > T(0) ? once + (lambert_pdf(wi) - once) * many : once;
    });
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
    const T many = many_share(wo);
    return with_facets([&](const auto& facets) {
      const bool matt = choice < many;
      const Direction<T> drawn = matt ? sample_lambert(u, v) : facets.sample_normal(wo, u, v);
      const Direction<T> wi = matt ? drawn : reflected(wo, drawn), h = matt ? half_vector(wi, wo) : drawn;
      if (!(wi[2] > T(0))) return BsdfSample<T>{};
      const T pdf_once = facets.pdf_by_normal(h, wo);
      const Colour<T> weight_once = once_colour(wo, geometry::dot(wo, h)) * facets.weight(wi, wo);
      if (!(many > T(0))) return BsdfSample<T>{wi, weight_once, pdf_once, false};
      const T pdf = pdf_once + (lambert_pdf(wi) - pdf_once) * many;
      return BsdfSample<T>{wi, weight_once * (pdf_once / pdf) + kulla_conty_->eval(wi, wo) * (wi[2] / pdf),
                           pdf, false};
    });
  }

 private:
  /// Fresnel's factor of a single bounce, scaled up where that is how its loss is made good; cosine: between
  /// wo and the facet's normal.
  Colour<T> once_colour(const Direction<T>& wo, T cosine) const {
    Colour<T> f = fresnel_(cosine);
    if (!turquin_) return f;
    const Colour<T> scale = turquin_->scale(wo);
    for (int i = 0; i < 3; ++i) f[i] *= scale[i];
    return f;
  }
  /// Probability of sampling the lobe of many bounces.
  T many_share(const Direction<T>& wo) const { return kulla_conty_ ? kulla_conty_->share(wo) : T(0); }

  template <class F>
  auto with_facets(F&& f) const {
    if (distribution_ == Distribution::ggx) return f(Microfacets<Ggx<T>>{ggx_, masking_});
    return f(Microfacets<Beckmann<T>>{beckmann_, masking_});
  }

  SurfaceKind kind_;
  Distribution distribution_;
  Masking masking_;
  Ggx<T> ggx_;
  Beckmann<T> beckmann_;
  T index_;
  Colour<T> reflectance_;
  FresnelTerm<T> fresnel_;
  std::optional<KullaConty<T>> kulla_conty_;
  std::optional<Turquin<T>> turquin_;
};

}  // namespace treeline::shading::brdf
