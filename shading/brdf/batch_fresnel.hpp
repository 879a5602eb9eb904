// Fresnel's reflectance of many angles at once, by channel, on vector registers.
//
// Sources: Schlick 1994; the exact forms for dielectrics and for conductors as in fresnel.hpp, written so
// that neither an index near 1 nor a large extinction cancels digits. Cost: 5, 25 and, each channel, 45
// instructions for a register.
#pragma once

#include "shading/brdf/batch_directions.hpp"
#include "shading/material.hpp"

namespace treeline::shading::brdf::batch {

/// Of light between two media that absorb nothing: bend is the square of the index ahead over that behind,
/// less 1.
[[gnu::always_inline]] inline Floats dielectric_reflectance(Floats bend, Floats cosine) {
  const Floats gg = bend + cosine * cosine;  // square of index times cosine beyond; below 0: total reflection
  const Floats sum = root(largest(gg, Floats{})) + cosine;
  const Floats per_sum = inverse(largest(sum, floats(1e-18f))), difference = bend * per_sum;
  const Floats s = difference * per_sum;
  const Floats p = s * ((cosine * sum - 1.0f) * inverse(cosine * difference + 1.0f));
  return gg > 0 ? 0.5f * (s * s + p * p) : floats(1);
}

class Fresnel {
 public:
  /// Of a material that check_material has accepted.
  explicit Fresnel(const Material& m)
      : kind_(m.fresnel),
        reflectance_(m.reflectance),
        index_(m.conductor_index),
        extinction_(m.conductor_extinction),
        bend_(static_cast<float>((m.index - 1) * (m.index + 1))) {}

  /// Between the light and the (micro) surface's normal, 0 to 1.
  [[gnu::always_inline]] Floats3 operator()(Floats cosine) const {
    switch (kind_) {
      case FresnelKind::schlick: {
        const Floats m = 1.0f - cosine, mm = m * m, m5 = mm * mm * m;
        return {schlick(reflectance_[0], m5), schlick(reflectance_[1], m5), schlick(reflectance_[2], m5)};
      }
      case FresnelKind::dielectric: {
        const Floats f = dielectric_reflectance(floats(bend_), cosine);
        return {f, f, f};
      }
      case FresnelKind::conductor:
        return {conductor(0, cosine), conductor(1, cosine), conductor(2, cosine)};
      case FresnelKind::one:
        break;
    }
    return {floats(1), floats(1), floats(1)};
  }

 private:
  FresnelKind kind_;
  Rgb reflectance_, index_, extinction_;
  float bend_;  ///< square of the dielectric's index, less 1

  [[gnu::always_inline]] static Floats schlick(float f0, Floats m5) { return f0 + (1 - f0) * m5; }

  /// With a the real part of the refracted wave's normal component: a² = (|t| + t)/2, t = n² - k² - sin².
  [[gnu::always_inline]] Floats conductor(int channel, Floats c) const {
    const float n = index_[channel], k = extinction_[channel], nk = n * k;
    const Floats cc = c * c, ss = (1.0f - c) * (1.0f + c);
    const Floats t = (n - k) * (n + k) - ss, modulus = root(t * t + 4 * nk * nk);
    const Floats larger = 0.5f * (modulus + largest(t, -t));
    const Floats a = root(t > 0 ? larger : nk * nk / largest(larger, floats(1e-30f)));
    const Floats sum = modulus + cc, part = 2.0f * a * c, sum_p = cc * modulus + ss * ss, part_p = part * ss;
    const Floats s = (sum - part) / largest(sum + part, floats(1e-30f));
    return 0.5f * s * (1.0f + (sum_p - part_p) / largest(sum_p + part_p, floats(1e-30f)));
  }
};

}  // namespace treeline::shading::brdf::batch
