// Smith's shadowing and masking of microfacets (Smith 1967; Heitz 2014, "Understanding the masking-shadowing
// function in microfacet-based BRDFs").
//
// Two conventions are about, and at α = 1, cosθ = 0.1 they differ by a third in what is reflected (0.56 and
// 0.76 for GGX): shadowing independent of masking, G2 = G1(i) G1(o); and both by the height of the facet,
// G2 = 1 / (1 + Λ(i) + Λ(o)). In terms of the distribution's projected_area A = cosθ (1 + Λ), the combination
// that reflection needs has no division by a cosine and stays finite at grazing directions.
// Cost: two of A.
#pragma once

#include "shading/brdf/directions.hpp"
#include "shading/material.hpp"

namespace treeline::shading::brdf {

/// Share of the facets that is seen from o, above the surface.
template <class Normals, class T>
T smith_g1(const Normals& normals, const Direction<T>& o) {
  return o[2] / normals.projected_area(o);
}

/// G2(wi, wo) / (cosθi cosθo); both above the surface.
template <class Normals, class T>
T smith_g2_by_cosines(const Normals& normals, Masking masking, const Direction<T>& wi,
                      const Direction<T>& wo) {
  const T ai = normals.projected_area(wi), ao = normals.projected_area(wo);
  if (masking == Masking::separable) return T(1) / (ai * ao);
  return T(1) / (ai * wo[2] + (ao - wo[2]) * wi[2]);
}

/// Share of the facets that is seen from both; both above the surface.
template <class Normals, class T>
T smith_g2(const Normals& normals, Masking masking, const Direction<T>& wi, const Direction<T>& wo) {
  return smith_g2_by_cosines(normals, masking, wi, wo) * wi[2] * wo[2];
}

}  // namespace treeline::shading::brdf
