// How much of the light that meets a smooth boundary is reflected (unpolarised), and the average over a
// diffuse sky: dielectrics and conductors exactly (Fresnel), and Schlick's approximation (1994).
//
// Cost: two roots for the exact forms, no root for Schlick's. Known weakness of Schlick's: at index 1.5 off
// by up to 0.036 (at 85 degrees), at 1.05 by 0.32, for metals by 0.1 to 0.2, by 0.4 at n = k = 0.2, and by
// 0.96 inside of glass, where it knows no total reflection.
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>

#include "geometry/gauss_legendre.hpp"

namespace treeline::shading::brdf {

/// Cosine in the far medium by Snell's law; 0 at total reflection. cosine in [0, 1]; eta: refractive index of
/// the far medium over that of the near one.
template <std::floating_point T>
T refracted_cosine(T cosine, T eta) {
  const T sine2 = (T(1) - cosine) * (T(1) + cosine) / (eta * eta);
  return std::sqrt(std::max(T(0), T(1) - sine2));
}

/// Share reflected at a boundary that absorbs nothing; 1 at total reflection. Arguments as above.
template <std::floating_point T>
T fresnel_dielectric(T cosine, T eta) {
  const T far = refracted_cosine(cosine, eta);
  if (far == T(0)) return T(1);
  const T s = (cosine - eta * far) / (cosine + eta * far), p = (eta * cosine - far) / (eta * cosine + far);
  return T(0.5) * (s * s + p * p);
}

/// Share reflected by a medium of complex refractive index n + i k, relative to the near one's.
template <std::floating_point T>
T fresnel_conductor(T cosine, T n, T k) {
  // With n_t cos_t = a + i b: a² - b² = n² - k² - sin², a b = n k; the larger by the root, the other by
  // division.
  const T c2 = cosine * cosine, s2 = (T(1) - cosine) * (T(1) + cosine), d = n * n - k * k - s2, m = n * k;
  const T larger = std::sqrt(T(0.5) * (std::sqrt(d * d + T(4) * m * m) + std::abs(d)));
  const T smaller = larger > T(0) ? m / larger : T(0);
  const T a = d >= T(0) ? larger : smaller, b = d >= T(0) ? smaller : larger;
  // |x - a - i b|² / |x + a + i b|²: at grazing, and where both indices are 0, all is reflected.
  const auto ratio = [](T x, T y, T b2) {
    const T sum = (x + y) * (x + y) + b2;
    return sum > T(0) ? ((x - y) * (x - y) + b2) / sum : T(1);
  };
  const T s = ratio(cosine, a, b * b), p = s * ratio(s2, a * cosine, b * b * c2);
  return T(0.5) * (s + p);
}

/// From `normal`, the share reflected at normal incidence, to 1 at grazing.
template <std::floating_point T>
T fresnel_schlick(T cosine, T normal) {
  const T m = std::clamp(T(1) - cosine, T(0), T(1)), m2 = m * m;
  return normal + (T(1) - normal) * (m2 * m2 * m);
}

/// Share reflected at normal incidence; eta as above.
template <std::floating_point T>
T fresnel_at_normal(T eta) {
  const T r = (eta - T(1)) / (eta + T(1));
  return r * r;
}

/// 2 ∫ F(μ) μ dμ over [0, 1] of any F, to about 1e-9 where F is smooth: panels that narrow towards grazing,
/// where F rises.
template <class F>
double fresnel_average(F&& fresnel) {
  double sum = 0;
  for (double low = 0, high = 1e-4; high <= 1; low = high, high = high < 1 ? std::min(1.0, 4 * high) : 2)
    sum += geometry::integrate<16>([&](double mu) { return 2 * mu * fresnel(mu); }, low, high);
  return sum;
}

/// The average of Schlick's form, exactly.
template <std::floating_point T>
T fresnel_average_schlick(T normal) {
  return (T(1) + T(20) * normal) / T(21);
}

/// The average from the side of the lower index; from the other side by reciprocity: all light beyond the
/// critical angle comes back, and what passes is the same both ways, 1 - F̄(1/n) = (1 - F̄(n)) / n².
inline double fresnel_average_dielectric(double eta) {
  if (eta < 1) return 1 - eta * eta * (1 - fresnel_average_dielectric(1 / eta));
  return fresnel_average([eta](double mu) { return fresnel_dielectric(mu, eta); });
}

inline double fresnel_average_conductor(double n, double k) {
  return fresnel_average([n, k](double mu) { return fresnel_conductor(mu, n, k); });
}

}  // namespace treeline::shading::brdf
