// The box of the part of a triangle that lies in a box, rounded outward.
//
// Sutherland and Hodgman 1974 in double, against a region enlarged by `slack`, so that a triangle that
// touches the region is never lost. Cost: about 100 operations.
#pragma once

#include <array>

#include "geometry/triangle.hpp"

namespace treeline::accel {

/// Empty if the triangle stays at least slack away from the region; else within the region.
template <class T>
geometry::Box<T, 3> clipped_box(const geometry::Triangle<T>& triangle, const geometry::Box<T, 3>& region,
                                T slack) {
  using geometry::Vec3d;
  std::array<Vec3d, 10> polygon{Vec3d(triangle.a), Vec3d(triangle.b), Vec3d(triangle.c)}, next;
  std::size_t n = 3;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {1.0, -1.0}) {
      const double limit = sign * double(sign > 0 ? region.high[axis] : region.low[axis]) + double(slack);
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
  geometry::Box<T, 3> box;
  const auto margin = geometry::Vec<T, 3>::filled(slack);
  for (std::size_t i = 0; i < n; ++i) {
    const geometry::Vec<T, 3> p(polygon[i]);
    box.grow(p - margin), box.grow(p + margin);
  }
  return intersection(box, region);
}

}  // namespace treeline::accel
