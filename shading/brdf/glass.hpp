// A smooth boundary of a clear dielectric: reflects Fresnel's share, refracts the rest by Snell's law; z
// points out of the glass.
//
// Radiance that goes into the medium of refractive index n is scaled by n² (Veach 1997, 5.2), as the same
// flux takes less solid angle there; a path that leaves again gets all of it back. Cost: one Fresnel term,
// one more root. Known weakness: f is a delta; light that comes through can be found by following only, not
// by aiming at a lamp.
#pragma once

#include "shading/brdf/fresnel.hpp"
#include "shading/brdf/mirror.hpp"

namespace treeline::shading::brdf {

template <std::floating_point T>
struct GlassSample {
  Direction<T> wi;  ///< from where the light comes
  T weight;         ///< radiance towards wo over radiance from wi, by the probability of this choice
  bool refracted;
};

/// index: inside over outside. wo on either side of the boundary; wo[2] = 0 is reflected. choice in [0, 1).
template <std::floating_point T>
GlassSample<T> sample_glass(const Direction<T>& wo, T index, T choice) {
  const T eta = wo[2] >= T(0) ? index : T(1) / index;  // of the side away from wo, over wo's own
  const T cosine = std::min(std::abs(wo[2]), T(1));
  if (choice < fresnel_dielectric(cosine, eta)) return {mirrored(wo), T(1), false};
  const T far = refracted_cosine(cosine, eta), scale = T(1) / eta;
  return {{-wo[0] * scale, -wo[1] * scale, std::copysign(far, -wo[2])}, scale * scale, true};
}

}  // namespace treeline::shading::brdf
