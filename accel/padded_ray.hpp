// Where a ray crosses axis-aligned planes, with a slack in space folded into constants of the ray.
//
// Problem: the box test of geometry/intersect_box.hpp measures each box for its padding. Within one tree all
// boxes lie in one root box, so one slack, relative to the distance of the root box's farthest side, serves
// all: a plane costs a subtraction and a product. Source: Ize 2013, section 4, with the padding moved from
// the inverse direction to the origin, which keeps zero direction components right: (s - c) * inf is -inf or
// +inf on the two sides of c.
//
// Guarantee: if a hit's point origin + t direction is within hit_slack * reach of a point of a box, then t is
// in [enter, exit] of that box. NaN (0 * inf, inf - inf) never narrows an interval. Known weakness: a ray
// from afar sees all boxes grown by 2e-6 (float) of its distance.
#pragma once

#include "geometry/box.hpp"
#include "geometry/ray.hpp"
#include "geometry/tolerances.hpp"

namespace treeline::accel {

/// Largest distance along an axis from the ray's origin to a side of a box.
template <class T>
T reach_of(const geometry::Vec<T, 3>& origin, const geometry::Box<T, 3>& box) {
  T reach = 0;
  for (int k = 0; k < 3; ++k)
    reach = std::max({reach, std::abs(box.low[k] - origin[k]), std::abs(box.high[k] - origin[k])});
  return reach;
}

template <class T>
class PaddedRay {
 public:
  PaddedRay(const geometry::Ray<T>& ray, T reach) {
    constexpr T infinity = std::numeric_limits<T>::infinity();
    constexpr T u = geometry::tolerance::unit_roundoff<T>;
    const T slack = geometry::tolerance::plane_slack<T> * reach + std::numeric_limits<T>::min();
    for (int k = 0; k < 3; ++k) {
      // 3 u |origin|: the sums below round by at most u |origin|.
      const T padding = slack + T(3) * u * std::abs(ray.origin[k]);
      T above = ray.origin[k] + padding, below = ray.origin[k] - padding;
      inverse_[k] = T(1) / ray.direction[k];
      if (ray.direction[k] != T(0) && !std::isnormal(inverse_[k]))
        above = infinity, below = -infinity;  // the quotient is not accurate: this axis never excludes
      backward_[k] = std::signbit(ray.direction[k]);
      enter_from_[k] = backward_[k] ? below : above;
      exit_from_[k] = backward_[k] ? above : below;
    }
  }

  /// 1 if the ray runs against the axis, else 0.
  std::size_t backward(int axis) const { return backward_[axis]; }
  /// No t of a point on the far side of the plane is below; may be NaN: no bound.
  T enter(int axis, T plane) const { return (plane - enter_from_[axis]) * inverse_[axis]; }
  /// No t of a point on the near side of the plane is above; may be NaN: no bound.
  T exit(int axis, T plane) const { return (plane - exit_from_[axis]) * inverse_[axis]; }

  /// Narrows [t0, t1] to the box between two corners, low and high; false if nothing remains.
  [[gnu::always_inline]] bool clip(const geometry::Vec<T, 3> (&sides)[2], T& t0, T& t1) const {
    for (int k = 0; k < 3; ++k) {
      const T first = enter(k, sides[backward_[k]][k]), last = exit(k, sides[1 - backward_[k]][k]);
      t0 = first > t0 ? first : t0;
      t1 = last < t1 ? last : t1;
    }
    return t0 <= t1;
  }
  bool clip(const geometry::Box<T, 3>& box, T& t0, T& t1) const {
    const geometry::Vec<T, 3> sides[2] = {box.low, box.high};
    return clip(sides, t0, t1);
  }

 private:
  T enter_from_[3], exit_from_[3], inverse_[3];
  std::size_t backward_[3];  // 0 or 1
};

}  // namespace treeline::accel
