// Sine, cosine and exponential on vector registers, with the errors that they make.
//
// Polynomials of least largest error over reduced arguments (found by Lawson's iteration in double). Cost:
// some twenty instructions for sine and cosine together, fifteen for the exponential. Known weakness: no
// special cases; arguments are those that the surfaces have.
#pragma once

#include "shading/brdf/batch_registers.hpp"

namespace treeline::shading::brdf::batch {

struct SineCosine {
  Floats sine, cosine;
};

/// Horner's scheme; the coefficient of the highest power first.
template <std::size_t n>
[[gnu::always_inline]] inline Floats polynomial(Floats x, const float (&coefficients)[n]) {
  Floats p = floats(coefficients[0]);
  for (std::size_t i = 1; i < n; ++i) p = p * x + coefficients[i];
  return p;
}

/// Of πx/2, -1/2 <= x <= 1/2; absolute error up to 1.2e-7.
[[gnu::always_inline]] inline SineCosine sine_cosine_of_quarters(Floats x) {
  const Floats xx = x * x;
  return {x * (((-0.004592288751f * xx + 0.07967590541f) * xx - 0.6459629536f) * xx + 1.570796251f),
          ((-0.02042624913f * xx + 0.2536063492f) * xx - 1.233698010f) * xx + 1.0f};
}

/// Of 2πu, 0 <= u <= 1; absolute error up to 1.2e-7.
[[gnu::always_inline]] inline SineCosine sine_cosine_of_turns(Floats u) {
  const Floats quarters = 4.0f * u;
  const Ints quarter = __builtin_convertvector(quarters + 0.5f, Ints);
  const SineCosine near = sine_cosine_of_quarters(quarters - __builtin_convertvector(quarter, Floats));
  const Ints odd = (quarter & 1) != 0;
  const Ints sine_sign = (quarter & 2) << 30, cosine_sign = ((quarter + 1) & 2) << 30;
  return {with_bits(bits_of(odd ? near.cosine : near.sine) ^ sine_sign),
          with_bits(bits_of(odd ? near.sine : near.cosine) ^ cosine_sign)};
}

/// e^-x for x >= 0, relative error up to 3e-7; 0 where that is less than 2^-126.
[[gnu::always_inline]] inline Floats exp_of_negative(Floats x) {
  const Floats clamped = least(x, floats(90.0f));
  const Ints k = __builtin_convertvector(-1.442695041f * clamped - 0.5f, Ints);
  const Floats halvings = __builtin_convertvector(k, Floats);
  // ln 2 in two parts: the first has so few digits that its product is exact.
  const Floats r = (-clamped - halvings * 0.693359375f) + halvings * 2.12194440e-4f;  // ±(ln 2)/2
  const Floats p =
      (((((1.0f / 720 * r + 1.0f / 120) * r + 1.0f / 24) * r + 1.0f / 6) * r + 0.5f) * r + 1.0f) * r + 1.0f;
  const Ints exponent = k + 127;
  return kept(exponent > 0, p * with_bits(exponent << 23));
}

/// ln x for 2^-126 <= x < 2^127; absolute error up to 1e-7 times (1 + |ln x|).
[[gnu::always_inline]] inline Floats log_of(Floats x) {
  constexpr std::int32_t root_half = 0x3f3504f3;
  const Ints k = (bits_of(x) - root_half) >> 23;
  const Floats m = with_bits(bits_of(x) - (k << 23)) - 1.0f, mm = m * m;  // √½ - 1 to √2 - 1
  constexpr float coefficients[] = {7.0376836292e-2f,  -1.1514610310e-1f, 1.1676998740e-1f,
                                    -1.2420140846e-1f, 1.4249322787e-1f,  -1.6668057665e-1f,
                                    2.0000714765e-1f,  -2.4999993993e-1f, 3.3333331174e-1f};
  const Floats p = polynomial(m, coefficients), doublings = __builtin_convertvector(k, Floats);
  return ((m * mm * p - doublings * 2.12194440e-4f) - 0.5f * mm) + m + doublings * 0.693359375f;
}

/// Of -1 < x < 1; relative error up to 1e-6.
[[gnu::always_inline]] inline Floats erf_inverse_of(Floats x) {
  const Floats w = -log_of(largest((1.0f - x) * (1.0f + x), floats(1e-30f)));
  constexpr float near[] = {2.81022636e-08f,  3.43273939e-07f, -3.5233877e-06f,
                            -4.39150654e-06f, 0.00021858087f,  -0.00125372503f,
                            -0.00417768164f,  0.246640727f,    1.50140941f};
  constexpr float far[] = {-0.000200214257f, 0.000100950558f, 0.00134934322f, -0.00367342844f, 0.00573950773f,
                           -0.0076224613f,   0.00943887047f,  1.00167406f,    2.83297682f};
  return x * (w < 5 ? polynomial(w - 2.5f, near) : polynomial(root(largest(w, Floats{})) - 3.0f, far));
}

}  // namespace treeline::shading::brdf::batch
