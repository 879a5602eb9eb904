// The least share of a distribution that lies before t, given its first four moments (Peters and Klein 2015,
// "Moment shadow maps"; the bound is Hamburger's problem of moments).
//
// Of all distributions with these moments one has its mass at t and at two further points, the roots of the
// quadratic that the Hankel matrix B of the moments maps to (1, t, t²); the mass before t of that one is the
// least of all. Exact where the distribution is of at most two points. The mass at t itself,
// 1 / (vᵀ B⁻¹ v) with v = (1, t, t²), is what leaks where t is behind everything; of three points, with l_j
// their Lagrange polynomials, it is at most 1 / (sum |l_j(t)|)².
// Cost: some 40 operations and 3 divisions. Known weakness: B is close to singular wherever the depths are
// few, so rounding makes it indefinite; moments have to be moved a share `alpha` towards those of a
// distribution whose B is not, and more leaks for it.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

namespace treeline::shading::shadow {

template <class T>
struct MomentBound {
  T before = 0;  ///< share of the distribution before t, at the least; in [0, 1]
  /// False: rounding has left moments that no three points have; `before` is that of the two that have the
  /// first three, or of the one that has the first.
  bool definite = true;
};

/// Towards the even distribution's second and fourth moment about depth 0: (0, 0.63, 0, 0.63) lies well
/// within those of depths in [-1, 1] (Peters et al. 2017).
template <class T>
std::array<T, 4> moved_moments(const std::array<T, 4>& m, T alpha) {
  const T keep = 1 - alpha, add = alpha * T(0.63);
  return {keep * m[0], keep * m[1] + add, keep * m[2], keep * m[3] + add};
}

namespace detail {

/// Of the distribution of two points with the first three moments: the roots of z² - l z + l m1 - m2.
template <class T>
T before_two(const std::array<T, 4>& m, T l, T t) {
  const T half = T(0.5) * std::sqrt(std::max(l * l - 4 * (l * m[0] - m[1]), T(0)));
  const T z1 = T(0.5) * l - half, z2 = T(0.5) * l + half;
  if (t <= z1) return 0;
  return t > z2 ? T(1) : std::clamp((z2 - m[0]) / (z2 - z1), T(0), T(1));
}

}  // namespace detail

/// m: the means of z, z², z³ and z⁴, with z in [-1, 1] or [0, 1]; t likewise.
template <class T>
MomentBound<T> hamburger(const std::array<T, 4>& m, T t) {
  // B = L D Lᵀ with B = (1 m1 m2; m1 m2 m3; m2 m3 m4).
  const T d1 = m[1] - m[0] * m[0], e = m[2] - m[0] * m[1];
  if (!(d1 > 0)) return {m[0] < t ? T(1) : T(0), false};  // one depth, and rounding
  const T l = e / d1, d2 = m[3] - m[1] * m[1] - l * e;
  if (!(d2 > 0)) return {detail::before_two(m, l, t), false};
  // Solve B c = (1, t, t²).
  const T y1 = t - m[0], y2 = t * t - m[1] - l * y1;
  const T c2 = y2 / d2, c1 = y1 / d1 - l * c2, c0 = 1 - m[0] * c1 - m[1] * c2;
  // Roots of c0 + c1 z + c2 z²; where c2 vanishes one is infinite and takes no mass.
  const T root = std::sqrt(std::max(c1 * c1 - 4 * c0 * c2, T(0)));
  const T q = T(-0.5) * (c1 + std::copysign(root, c1));
  T z1 = q / c2, z2 = c0 / q;
  if (!(std::isfinite(z1) && std::isfinite(z2))) {
    const T only = -c0 / c1;  // then y2 = 0: t and this point alone
    if (!std::isfinite(only)) return {m[0] < t ? T(1) : T(0), true};
    return {only < t ? (t - m[0]) / (t - only) : T(0), true};
  }
  if (z1 > z2) std::swap(z1, z2);
  if (t <= z1) return {T(0), true};
  const auto mass = [&](T at, T p, T r) { return (p * r - m[0] * (p + r) + m[1]) / ((at - p) * (at - r)); };
  const T before = t <= z2 ? mass(z1, t, z2) : 1 - mass(t, z1, z2);
  return {std::min(std::max(before, T(0)), T(1)), true};
}

}  // namespace treeline::shading::shadow
