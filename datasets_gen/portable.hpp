// Elementary functions that give the same bits on every machine.
//
// Problem: the C library's sin, cos, log and cbrt differ in the last bit between versions and CPUs, and then
// a recipe's hash differs too. Here only +, -, *, / and sqrt are used, which IEEE 754 rounds exactly. The
// library of recipes is compiled with -ffp-contract=off, so that no multiply-add is fused; always_inline
// keeps the linker from taking a fused copy out of another translation unit. Cost: some ten operations each.
// Accuracy: about 1e-15, not correctly rounded.
#pragma once

#include <cmath>
#include <cstdint>

#include "geometry/random.hpp"
#include "geometry/vec.hpp"

namespace treeline::datasets {

using geometry::Vec3d;
using geometry::Vec3f;

#define TREELINE_PORTABLE [[gnu::always_inline]] inline

struct SinCos {
  double sin, cos;
};

/// Sine and cosine of an angle given in turns (1 turn = 2π).
TREELINE_PORTABLE SinCos sincos_turns(double turns) {
  const double nearest_quarter = std::floor(4 * turns + 0.5);
  const double x =
      (turns - 0.25 * nearest_quarter) * 6.283185307179586;  // |x| ≤ π/4; the difference is exact
  const double y = x * x;
  // Taylor series to x^15 and x^16: remainder below 1e-16 on |x| ≤ π/4.
  double s = -1.0 / 1307674368000.0, c = 1.0 / 20922789888000.0;
  s = s * y + 1.0 / 6227020800.0, c = c * y - 1.0 / 87178291200.0;
  s = s * y - 1.0 / 39916800.0, c = c * y + 1.0 / 479001600.0;
  s = s * y + 1.0 / 362880.0, c = c * y - 1.0 / 3628800.0;
  s = s * y - 1.0 / 5040.0, c = c * y + 1.0 / 40320.0;
  s = s * y + 1.0 / 120.0, c = c * y - 1.0 / 720.0;
  s = s * y - 1.0 / 6.0, c = c * y + 1.0 / 24.0;
  s = x + x * y * s, c = 1.0 - 0.5 * y + y * y * c;
  switch (static_cast<std::int64_t>(nearest_quarter) & 3) {
    case 0:
      return {s, c};
    case 1:
      return {c, -s};
    case 2:
      return {-s, -c};
    default:
      return {-c, s};
  }
}

/// Natural logarithm of a positive, normal, finite number.
TREELINE_PORTABLE double log_portable(double x) {
  int e = 0;
  double m = std::frexp(x, &e);  // exact; m in [1/2, 1)
  if (m < 0.7071067811865476) m *= 2, --e;
  const double s = (m - 1) / (m + 1), y = s * s;  // ln m = 2 artanh s, |s| < 0.172: 0.172^23 is below 1e-17
  double sum = 0;
  for (int k = 21; k >= 1; k -= 2) sum = sum * y + 1.0 / k;
  return e * 0.6931471805599453 + 2 * s * sum;
}

TREELINE_PORTABLE double dot_portable(const Vec3d& a, const Vec3d& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
TREELINE_PORTABLE Vec3d cross_portable(const Vec3d& a, const Vec3d& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
TREELINE_PORTABLE Vec3d unit_portable(const Vec3d& a) {
  const double l = std::sqrt(dot_portable(a, a));
  return {a[0] / l, a[1] / l, a[2] / l};
}
TREELINE_PORTABLE Vec3d scaled(const Vec3d& a, double s) { return {a[0] * s, a[1] * s, a[2] * s}; }
TREELINE_PORTABLE Vec3d sum(const Vec3d& a, const Vec3d& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
TREELINE_PORTABLE Vec3f rounded(const Vec3d& a) {
  return {static_cast<float>(a[0]), static_cast<float>(a[1]), static_cast<float>(a[2])};
}

/// The random numbers of one element: stateless in (seed, element), so any thread may make any element.
class Draws {
 public:
  Draws(std::uint64_t seed, std::uint64_t element) : seed_(geometry::hash_u64(seed, element)) {}

  /// Uniform in [0, 1).
  double uniform() { return static_cast<double>(next() >> 11) * 0x1p-53; }
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  std::uint64_t below(std::uint64_t n) {
    return static_cast<std::uint64_t>(uniform() * static_cast<double>(n));
  }

  /// Uniform on the unit sphere.
  Vec3d direction() {
    const double z = uniform(-1, 1), r = std::sqrt((1 - z) * (1 + z));
    const SinCos a = sincos_turns(uniform());
    return {r * a.cos, r * a.sin, z};
  }
  /// Three independent standard normal deviates (Box and Muller 1958).
  Vec3d normal() {
    const SinCos a = sincos_turns(uniform()), b = sincos_turns(uniform());
    const double r = std::sqrt(-2 * log_portable(1 - uniform())),
                 q = std::sqrt(-2 * log_portable(1 - uniform()));
    return {r * a.cos, r * a.sin, q * b.cos};
  }
  /// Uniform in a box.
  Vec3d in_box(const Vec3d& low, const Vec3d& high) {
    const double x = uniform(low[0], high[0]), y = uniform(low[1], high[1]), z = uniform(low[2], high[2]);
    return {x, y, z};
  }

 private:
  std::uint64_t next() { return geometry::hash_u64(seed_, counter_++); }

  std::uint64_t seed_, counter_ = 0;
};

}  // namespace treeline::datasets
