// Exact predicates: whether a triangle has no area, decided without rounding.
//
// Source: Shewchuk 1997, "Adaptive precision floating-point arithmetic and fast robust geometric predicates":
// sums and products split into a rounded part and its exact error, summed as a non-overlapping expansion.
// Cost: a float filter decides nearly always; else about 700 additions.
// Known weakness: products of doubles below about 1e-290 or above 1e290 leave the range and are not exact;
// floats are exact throughout, because they are taken to double first.
#pragma once

#include <array>

#include "geometry/rounding.hpp"
#include "geometry/tolerances.hpp"
#include "geometry/triangle.hpp"

namespace treeline::geometry {

struct Split {
  double value, error;  // the exact result is value + error
};
inline Split two_sum(double a, double b) {
  const double s = a + b, bb = s - a;
  return {s, (a - (s - bb)) + (b - bb)};
}
inline Split two_product(double a, double b) {
  const double p = rounded(a * b);
  return {p, std::fma(a, b, -p)};
}

/// Whether numbers add up to exactly zero.
template <std::size_t N>
bool sums_to_zero(const std::array<double, N>& terms) {
  std::array<double, N> expansion{};
  for (std::size_t n = 0; n < N; ++n) {
    double carry = terms[n];
    for (std::size_t i = 0; i < n; ++i) {
      const Split s = two_sum(carry, expansion[i]);
      carry = s.value, expansion[i] = s.error;
    }
    expansion[n] = carry;
  }
  for (double e : expansion)
    if (e != 0) return false;
  return true;
}

/// Whether the projections of three points onto axes x and y lie on one line (in any order, or coincide).
inline bool collinear_in(const Triangle<double>& t, int x, int y) {
  std::array<double, 12> terms;
  std::size_t n = 0;
  const auto add = [&](double p, double q) {
    const Split s = two_product(p, q);
    terms[n++] = s.value, terms[n++] = s.error;
  };
  add(t.a[x], t.b[y]), add(-t.b[x], t.a[y]);
  add(t.b[x], t.c[y]), add(-t.c[x], t.b[y]);
  add(t.c[x], t.a[y]), add(-t.a[x], t.c[y]);
  return sums_to_zero(terms);
}

/// Whether a triangle with finite corners has exactly no area: its corners lie on one line.
template <class T>
bool is_degenerate(const Triangle<T>& t) {
  const Vec<T, 3> p = t.b - t.a, q = t.c - t.a;
  for (int x = 0; x < 3; ++x) {
    const int y = (x + 1) % 3;
    const T m = p[x] * q[y], n = p[y] * q[x];
    // Each difference and product carries one rounding: |error| <= gamma(4) (|m| + |n|), plus underflow.
    if (std::abs(m - n) >
        tolerance::gamma<T>(8) * (std::abs(m) + std::abs(n)) + std::numeric_limits<T>::min())
      return false;
  }
  // Scaled by a power of two to coordinates up to 1, so that products neither overflow nor, as a rule,
  // underflow.
  double largest = std::numeric_limits<double>::min();
  for (int k = 0; k < 3; ++k)
    largest =
        std::max({largest, std::abs(double(t.a[k])), std::abs(double(t.b[k])), std::abs(double(t.c[k]))});
  const double scale = std::ldexp(1.0, -std::ilogb(largest));
  const Triangle<double> scaled{Vec3d(t.a) * scale, Vec3d(t.b) * scale, Vec3d(t.c) * scale};
  return collinear_in(scaled, 0, 1) && collinear_in(scaled, 1, 2) && collinear_in(scaled, 2, 0);
}

}  // namespace treeline::geometry
