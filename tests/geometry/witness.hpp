// An independent witness for ray tests: the same questions in 113-bit or rational arithmetic, by other
// formulas.
#pragma once

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <boost/multiprecision/cpp_int.hpp>
#include <optional>

#include "geometry/box.hpp"
#include "geometry/ray.hpp"
#include "geometry/triangle.hpp"

namespace treeline::test {

using namespace treeline::geometry;
using Rational = boost::multiprecision::cpp_rational;
using Quad = boost::multiprecision::cpp_bin_float_quad;

template <class R>
struct WitnessHit {
  R t, u, v;
};

/// Cramer's rule for origin + t d = a + u ab + v ac; the closed triangle; no hit where the ray is in its
/// plane.
template <class R, class T>
std::optional<WitnessHit<R>> witness_hit(const Ray<T>& ray, const Triangle<T>& triangle) {
  R m[3][4];
  for (int k = 0; k < 3; ++k) {
    m[k][0] = -R(ray.direction[k]);
    m[k][1] = R(triangle.b[k]) - R(triangle.a[k]);
    m[k][2] = R(triangle.c[k]) - R(triangle.a[k]);
    m[k][3] = R(ray.origin[k]) - R(triangle.a[k]);
  }
  const auto det = [&](int p, int q, int r) {
    return R(m[0][p] * (m[1][q] * m[2][r] - m[1][r] * m[2][q]) -
             m[0][q] * (m[1][p] * m[2][r] - m[1][r] * m[2][p]) +
             m[0][r] * (m[1][p] * m[2][q] - m[1][q] * m[2][p]));
  };
  const R d = det(0, 1, 2);
  if (d == 0) return {};
  const R t = det(3, 1, 2) / d, u = det(0, 3, 2) / d, v = det(0, 1, 3) / d;
  if (u < 0 || v < 0 || u + v > 1) return {};
  return WitnessHit<R>{t, u, v};
}

/// The closed interval of t ≥ t_min, ≤ t_max in which the exact ray is in the closed box, or none.
template <class T>
std::optional<std::pair<Rational, Rational>> witness_slabs(const Ray<T>& ray, const Box<T, 3>& box) {
  Rational first(ray.t_min), last(ray.t_max);
  for (int k = 0; k < 3; ++k) {
    const Rational o(ray.origin[k]), d(ray.direction[k]), low(box.low[k]), high(box.high[k]);
    if (d == 0) {
      if (o < low || high < o) return {};
      continue;
    }
    Rational near = (low - o) / d, far = (high - o) / d;
    if (far < near) std::swap(near, far);
    first = std::max(first, near), last = std::min(last, far);
  }
  if (last < first) return {};
  return std::pair{first, last};
}

}  // namespace treeline::test
