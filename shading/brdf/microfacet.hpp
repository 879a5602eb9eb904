// Reflection by microfacets that are perfect mirrors, one bounce (Torrance and Sparrow 1967; Walter et al.
// 2007): f = D(h) G2(i, o) / (4 cosθi cosθo), without Fresnel's factor, which depends on i·h only.
//
// Sampled by the facets that o sees (ggx_visible.hpp, bounded; beckmann_visible.hpp), so that the weight
// f cosθi / pdf is a ratio of shadowings, at most 1, in which the large D of a near-mirror does not occur.
// Cost: D and two maskings for eval. Known weakness: light that facets reflect onto other facets is lost: 31
// % at α = 0.5, 62 % at α = 1 (GGX, separable); kulla_conty.hpp gives it back. In float the half vector has
// an error of 1e-7, so eval and pdf (not the weight of a sample) are no better than (1e-7/α)² near the peak.
#pragma once

#include "shading/brdf/beckmann_visible.hpp"
#include "shading/brdf/ggx_visible.hpp"
#include "shading/brdf/smith.hpp"

namespace treeline::shading::brdf {

namespace detail {

template <class T>
T sampled_area(const Ggx<T>& d, const Direction<T>& o) {
  return bounded_area(d, o);
}
template <class T>
T sampled_area(const Beckmann<T>& d, const Direction<T>& o) {
  return d.projected_area(o);
}
template <class T>
Direction<T> sampled_normal(const Ggx<T>& d, const Direction<T>& o, T u, T v) {
  return sample_visible_bounded(d, o, u, v);
}
template <class T>
Direction<T> sampled_normal(const Beckmann<T>& d, const Direction<T>& o, T u, T v) {
  return sample_visible(d, o, u, v);
}

}  // namespace detail

/// Normals: Ggx or Beckmann. wi, wo: unit; nothing is reflected unless both are above the surface.
template <class Normals>
struct Microfacets {
  using T = typename Normals::Scalar;
  Normals normals;
  Masking masking = Masking::correlated;

  /// Per steradian, without the cosine.
  T eval(const Direction<T>& wi, const Direction<T>& wo) const {
    if (!(wi[2] > T(0) && wo[2] > T(0))) return T(0);
    const Direction<T> m = wi + wo;
    return eval(wi, wo, m, dot(m, m));
  }
  /// m: wi + wo, with its square; both above the surface. To bring it to unit length would cost a root and
  /// three divisions, and digits.
  T eval(const Direction<T>& wi, const Direction<T>& wo, const Direction<T>& m, T square) const {
    return T(0.25) * normals.d_along(m, square) * smith_g2_by_cosines(normals, masking, wi, wo);
  }

  /// Density of `sample` per steradian.
  T pdf(const Direction<T>& wi, const Direction<T>& wo) const {
    if (!(wi[2] > T(0) && wo[2] > T(0))) return T(0);
    const Direction<T> m = wi + wo;
    return T(0.25) * normals.d_along(m, dot(m, m)) / detail::sampled_area(normals, wo);
  }
  T pdf_by_normal(const Direction<T>& h, const Direction<T>& wo) const {
    return T(0.25) * normals.d(h) / detail::sampled_area(normals, wo);
  }

  /// A direction wi, below the surface where the light is lost; u, v in [0, 1), wo above the surface.
  Direction<T> sample(const Direction<T>& wo, T u, T v) const {
    return reflected(wo, sample_normal(wo, u, v));
  }
  /// The facet's normal of such a sample.
  Direction<T> sample_normal(const Direction<T>& wo, T u, T v) const {
    return detail::sampled_normal(normals, wo, u, v);
  }

  /// f cosθi / pdf of a sample, in [0, 1].
  T weight(const Direction<T>& wi, const Direction<T>& wo) const {
    if (!(wi[2] > T(0) && wo[2] > T(0))) return T(0);
    return wi[2] * detail::sampled_area(normals, wo) * smith_g2_by_cosines(normals, masking, wi, wo);
  }
};

}  // namespace treeline::shading::brdf
