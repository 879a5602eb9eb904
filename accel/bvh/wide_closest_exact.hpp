// Which of two triangles is nearer to a point, without an error and, as a rule, without exact arithmetic.
//
// Where doubles leave it open, it is mostly because the point is nearest to a corner or an edge that both
// triangles share: then they are as near, whatever the numbers are. Only what is left is compared exactly
// (geometry::DistanceOrder). Cost: some 50 ns for each triangle's feature; some 20 µs for what is left.
#pragma once

#include "accel/concepts.hpp"
#include "geometry/exact/triangle_distance.hpp"

namespace treeline::accel::wide {

/// A triangle in the user's space, and where on it the nearest point lies.
struct ExactlyNear {
  geometry::Triangle<double> triangle;
  int feature;  // as in geometry::ClosestOnTriangle

  /// known: the feature, or -1 where it is to be found.
  ExactlyNear(const geometry::Vec3d& p, const geometry::Triangle<double>& t, int known)
      : triangle(t), feature(known >= 0 ? known : geometry::exact_feature(p, t)) {}

  const geometry::Vec3d& corner(int i) const {
    return i % 3 == 0 ? triangle.a : i % 3 == 1 ? triangle.b : triangle.c;
  }
};

inline bool share_nearest_feature(const ExactlyNear& x, const ExactlyNear& y) {
  if (x.feature >= 4 && y.feature >= 4) return x.corner(x.feature - 4) == y.corner(y.feature - 4);
  if (x.feature == 0 || y.feature == 0 || x.feature >= 4 || y.feature >= 4)
    return x.triangle == y.triangle && x.feature == y.feature;
  const auto &p = x.corner(x.feature - 1), &q = x.corner(x.feature);
  const auto &r = y.corner(y.feature - 1), &s = y.corner(y.feature);
  return (p == r && q == s) || (p == s && q == r);
}

/// -1 if the first is nearer to p, 1 if the second is, 0 if they are as near.
inline int compare(const geometry::Vec3d& p, const ExactlyNear& x, const ExactlyNear& y) {
  if (share_nearest_feature(x, y)) return 0;
  return geometry::exact_sign(
      geometry::detail::DistanceOrder{{p, x.triangle, x.feature}, {p, y.triangle, y.feature}});
}

/// above - limit² below, for the squared distance above / below.
struct BeyondLimit {
  geometry::detail::FeatureDistance2 near;
  double limit;
  template <class N>
  N operator()() const {
    N above, below;
    near.quotient(above, below);
    return above - N(limit) * N(limit) * below;
  }
};

/// Whether the triangle lies within a distance.
inline bool is_within(const geometry::Vec3d& p, const ExactlyNear& x, double limit) {
  return !(limit < std::numeric_limits<double>::infinity()) ||
         geometry::exact_sign(BeyondLimit{{p, x.triangle, x.feature}, limit}) <= 0;
}

/// The squared distance, rounded once.
template <class T>
T distance2(const geometry::Vec3d& p, const ExactlyNear& x) {
  return geometry::detail::rounded_distance2<T>({p, x.triangle, x.feature});
}

}  // namespace treeline::accel::wide
