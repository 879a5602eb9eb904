// Slopes of a Beckmann surface as a viewer sees them, for many views at once, on vector registers: the
// numbers that beckmann_visible.hpp finds, to the rounding of floats.
//
// Source: Jakob 2014, "An improved visible normal sampling routine for the Beckmann distribution". The share
// of facets beyond a slope is inverted from his fitted start by two of Halley's steps, always; after them the
// share is within 6e-7 of u for any view, which is what floats allow. Cost: some 200 instructions, no branch.
// Known weakness: near the slope that is seen edge-on, where few facets are seen, slopes are only known to
// the square root of that.
#pragma once

#include <numbers>

#include "shading/brdf/batch_math.hpp"

namespace treeline::shading::brdf::batch {

/// Slopes beyond are as rare as one in 2^25.
inline constexpr float farthest_slope = 4.3f;

/// e^(s²) erfc(s) for 0 <= s <= 4.5; relative error up to 3e-7.
[[gnu::always_inline]] inline Floats scaled_erfc(Floats s) {
  constexpr float coefficients[] = {0.07614898682f, -0.4040214717f, 0.7048479915f, -0.3981618285f,
                                    0.4256495237f,  0.1327633709f,  0.2379623950f, 0.2248110473f};
  const Floats t = inverse(1.0f + 0.4f * s);
  return polynomial(t, coefficients) * t;
}

/// s > -cosine/sine with a share u of what is seen beyond it, where density is proportional to (cosine + s
/// sine) e^(-s²). The view: cosine and sine of its angle in the space of roughness 1, cotangent their
/// quotient, and seen = ∫ density / √π, which is cosine (1 + Λ). u in [0, 1).
[[gnu::always_inline]] inline Floats visible_slope(Floats cosine, Floats sine, Floats cotangent, Floats seen,
                                                   Floats u) {
  constexpr float inv_sqrtpi = std::numbers::inv_sqrtpi_v<float>;
  const Floats lowest = -least(cotangent, floats(4.5f));
  u = largest(u, floats(0x1p-25f));  // the middle of the numbers that a float's 0 stands for
  // Jakob's start, from coarser functions: the angle and erf (Abramowitz and Stegun 4.4.45 and 7.1.27), and
  // the inverse of erf (Winitzki 2008).
  constexpr float angle_of[] = {-0.0187293f, 0.0742610f, -0.2121144f, 1.5707288f};
  constexpr float fit[] = {-0.0594f, 0.4265f, -0.876f, 1.0f};
  constexpr float erfc_root[] = {0.078108f, 0.000972f, 0.230389f, 0.278393f, 1.0f};
  const Floats angle = root(largest(1.0f - cosine, Floats{})) * polynomial(cosine, angle_of);
  const Floats r = inverse(polynomial(-lowest, erfc_root)), rr = r * r, top = 1.0f - rr * rr;
  const Floats power = exp_of_negative(largest(-log_of(1.0f - u) * polynomial(angle, fit), Floats{}));
  const Floats b = least(largest(top - (1.0f + top) * power, floats(-0.9999999f)), floats(0.9999999f));
  constexpr float k = 0.147f;
  const Floats l = log_of((1.0f - b) * (1.0f + b)), q = 0.5f * l + 2 / (std::numbers::pi_v<float> * k);
  const Floats start = root(largest(root(largest(q * q - (1 / k) * l, Floats{})) - q, Floats{}));
  const auto within = [&](Floats s) __attribute__((always_inline)) {
    return least(largest(s, lowest), floats(farthest_slope));
  };
  Floats s = within(b > 0 ? -start : start);
  for (int step = 0; step < 2; ++step) {
    const Floats m = largest(s, -s), e = exp_of_negative(m * m), half = 0.5f * e * scaled_erfc(m);
    const Floats beyond = cosine * (s < 0 ? 1.0f - half : half) + (0.5f * inv_sqrtpi) * sine * e;
    const Floats facing = cosine + s * sine, scaled = inv_sqrtpi * e;
    const Floats per_slope = inverse(largest(facing * scaled, floats(1e-12f)));
    const Floats newton = (beyond - u * seen) * per_slope;
    const Floats bend = 0.5f * sine * scaled * per_slope - s;
    s = within(s + newton * inverse(largest(1.0f + newton * bend, floats(0.5f))));
  }
  return s;
}

}  // namespace treeline::shading::brdf::batch
