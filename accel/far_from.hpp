// Boxes that a triangle surely does not meet: the two filters before exact predicates.
//
// Source: the separating axes of a triangle and a box (Akenine-Moller 2001, "Fast 3D triangle-box overlap
// testing"), in double with bounds on the roundings. Corners and boxes: floats, or doubles whose products of
// three differences stay in range.
#pragma once

#include <algorithm>
#include <cmath>

#include "geometry/triangle.hpp"

namespace treeline::accel::detail {

/// Whether a box lies on one side of a triangle's plane for certain: large slanting triangles meet the boxes
/// of many that are nowhere near.
class FarFromPlane {
 public:
  template <class T>
  explicit FarFromPlane(const geometry::Triangle<T>& t) : origin_(t.a) {
    const geometry::Vec3d p = geometry::Vec3d(t.b) - origin_, q = geometry::Vec3d(t.c) - origin_;
    for (int k = 0; k < 3; ++k) {
      const double m = p[(k + 1) % 3] * q[(k + 2) % 3], n = p[(k + 2) % 3] * q[(k + 1) % 3];
      normal_[k] = m - n, slack_[k] = error * (std::abs(m) + std::abs(n));
    }
  }
  template <class T>
  bool operator()(const geometry::Box<T, 3>& box) const {
    double centre = 0, reach = 0;
    for (int k = 0; k < 3; ++k) {
      const double low = double(box.low[k]) - origin_[k], high = double(box.high[k]) - origin_[k];
      const double c = 0.5 * (low + high), h = 0.5 * (high - low);
      centre += normal_[k] * c;
      reach += std::abs(normal_[k]) * h + slack_[k] * (std::abs(c) + h);
    }
    return std::abs(centre) > reach;
  }

 private:
  // Roundings of a term: 4 of the normal (whose size, in the end, is the sum of its two products), 3 of the
  // box, 4 of the sums. Products of three differences of floats stay in the range of double.
  static constexpr double error = 32 * 0x1p-53;

  geometry::Vec3d origin_, normal_, slack_;
};

/// Whether a box lies beside a triangle for certain, seen along an axis: long thin triangles across the axes
/// have large boxes that they hardly fill, and planes that say nothing of where in them they lie. The other
/// nine axes of the test by separating axes (Akenine-Moller 2001).
class FarFromEdges {
 public:
  template <class T>
  explicit FarFromEdges(const geometry::Triangle<T>& t) : origin_(t.a) {
    const geometry::Vec3d corner[3] = {{}, geometry::Vec3d(t.b) - origin_, geometry::Vec3d(t.c) - origin_};
    for (int axis = 0; axis < 3; ++axis)
      for (int i = 0; i < 3; ++i) {
        const int u = (axis + 1) % 3, v = (axis + 2) % 3;
        Side& s = side_[axis][i];
        const geometry::Vec3d &from = corner[i], along = corner[(i + 1) % 3] - from,
                              across = corner[(i + 2) % 3] - from;
        s.u = along[v], s.v = -along[u];
        const double start = s.u * from[u] + s.v * from[v], width = s.u * across[u] + s.v * across[v];
        s.least = start + std::min(width, 0.0), s.most = start + std::max(width, 0.0);
        s.slack = error * (std::abs(s.u) * (std::abs(from[u]) + std::abs(across[u])) +
                           std::abs(s.v) * (std::abs(from[v]) + std::abs(across[v])));
      }
  }
  template <class T>
  bool operator()(const geometry::Box<T, 3>& box) const {
    double centre[3], half[3];
    for (int k = 0; k < 3; ++k) {
      const double low = double(box.low[k]) - origin_[k], high = double(box.high[k]) - origin_[k];
      centre[k] = 0.5 * (low + high), half[k] = 0.5 * (high - low);
    }
    for (int axis = 0; axis < 3; ++axis)
      for (const Side& s : side_[axis]) {
        const int u = (axis + 1) % 3, v = (axis + 2) % 3;
        const double middle = s.u * centre[u] + s.v * centre[v];
        const double reach = std::abs(s.u) * half[u] + std::abs(s.v) * half[v];
        const double slack = s.slack + error * (std::abs(s.u) * (std::abs(centre[u]) + half[u]) +
                                                std::abs(s.v) * (std::abs(centre[v]) + half[v]));
        if (middle - reach > s.most + slack || middle + reach < s.least - slack) return true;
      }
    return false;
  }

 private:
  /// Across an edge, in the plane of the other two axes: where the triangle lies.
  struct Side {
    double u, v, least, most, slack;
  };
  // Roundings of a term: 3 of the edge, 3 of the corner or box, 5 of the product and the sums.
  static constexpr double error = 32 * 0x1p-53;

  geometry::Vec3d origin_;
  Side side_[3][3];
};

}  // namespace treeline::accel::detail
