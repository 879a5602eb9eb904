// The ideal diffuse surface (Lambert 1760): radiance is the same in all directions, f = albedo / π; sampled
// by the cosine (Malley), so that the weight f cosθ / pdf is the albedo.
#pragma once

#include <numbers>

#include "geometry/sampling.hpp"
#include "shading/brdf/directions.hpp"

namespace treeline::shading::brdf {

/// f of albedo 1, per steradian; nothing unless both are above the surface.
template <std::floating_point T>
T lambert(const Direction<T>& wi, const Direction<T>& wo) {
  return wi[2] > T(0) && wo[2] > T(0) ? std::numbers::inv_pi_v<T> : T(0);
}

/// Density of sample_lambert, per steradian.
template <std::floating_point T>
T lambert_pdf(const Direction<T>& wi) {
  return wi[2] > T(0) ? wi[2] * std::numbers::inv_pi_v<T> : T(0);
}

template <std::floating_point T>
Direction<T> sample_lambert(T u, T v) {
  return geometry::sample_hemisphere_cosine(u, v);
}

}  // namespace treeline::shading::brdf
