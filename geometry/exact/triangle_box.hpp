// Whether a triangle and an axis-aligned box overlap, without an error.
//
// Conventions: both are closed sets, so touching counts; a triangle of no area is the segment or point that
// it covers, and a box with low > high along an axis is empty and overlaps nothing. Any finite floats or
// doubles, of any size.
//
// Separating axes (Akenine-Möller 2001): 3 of the box, 1 of the triangle, 9 products of edges. Those of the
// box are comparisons and cannot err. On each of the others, the sign of the box's extreme corner against the
// triangle's plane or, seen along an axis, against one of its edges decides; corners are chosen by low and
// high, so that nothing is rounded but in the orientations themselves. Only the side that an edge faces away
// from the triangle can separate; both if the triangle is seen edge-on. Filter: one bound for all, derived
// below; what it leaves open is decided one by one (orientation.hpp). Cost: 13 tests at most. Known weakness:
// boxes that touch the triangle's plane exactly pay for exact arithmetic: about 1 µs.
#pragma once

#include "geometry/exact/orientation.hpp"
#include "geometry/triangle.hpp"

namespace treeline::geometry {

namespace detail {

/// Seen along one axis: is the box strictly on the far side of the line through p and q from r, or, if all
/// three are on a line, strictly on one side?
inline bool edge_separates(const Vec2d& p, const Vec2d& q, const Vec2d& r, const Box<double, 2>& box) {
  if (p == q) return false;
  const int inside = orientation(p, q, r);
  for (const int side : {1, -1}) {
    if (inside == side) continue;
    // The corner of the box least on this side of the line is still on it.
    const bool right = (q[1] > p[1]) == (side > 0), up = (q[0] < p[0]) == (side > 0);
    const Vec2d corner{right ? box.high[0] : box.low[0], up ? box.high[1] : box.low[1]};
    if (orientation(p, q, corner) == side) return true;
  }
  return false;
}

inline bool plane_separates(const Triangle3d& t, const Box<double, 3>& box) {
  // The corners of the box farthest along the normal and against it; its signs are areas seen along an axis.
  Vec3d most, least;
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    const bool forward = orientation(Vec2d{t.a[i], t.a[j]}, Vec2d{t.b[i], t.b[j]}, Vec2d{t.c[i], t.c[j]}) > 0;
    most[k] = forward ? box.high[k] : box.low[k], least[k] = forward ? box.low[k] : box.high[k];
  }
  return orientation(t.a, t.b, t.c, most) < 0 || orientation(t.a, t.b, t.c, least) > 0;
}

inline bool axes_separate(const Triangle3d& t, const Box<double, 3>& box) {
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    const Box<double, 2> seen{{box.low[i], box.low[j]}, {box.high[i], box.high[j]}};
    const Vec2d a{t.a[i], t.a[j]}, b{t.b[i], t.b[j]}, c{t.c[i], t.c[j]};
    if (edge_separates(a, b, c, seen) || edge_separates(b, c, a, seen) || edge_separates(c, a, b, seen))
      return true;
  }
  return plane_separates(t, box);
}

}  // namespace detail

inline bool overlaps(const Triangle3d& t, const Box<double, 3>& box) {
  const Vec3d* const corner[3] = {&t.a, &t.b, &t.c};
  for (int k = 0; k < 3; ++k) {
    const auto [low, high] = std::minmax({t.a[k], t.b[k], t.c[k]});
    if (low > box.high[k] || high < box.low[k] || box.low[k] > box.high[k]) return false;
  }
  // From here on in double. E bounds the edges' components, R the distances from the box's planes to corners.
  // A value seen along an axis has two terms of 4 roundings (2 differences, a product, a sum) of at most E R,
  // or E² for the area: 9 u E max(E, R) covers it. The plane's has six of at most E² R and 8 roundings, as an
  // orientation does: 50 u E² R.
  Vec3d edge[3], low[3], high[3];
  double longest = 0, reach = 0;
  for (int e = 0; e < 3; ++e) {
    const Vec3d& p = *corner[e];
    edge[e] = *corner[(e + 1) % 3] - p, low[e] = box.low - p, high[e] = box.high - p;
    for (int k = 0; k < 3; ++k) {
      longest = std::max(longest, std::abs(edge[e][k]));
      reach = std::max({reach, std::abs(low[e][k]), std::abs(high[e][k])});
    }
  }
  reach = std::max(reach, longest);
  constexpr double u = 0x1p-53;
  const double flat = 9 * u * longest * reach, whole = 50 * u * (longest * longest) * reach;
  bool certain = keeps_digits(longest, longest, reach);
  if (!certain) return !detail::axes_separate(t, box);
  double most = 0, least = 0;  // of the box along the normal, from corner a
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    const double area = edge[2][i] * edge[0][j] - edge[2][j] * edge[0][i];  // the normal's component
    const double x = area * low[0][k], y = area * high[0][k];
    most += std::max(x, y), least += std::min(x, y);
    for (int e = 0; e < 3; ++e) {
      // f(c) = edge_i (c_j - p_j) - edge_j (c_i - p_i), positive on the side of the edge that faces the
      // triangle where the area is positive.
      const double p = edge[e][i] * low[e][j], q = edge[e][i] * high[e][j];
      const double r = edge[e][j] * low[e][i], s = edge[e][j] * high[e][i];
      const double f_most = std::max(p, q) - std::min(r, s), f_least = std::min(p, q) - std::max(r, s);
      if ((f_most < -flat && area > flat) || (f_least > flat && area < -flat)) return false;
      certain = certain && (f_most > flat || area < -flat) && (f_least < -flat || area > flat);
    }
  }
  if (most < -whole || least > whole) return false;
  return (certain && most > whole && least < -whole) || !detail::axes_separate(t, box);
}
inline bool overlaps(const Triangle3f& t, const Box<float, 3>& box) {
  return overlaps(Triangle3d(t), Box<double, 3>{Vec3d(box.low), Vec3d(box.high)});
}

}  // namespace treeline::geometry
