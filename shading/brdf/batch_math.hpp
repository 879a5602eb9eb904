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

/// Of 2πu, 0 <= u <= 1; absolute error up to 1.2e-7.
[[gnu::always_inline]] inline SineCosine sine_cosine_of_turns(Floats u) {
  const Floats quarters = 4.0f * u;
  const Ints quarter = __builtin_convertvector(quarters + 0.5f, Ints);
  const Floats x = quarters - __builtin_convertvector(quarter, Floats), xx = x * x;  // -1/2 to 1/2
  const Floats s = x * (((-0.004592288751f * xx + 0.07967590541f) * xx - 0.6459629536f) * xx + 1.570796251f);
  const Floats c = ((-0.02042624913f * xx + 0.2536063492f) * xx - 1.233698010f) * xx + 1.0f;
  const Ints odd = (quarter & 1) != 0;
  const Ints sine_sign = (quarter & 2) << 30, cosine_sign = ((quarter + 1) & 2) << 30;
  return {with_bits(bits_of(odd ? c : s) ^ sine_sign), with_bits(bits_of(odd ? s : c) ^ cosine_sign)};
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

}  // namespace treeline::shading::brdf::batch
