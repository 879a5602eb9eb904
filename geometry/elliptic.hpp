// Carlson's symmetric elliptic integrals of the first and third kind.
//
// Problem: arcs, areas on the sphere and periods of pendulums are elliptic integrals; Legendre's forms lose
// digits near their ends, Carlson's do not. Source: Carlson 1995 (duplication, with the series of DLMF
// 19.36.1 and the recurrence of 19.26(ii)). Cost: three or four square roots a step, and about 7 steps for
// arguments within a factor of a thousand of each other. Accuracy: a few units in the last place. Known
// weakness: p > 0 only, no principal values.
#pragma once

#include <algorithm>
#include <cmath>

namespace treeline::geometry {

namespace detail {
/// Where to stop: what the series leave out is of the sixth power of the largest deviation from the mean.
inline constexpr double carlson_deviation = 1.5e-3;

/// R_C(1, 1 + e), e > -1.
inline double carlson_rc_1(double e) {
  if (std::abs(e) < 1e-5) return 1 - e * (1.0 / 3 - e * (0.2 - e / 7));
  const double root = std::sqrt(std::abs(e));
  return e > 0 ? std::atan(root) / root : std::atanh(root) / root;
}
}  // namespace detail

/// ½ ∫ dt / √((t + x)(t + y)(t + z)) over t ≥ 0; x, y, z ≥ 0, at most one of them 0.
inline double carlson_rf(double x, double y, double z) {
  double mean, dx, dy;
  for (;;) {
    mean = (x + y + z) / 3;
    dx = 1 - x / mean, dy = 1 - y / mean;
    if (std::max({std::abs(dx), std::abs(dy), std::abs(dx + dy)}) < detail::carlson_deviation) break;
    const double rx = std::sqrt(x), ry = std::sqrt(y), rz = std::sqrt(z), step = rx * (ry + rz) + ry * rz;
    x = 0.25 * (x + step), y = 0.25 * (y + step), z = 0.25 * (z + step);
  }
  const double dz = -dx - dy, e2 = dx * dy - dz * dz, e3 = dx * dy * dz;
  return (1 - e2 / 10 + e3 / 14 + e2 * e2 / 24 - 3 * e2 * e3 / 44) / std::sqrt(mean);
}

/// 3/2 ∫ dt / ((t + p) √((t + x)(t + y)(t + z))) over t ≥ 0; x, y, z ≥ 0, at most one of them 0; p > 0.
inline double carlson_rj(double x, double y, double z, double p) {
  double mean, dx, dy, dz, sum = 0, scale = 1;
  for (;;) {
    mean = (x + y + z + 2 * p) / 5;
    dx = 1 - x / mean, dy = 1 - y / mean, dz = 1 - z / mean;
    if (std::max({std::abs(dx), std::abs(dy), std::abs(dz), std::abs(dx + dy + dz) / 2}) <
        detail::carlson_deviation)
      break;
    const double rx = std::sqrt(x), ry = std::sqrt(y), rz = std::sqrt(z), rp = std::sqrt(p);
    const double step = rx * (ry + rz) + ry * rz, d = (rp + rx) * (rp + ry) * (rp + rz);
    const double e = (p - x) / d * ((p - y) / d) * (p - z);
    sum += 6 * scale / d * detail::carlson_rc_1(e);
    scale *= 0.25;
    x = 0.25 * (x + step), y = 0.25 * (y + step), z = 0.25 * (z + step), p = 0.25 * (p + step);
  }
  const double dp = -(dx + dy + dz) / 2, e2 = dx * dy + dx * dz + dy * dz - 3 * dp * dp,
               e3 = dx * dy * dz + 2 * e2 * dp + 4 * dp * dp * dp,
               e4 = (2 * dx * dy * dz + e2 * dp + 3 * dp * dp * dp) * dp, e5 = dx * dy * dz * dp * dp;
  const double series =
      1 - 3 * e2 / 14 + e3 / 6 + 9 * e2 * e2 / 88 - 3 * e4 / 22 - 9 * e2 * e3 / 52 + 3 * e5 / 26;
  return sum + scale * series / (mean * std::sqrt(mean));
}

}  // namespace treeline::geometry
