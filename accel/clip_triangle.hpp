// The box of the part of a triangle that lies in a box, rounded outward.
//
// Sutherland and Hodgman 1974 in double, against the region enlarged by what its roundings come to, so that a
// triangle that touches the region is never lost. Cost: about 100 operations.
#pragma once

#include <array>

#include "geometry/tolerances.hpp"
#include "geometry/triangle.hpp"

namespace treeline::accel {

/// Empty if the triangle stays clear of the region; else within the region.
template <class T>
geometry::Box<T, 3> clipped_box(const geometry::Triangle<T>& triangle, const geometry::Box<T, 3>& region) {
  using geometry::Vec3d;
  std::array<Vec3d, 10> polygon{Vec3d(triangle.a), Vec3d(triangle.b), Vec3d(triangle.c)}, next;
  std::size_t n = 3;
  double largest = 0;
  for (int axis = 0; axis < 3; ++axis)
    for (std::size_t i = 0; i < 3; ++i) largest = std::max(largest, std::abs(polygon[i][axis]));
  const double slack = geometry::tolerance::clip_slack * largest + std::numeric_limits<double>::min();
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {1.0, -1.0}) {
      const double limit = sign * double(sign > 0 ? region.high[axis] : region.low[axis]) + slack;
      const auto beyond = [&](const Vec3d& p) { return sign * p[axis] - limit; };
      std::size_t kept = 0;
      for (std::size_t i = 0; i < n; ++i) {
        const Vec3d &p = polygon[i], &q = polygon[i + 1 < n ? i + 1 : 0];
        const double dp = beyond(p), dq = beyond(q);
        if (dp <= 0) next[kept++] = p;
        if ((dp < 0 && dq > 0) || (dp > 0 && dq < 0)) next[kept++] = p + (q - p) * (dp / (dp - dq));
      }
      polygon = next;
      n = kept;
    }
  }
  // Outward, by the slack and the rounding to T.
  constexpr double u = std::is_same_v<T, double> ? 0 : double(geometry::tolerance::unit_roundoff<T>);
  geometry::Box<T, 3> box;
  for (std::size_t i = 0; i < n; ++i)
    for (int k = 0; k < 3; ++k) {
      const double x = polygon[i][k], margin = slack + 2 * u * std::abs(x);
      box.low[k] = std::min(box.low[k], static_cast<T>(x - margin));
      box.high[k] = std::max(box.high[k], static_cast<T>(x + margin));
    }
  return intersection(box, region);
}

}  // namespace treeline::accel
