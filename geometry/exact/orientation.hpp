// On which side of a plane through three points a fourth lies, without an error; and the same in the plane.
//
// Convention: 1 where the normal of the triangle a, b, c points, so that it is seen counter-clockwise from
// there; 0 on the plane, and for all points if the triangle has no area; -1 behind. That is the sign of det(b
// - a, c - a, d - a), the opposite of Shewchuk's. Any finite floats or doubles, of any size.
//
// Filter: with X, Y, Z the largest absolute differences along each axis, as computed, each of the
// determinant's six terms is at most X Y Z in magnitude, and passes through at most 8 roundings: 3 of the
// differences, 2 of the products, 3 of the sums. The error is at most 6 gamma(8) X Y Z (1 + u)^3, and 49 u
// times the product as computed, which may have lost 2 u, covers it; fused operations round less. Products
// outside of 2^-600 … 2^990 are left to exact arithmetic. Source: the semi-static filters of Devillers and
// Pion 2003. Then as in sign.hpp. Cost: 9 absolute values, 6 maxima and 3 products on top of the
// determinant: 1.5 times its 2.5 ns in a loop that does nothing else; 1.06 times for OrientationWithin.
#pragma once

#include "geometry/exact/sign.hpp"

namespace treeline::geometry {

namespace detail {
inline constexpr double orientation_filter = 49 * 0x1p-53;
inline double larger(double a, double b) { return a > b ? a : b; }
struct Orientation3 {
  const Vec3d &a, &b, &c, &d;
  template <class N>
  N operator()() const {
    using V = Vec<N, 3>;
    const V o(a);
    return dot(cross(V(b) - o, V(c) - o), V(d) - o);
  }
};
struct Orientation2 {
  const Vec2d &a, &b, &c;
  template <class N>
  N operator()() const {
    using V = Vec<N, 2>;
    const V o(a), p = V(b) - o, q = V(c) - o;
    return p[0] * q[1] - p[1] * q[0];
  }
};
}  // namespace detail

/// Not inlined: woven into a loop, GCC makes short vectors of it and loses half the speed.
[[gnu::noinline]] inline int orientation(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
  const Vec3d p = b - a, q = c - a, r = d - a;
  const double det = dot(cross(p, q), r);
  const double x = detail::larger(detail::larger(std::abs(p[0]), std::abs(q[0])), std::abs(r[0]));
  const double y = detail::larger(detail::larger(std::abs(p[1]), std::abs(q[1])), std::abs(r[1]));
  const double z = detail::larger(detail::larger(std::abs(p[2]), std::abs(q[2])), std::abs(r[2]));
  if ((std::abs(det) > detail::orientation_filter * (x * y * z)) & keeps_digits(x, y, z)) [[likely]]
    return int(det > 0) - int(det < 0);
  return exact_sign(detail::Orientation3{a, b, c, d});
}
inline int orientation(const Vec3f& a, const Vec3f& b, const Vec3f& c, const Vec3f& d) {
  return orientation(Vec3d(a), Vec3d(b), Vec3d(c), Vec3d(d));
}

/// The same for many points known to lie in a cube: |coordinates| ≤ reach. The bound is found once, as a
/// static filter, and a test costs hardly more than the determinant; it leaves more open where points are
/// close.
class OrientationWithin {
 public:
  explicit OrientationWithin(double reach) {
    const double side = 2 * reach * (1 + 0x1p-52);
    bound_ = keeps_digits(side, side, side) ? detail::orientation_filter * (side * side * side) : largest_;
  }
  [[gnu::noinline]] int operator()(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) const {
    const double det = dot(cross(b - a, c - a), d - a);
    if (std::abs(det) > bound_) [[likely]]
      return int(det > 0) - int(det < 0);
    return exact_sign(detail::Orientation3{a, b, c, d});
  }

 private:
  static constexpr double largest_ = std::numeric_limits<double>::infinity();
  double bound_;
};

/// In the plane: 1 if a, b, c turn counter-clockwise, 0 if they lie on a line, -1 if clockwise. Filter: two
/// terms of at most 4 roundings each, and the same reasoning: 9 u X Y.
inline int orientation(const Vec2d& a, const Vec2d& b, const Vec2d& c) {
  const Vec2d p = b - a, q = c - a;
  const double det = p[0] * q[1] - p[1] * q[0];
  const double x = std::max(std::abs(p[0]), std::abs(q[0])), y = std::max(std::abs(p[1]), std::abs(q[1]));
  if ((std::abs(det) > 9 * 0x1p-53 * (x * y)) & keeps_digits(x, y, 1)) [[likely]]
    return int(det > 0) - int(det < 0);
  return exact_sign(detail::Orientation2{a, b, c});
}

}  // namespace treeline::geometry
