// Where a ray crosses axis-aligned planes, with a slack in space folded into constants of the ray.
//
// Problem: the box test of geometry/intersect_box.hpp measures each box for its padding. Source: Ize 2013,
// section 4, with the padding moved from the inverse direction to the origin, which keeps zero direction
// components right: (s - c) * inf is -inf or +inf on the two sides of c. The padding that a triangle needs is
// relative to its distance from the ray's origin, so at most to the sum of two distances from the tree's
// centre: the origin's, which is the ray's affair and a constant of it, and that of the triangle's farthest
// corner, by which trees store their planes and boxes widened (widened()). A plane costs a subtraction and a
// product, and a triangle far away from the others costs only the nodes that it is in.
//
// Guarantee: if a hit's point origin + t direction is within hit_slack of a triangle's reach of a point of a
// box that was widened for that triangle, then t is in [enter, exit] of that box. NaN (0 * inf, inf - inf)
// never narrows an interval. Known weakness: a ray from afar sees all boxes grown by 2e-6 (float) of its
// distance from the tree's centre; so do rays amid one of two meshes if the centre is in the other.
#pragma once

#include "geometry/box.hpp"
#include "geometry/ray.hpp"
#include "geometry/tolerances.hpp"

namespace treeline::accel {

/// Largest distance along an axis from a point to a side of a box.
template <class T>
T reach_of(const geometry::Vec<T, 3>& point, const geometry::Box<T, 3>& box) {
  T reach = 0;
  for (int k = 0; k < 3; ++k)
    reach = std::max({reach, std::abs(box.low[k] - point[k]), std::abs(box.high[k] - point[k])});
  return reach;
}

/// Bounds widened for triangles of the given reach from the tree's centre.
template <class T>
struct Widened {
  T low, high;

  Widened(T low_side, T high_side, T reach) {
    constexpr T u = geometry::tolerance::unit_roundoff<T>;
    const T slack = geometry::tolerance::stored_slack<T> * reach + std::numeric_limits<T>::min();
    low = low_side - (slack + T(2) * u * std::abs(low_side));  // 2 u: the difference rounds
    high = high_side + (slack + T(2) * u * std::abs(high_side));
  }
};
template <class T>
geometry::Box<T, 3> widened(const geometry::Box<T, 3>& box, T reach) {
  geometry::Box<T, 3> r;
  for (int k = 0; k < 3; ++k) {
    const Widened<T> side(box.low[k], box.high[k], reach);
    r.low[k] = side.low, r.high[k] = side.high;
  }
  return r;
}

template <class T>
class PaddedRay {
 public:
  /// `reach`: how far the ray's origin is from the tree's centre, along an axis.
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
