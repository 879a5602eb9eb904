// Samples on discs, spheres, hemispheres and triangles from two numbers in [0, 1).
//
// Each map keeps areas (up to the density it states), so that stratified or low-discrepancy input stays so.
// Sources: Shirley and Chiu 1997 (disc); Archimedes' hat box (sphere); Malley (cosine); Heitz 2019
// (triangle). Known weakness: for float input the directions are of unit length to about 3 units in the last
// place only.
#pragma once

#include <concepts>
#include <numbers>

#include "geometry/vec.hpp"

namespace treeline::geometry {

/// Uniform on the unit disc, by concentric squares.
template <std::floating_point T>
Vec<T, 2> sample_disc(T u, T v) {
  const T x = T(2) * u - T(1), y = T(2) * v - T(1);
  if (x == T(0) && y == T(0)) return {};
  constexpr T quarter = std::numbers::pi_v<T> / T(4);
  const bool wide = std::abs(x) > std::abs(y);
  const T r = wide ? x : y;
  const T angle = wide ? quarter * (y / x) : quarter * (T(2) - x / y);
  return {r * std::cos(angle), r * std::sin(angle)};
}

/// Uniform on the unit sphere; density 1 / (4 pi).
template <std::floating_point T>
Vec<T, 3> sample_sphere(T u, T v) {
  const T r = T(2) * std::sqrt(u * (T(1) - u)), angle = T(2) * std::numbers::pi_v<T> * v;
  return {r * std::cos(angle), r * std::sin(angle), T(1) - T(2) * u};
}

/// Uniform on the unit hemisphere around +z; density 1 / (2 pi).
template <std::floating_point T>
Vec<T, 3> sample_hemisphere(T u, T v) {
  const T r = std::sqrt(u * (T(2) - u)), angle = T(2) * std::numbers::pi_v<T> * v;
  return {r * std::cos(angle), r * std::sin(angle), T(1) - u};
}

/// On the unit hemisphere around +z with density cos(theta) / pi.
template <std::floating_point T>
Vec<T, 3> sample_hemisphere_cosine(T u, T v) {
  const Vec<T, 2> d = sample_disc(u, v);
  return {d[0], d[1], std::sqrt(std::max(T(0), T(1) - length2(d)))};
}

/// Weights of the three corners, uniform over a triangle's area; they are not negative and add up to 1.
template <std::floating_point T>
Vec<T, 3> sample_triangle(T u, T v) {
  if (v > u)
    u *= T(0.5), v -= u;
  else
    v *= T(0.5), u -= v;
  return {std::max(T(0), T(1) - u - v), u, v};
}

/// Two unit vectors that make a right-handed frame with the unit vector n (Duff et al. 2017).
template <std::floating_point T>
struct Frame {
  Vec<T, 3> x, y, z;

  explicit Frame(const Vec<T, 3>& n) : z(n) {
    const T sign = std::copysign(T(1), n[2]), a = T(-1) / (sign + n[2]), b = n[0] * n[1] * a;
    x = {T(1) + sign * n[0] * n[0] * a, sign * b, -sign * n[0]};
    y = {b, sign + n[1] * n[1] * a, -n[1]};
  }
  /// From the frame's coordinates to the world's.
  Vec<T, 3> operator()(const Vec<T, 3>& local) const { return x * local[0] + y * local[1] + z * local[2]; }
};

}  // namespace treeline::geometry
