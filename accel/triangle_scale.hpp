// Meshes far larger or smaller than 1 are kept scaled by a power of two, and queries and answers with them.
//
// Problem: products of three and four lengths (determinants, squared areas) leave the range of T long before
// lengths do: for float, beyond about 1e10 and below 1e-12. Method: where the typical coordinate lies outside
// 2^±(max_exponent / 6), all are multiplied by the power of two that makes it about 1, which is exact but for
// coordinates that vanish beside the typical one. Rays keep their t, as their directions are scaled by as
// much; a direction that would then be (or is) extreme takes a power of two of its own, and t with it. Cost
// where nothing is scaled: two comparisons per ray. Known weakness: of a mesh with parts of very different
// size only the typical ones are certain: coordinates of float below 2^-126 of the typical one lose digits,
// those below 2^-149 vanish, and both limits rise by what the largest exceeds the typical one beyond 2^64.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "geometry/box.hpp"
#include "geometry/ray.hpp"

namespace treeline::accel {

/// Where a ray begins and ends: a t beyond the range of T is no hit.
template <class T>
T begin_of(const geometry::Ray<T>& ray) {
  return std::max(ray.t_min, std::numeric_limits<T>::lowest());
}
template <class T>
T end_of(const geometry::Ray<T>& ray) {
  return std::min(ray.t_max, std::numeric_limits<T>::max());
}

template <class T>
class TriangleScale {
 public:
  using Point = geometry::Vec<T, 3>;
  using Box = geometry::Box<T, 3>;
  using Ray = geometry::Ray<T>;

  TriangleScale() = default;
  /// For triangles whose corners' largest coordinates are typically and at most as given.
  TriangleScale(T typical, T largest) {
    if (!(typical > T(0))) return;
    const int exponent = std::ilogb(typical);
    if (std::abs(exponent) <= comfortable) return;
    // 2^exponent_ and its inverse are normal, and no coordinate comes near overflow.
    exponent_ = std::clamp(-exponent, 2 - Limits::max_exponent, Limits::max_exponent - 2);
    exponent_ = std::min(exponent_, Limits::max_exponent / 2 - std::ilogb(largest));
    factor_ = std::ldexp(T(1), exponent_), inverse_ = std::ldexp(T(1), -exponent_);
  }

  bool scales() const { return exponent_ != 0; }
  T factor() const { return factor_; }
  T inverse() const { return inverse_; }

  /// Held finite; is_near() tells whether it had to be.
  Point scaled(const Point& p) const { return held(p, std::numeric_limits<T>::max()); }
  Point unscaled(const Point& p) const { return p * inverse_; }
  Box unscaled(const Box& box) const { return {box.low * inverse_, box.high * inverse_}; }
  T unscaled_square(T distance2) const { return distance2 * inverse_ * inverse_; }

  /// Held where its squared distance from the mesh is finite.
  Point scaled_query(const Point& p) const {
    return scales() ? held(p, std::ldexp(T(1), Limits::max_exponent / 2 - 4)) : p;
  }
  /// Whether scaled_query() did not have to move it.
  bool is_near(const Point& p) const { return !scales() || scaled_query(p) == p * factor_; }

  /// Whether products of the direction with a few lengths stay in range.
  static bool is_comfortable(const Ray& ray) {
    constexpr T slow = T(1) / T(std::uint64_t{1} << 31), fast = T(std::uint64_t{1} << 31);
    const T speed =
        std::max({std::abs(ray.direction[0]), std::abs(ray.direction[1]), std::abs(ray.direction[2])});
    return slow <= speed && speed <= fast;
  }
  /// The scaled ray; its t is the given ray's times 2^shift.
  Ray scaled(const Ray& ray, int& shift) const {
    const T speed = std::abs(ray.direction[largest_axis(ray.direction)]);
    shift = 0;
    Ray r{ray.origin, ray.direction, begin_of(ray), end_of(ray)};
    if (!scales() && is_comfortable(ray)) return r;
    const int exponent = std::ilogb(speed);
    r.origin = scaled(ray.origin);
    if (std::abs(exponent + exponent_) <= 31) {
      r.direction = ray.direction * factor_;
      return r;
    }
    shift = exponent + exponent_;
    for (int k = 0; k < 3; ++k) r.direction[k] = std::ldexp(ray.direction[k], -exponent);
    r.t_min = std::max(std::ldexp(r.t_min, shift), Limits::lowest());
    r.t_max = std::min(std::ldexp(r.t_max, shift), Limits::max());
    return r;
  }
  static T unscaled_t(T t, int shift, const Ray& ray) {
    return std::clamp(std::ldexp(t, -shift), begin_of(ray), end_of(ray));
  }

 private:
  using Limits = std::numeric_limits<T>;
  static constexpr int comfortable = Limits::max_exponent / 6;

  Point held(const Point& p, T limit) const {
    Point r;
    for (int k = 0; k < 3; ++k) r[k] = std::clamp(p[k] * factor_, -limit, limit);
    return r;
  }

  int exponent_ = 0;
  T factor_ = 1, inverse_ = 1;
};

}  // namespace treeline::accel
