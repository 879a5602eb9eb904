// Normals of a Beckmann surface with the density with which a viewer sees them, D(h) max(0, o·h) / A(o).
//
// Source: Heitz and d'Eon 2014 (stretch to roughness 1; slopes across the view are normal, those along it
// have the density (cosθ + s sinθ) exp(-s²)); Jakob 2014, "An improved visible normal sampling routine for
// the Beckmann distribution" (the latter's distribution inverted by iteration from a fitted start). Here the
// iteration is Halley's, within a bracket, in double, down to rounding: no look-up table, and stratified
// input stays so.
// Cost: 3 to 4 iterations with an error function and an exponential each: some 5 times GGX's. Known
// weakness: that cost.
#pragma once

#include <algorithm>

#include "shading/brdf/beckmann.hpp"

namespace treeline::shading::brdf {

namespace detail {

/// Inverse error function, to 4e-7 relative (Giles 2010, "Approximating the erfinv function").
inline double erf_inverse(double x) {
  double w = -std::log((1 - x) * (1 + x)), p;
  if (w < 5) {
    w -= 2.5;
    p = 2.81022636e-08;
    for (const double c : {3.43273939e-07, -3.5233877e-06, -4.39150654e-06, 0.00021858087, -0.00125372503,
                           -0.00417768164, 0.246640727, 1.50140941})
      p = c + p * w;
  } else {
    w = std::sqrt(w) - 3;
    p = -0.000200214257;
    for (const double c : {0.000100950558, 0.00134934322, -0.00367342844, 0.00573950773, -0.0076224613,
                           0.00943887047, 1.00167406, 2.83297682})
      p = c + p * w;
  }
  return p * x;
}

/// Slope s > -cosθ/sinθ along the view, of density proportional to (cosθ + s sinθ) exp(-s²); falling in u.
inline double visible_slope(double cosine, double sine, double u) {
  constexpr double farthest = 7;  // beyond it is less than 1e-21 of all
  if (!(sine > 0)) return erf_inverse(std::clamp(1 - 2 * u, -1 + 1e-16, 1 - 1e-16));
  // The share beyond s, not yet normalised: cosθ erfc(s)/2 + sinθ exp(-s²)/(2 sqrt π).
  const auto beyond = [&](double s) {
    return 0.5 * (cosine * std::erfc(s) + sine * std::exp(-s * s) * std::numbers::inv_sqrtpi);
  };
  double low = -std::min(farthest, cosine / sine), high = farthest;
  const double target = u * beyond(low), top = std::erf(-low), angle = std::atan2(sine, cosine);
  const double fit = 1 + angle * (-0.876 + angle * (0.4265 - 0.0594 * angle));
  double s = -erf_inverse(std::clamp(top - (1 + top) * std::pow(1 - u, fit), -1 + 1e-15, 1 - 1e-15));
  for (int iteration = 0; iteration < 60 && high - low > 1e-14; ++iteration) {
    if (!(s > low && s < high)) s = 0.5 * (low + high);
    const double excess = beyond(s) - target;
    (excess > 0 ? low : high) = s;
    const double slope = -(cosine + s * sine) * std::exp(-s * s) * std::numbers::inv_sqrtpi;
    const double newton = excess / slope, bend = 0.5 * (sine / (cosine + s * sine) - 2 * s);
    const double step = newton / std::max(0.5, 1 - newton * bend);
    s -= step;
    if (std::abs(step) < 1e-12) break;
  }
  return std::clamp(s, low, high);
}

}  // namespace detail

/// o: unit, z above 0; u, v in [0, 1).
template <std::floating_point T>
Direction<T> sample_visible(const Beckmann<T>& d, const Direction<T>& o, T u, T v) {
  // The view of the surface stretched to roughness 1.
  const double x = double(d.ax) * double(o[0]), y = double(d.ay) * double(o[1]), z = double(o[2]);
  const double across = std::sqrt(x * x + y * y), l = std::sqrt(across * across + z * z);
  const double along = detail::visible_slope(z / l, across / l, double(u));
  const double other = detail::erf_inverse(std::max(2 * double(v) - 1, -1 + 1e-16));
  const double c = across > 0 ? x / across : 1, s = across > 0 ? y / across : 0;
  return geometry::normalized(
      Direction<T>{d.ax * T(c * along - s * other), d.ay * T(s * along + c * other), T(1)});
}

}  // namespace treeline::shading::brdf
