// Whether two triangles of one mesh run through each other, without an error.
//
// Convention: triangles are closed sets. Corners at equal positions, under one index or two, are shared.
// Sharing a corner or an edge is no crossing by itself; having any point in common beyond it is, be it a
// touch from the side or an overlap in one plane. Triangles that share all three corners are the same one
// twice, and no crossing. Neither triangle may be degenerate; coordinates must be finite.
//
// Method: signs of orientations only. Triangles that share nothing meet if and only if an edge of one meets
// the other. Those that share a corner meet elsewhere if and only if the side across from it, of one of them,
// meets the other: what they have in common is convex and reaches, seen from the corner, to one of those
// sides. Those that share an edge overlap only in one plane, on one side of the edge. Sources: Guigue and
// Devillers 2003, "Fast and robust triangle-triangle overlap test using orientation predicates", for the test
// of planes first. Cost: 6 orientations as a rule, 2 if a corner is shared, 1 if an edge is. Known weakness:
// exactly coplanar triangles in a plane across the axes take exact arithmetic.
#pragma once

#include <array>

#include "geometry/exact/orientation.hpp"
#include "geometry/triangle.hpp"

namespace treeline::geometry {

namespace detail {

/// Orientations of points, with the exact zeros of flat and regular meshes found early.
template <class T>
int side_of_plane(const Vec<T, 3>& a, const Vec<T, 3>& b, const Vec<T, 3>& c, const Vec<T, 3>& d) {
  for (int k = 0; k < 3; ++k)
    if (a[k] == b[k] && b[k] == c[k] && c[k] == d[k]) return 0;
  return orientation(a, b, c, d);
}
inline int turn(const Vec2d& a, const Vec2d& b, const Vec2d& c) {
  const Vec2d p = b - a, q = c - a;
  bool short_numbers = true;  // 24 digits each, of floats: their products are exact
  for (int k = 0; k < 2; ++k)
    short_numbers = short_numbers && double(float(p[k])) == p[k] && double(float(q[k])) == q[k];
  const double m = p[0] * q[1], n = p[1] * q[0];
  if (short_numbers && (m == 0 || std::abs(m) > 0x1p-900) && (n == 0 || std::abs(n) > 0x1p-900))
    return m > n ? 1 : m < n ? -1 : 0;
  return orientation(a, b, c);
}

/// Triangles in one plane, seen along an axis along which they keep their area.
template <class T>
class InPlane {
 public:
  explicit InPlane(const Triangle<T>& t) {
    for (axis_ = 0; axis_ < 2; ++axis_)
      if (turn(flat(t.a), flat(t.b), flat(t.c)) != 0) return;
  }
  Vec2d flat(const Vec<T, 3>& p) const { return {double(p[(axis_ + 1) % 3]), double(p[(axis_ + 2) % 3])}; }

  bool contains(const Triangle<T>& t, const Vec<T, 3>& p) const {
    const Vec2d a = flat(t.a), b = flat(t.b), c = flat(t.c), x = flat(p);
    const int u = turn(a, b, x), v = turn(b, c, x), w = turn(c, a, x);
    return (u >= 0 && v >= 0 && w >= 0) || (u <= 0 && v <= 0 && w <= 0);
  }
  bool meet(const Vec<T, 3>& from, const Vec<T, 3>& to, const Vec<T, 3>& other_from,
            const Vec<T, 3>& other_to) const {
    const Vec2d p = flat(from), q = flat(to), r = flat(other_from), s = flat(other_to);
    const int o1 = turn(p, q, r), o2 = turn(p, q, s), o3 = turn(r, s, p), o4 = turn(r, s, q);
    if (o1 != 0 || o2 != 0) return o1 * o2 <= 0 && o3 * o4 <= 0;
    for (int k = 0; k < 2; ++k)  // on one line
      if (std::max(p[k], q[k]) < std::min(r[k], s[k]) || std::max(r[k], s[k]) < std::min(p[k], q[k]))
        return false;
    return true;
  }

 private:
  int axis_;
};

/// Whether segment pq meets triangle t, from the sides of t's plane on which p and q lie.
template <class T>
bool meets(const Vec<T, 3>& p, const Vec<T, 3>& q, int side_p, int side_q, const Triangle<T>& t) {
  if (side_p * side_q > 0) return false;
  if (side_p == 0 && side_q == 0) {
    const InPlane<T> plane(t);
    return plane.contains(t, p) || plane.meet(p, q, t.a, t.b) || plane.meet(p, q, t.b, t.c) ||
           plane.meet(p, q, t.c, t.a);
  }
  const int u = side_of_plane(p, q, t.a, t.b), v = side_of_plane(p, q, t.b, t.c);
  if (u * v < 0) return false;
  const int w = side_of_plane(p, q, t.c, t.a);
  return u * w >= 0 && v * w >= 0;
}

}  // namespace detail

/// How many corners of two triangles lie at equal positions, and the two triangles turned so that those come
/// first.
template <class T>
struct SharedCorners {
  int count = 0;
  std::array<Vec<T, 3>, 3> s, t;

  SharedCorners(const Triangle<T>& first, const Triangle<T>& second)
      : s{first.a, first.b, first.c}, t{second.a, second.b, second.c} {
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = static_cast<std::size_t>(count); j < 3; ++j)
        if (s[i] == t[j]) {
          std::swap(t[static_cast<std::size_t>(count)], t[j]);
          std::swap(s[static_cast<std::size_t>(count)], s[i]);
          ++count;
          break;
        }
  }
};

/// Whether two triangles have a point in common beyond their shared corners and edges.
template <class T>
bool cross_each_other(const Triangle<T>& first, const Triangle<T>& second) {
  const SharedCorners<T> shared(first, second);
  const Triangle<T> s{shared.s[0], shared.s[1], shared.s[2]}, t{shared.t[0], shared.t[1], shared.t[2]};
  if (shared.count == 3) return false;
  if (shared.count == 2) {
    if (detail::side_of_plane(s.a, s.b, s.c, t.c) != 0) return false;
    const detail::InPlane<T> plane(s);
    const Vec2d a = plane.flat(s.a), b = plane.flat(s.b);
    return detail::turn(a, b, plane.flat(s.c)) == detail::turn(a, b, plane.flat(t.c));
  }
  const int tb = detail::side_of_plane(s.a, s.b, s.c, t.b), tc = detail::side_of_plane(s.a, s.b, s.c, t.c);
  if (shared.count == 1) {
    if (tb * tc > 0) return false;
    const int sb = detail::side_of_plane(t.a, t.b, t.c, s.b), sc = detail::side_of_plane(t.a, t.b, t.c, s.c);
    return detail::meets(t.b, t.c, tb, tc, s) || detail::meets(s.b, s.c, sb, sc, t);
  }
  const int ta = detail::side_of_plane(s.a, s.b, s.c, t.a);
  if (ta == tb && tb == tc && ta != 0) return false;
  const int sa = detail::side_of_plane(t.a, t.b, t.c, s.a), sb = detail::side_of_plane(t.a, t.b, t.c, s.b),
            sc = detail::side_of_plane(t.a, t.b, t.c, s.c);
  if (sa == sb && sb == sc && sa != 0) return false;
  return detail::meets(t.a, t.b, ta, tb, s) || detail::meets(t.b, t.c, tb, tc, s) ||
         detail::meets(t.c, t.a, tc, ta, s) || detail::meets(s.a, s.b, sa, sb, t) ||
         detail::meets(s.b, s.c, sb, sc, t) || detail::meets(s.c, s.a, sc, sa, t);
}

}  // namespace treeline::geometry
