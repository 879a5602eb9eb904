// The distance from a point to a triangle, without an error: squared and rounded once; and which of two
// triangles is nearer, decided exactly.
//
// Conventions: the triangle is a closed set; one of no area is the segment or point that it covers. Equal
// distances compare as 0. Any finite floats or doubles, of any size.
//
// The nearest feature (face, edge, corner) is found by the signs that bound the Voronoi regions (Ericson
// 2005, section 5.1.5), which are polynomials; the squared distance to it is then a quotient of two
// polynomials: n · (p - a) squared over n · n, or |along x (p - a)|² over |along|², or |p - a|². Value: pairs
// of doubles, exact arithmetic where their error leaves the rounding open, as it does for points within 1e-15
// of the plane. Comparison: first a bracket in double of each distance. Above, the distance to a point
// computed in the triangle; below, for any direction w, the least w · (p - corner) / |w|: a plane that
// separates them. Cost: a bracket some 10 ns on top of the closest point in double; a value 0.5 to 1 µs; a
// comparison left open some 20 µs.
#pragma once

#include "geometry/distance.hpp"
#include "geometry/exact/ray_triangle.hpp"

namespace treeline::geometry {

namespace detail {

struct DotSign {  // (q - p) · (x - y)
  const Vec3d &p, &q, &x, &y;
  template <class N>
  N operator()() const {
    using V = Vec<N, 3>;
    return dot(V(q) - V(p), V(x) - V(y));
  }
};

/// The volume n · ((u - p) x (v - p)), whose sign tells the side of edge u v on which p projects.
struct EdgeSide {
  const Triangle3d& t;
  const Vec3d &p, &u, &v;
  template <class N>
  N operator()() const {
    using V = Vec<N, 3>;
    const V a(t.a), x(p);
    return dot(cross(V(t.b) - a, V(t.c) - a), cross(V(u) - x, V(v) - x));
  }
};

/// A sum of at most 12 terms of up to 12 roundings each, of the sizes given: its sign if double is enough.
template <class Polynomial>
int filtered_sign(double value, double magnitude, const Polynomial& polynomial) {
  if (std::abs(value) > 32 * 0x1p-53 * magnitude && 0x1p-600 < magnitude && magnitude < 0x1p600)
    return value > 0 ? 1 : -1;
  return exact_sign(polynomial);
}

inline double absolute_dot(const Vec3d& a, const Vec3d& b) {
  return std::abs(a[0] * b[0]) + std::abs(a[1] * b[1]) + std::abs(a[2] * b[2]);
}
inline int dot_sign(const Vec3d& p, const Vec3d& q, const Vec3d& x, const Vec3d& y) {
  const Vec3d u = q - p, v = x - y;
  return filtered_sign(dot(u, v), absolute_dot(u, v), DotSign{p, q, x, y});
}
inline int edge_side(const Triangle3d& t, const Vec3d& p, const Vec3d& u, const Vec3d& v) {
  const auto sizes = [](const Vec3d& a, const Vec3d& b) {  // of the terms of a cross product
    return Vec3d{std::abs(a[1] * b[2]) + std::abs(a[2] * b[1]), std::abs(a[2] * b[0]) + std::abs(a[0] * b[2]),
                 std::abs(a[0] * b[1]) + std::abs(a[1] * b[0])};
  };
  const Vec3d ab = t.b - t.a, ac = t.c - t.a, pu = u - p, pv = v - p;
  const Vec3d m = sizes(ab, ac), n = sizes(pu, pv);
  return filtered_sign(dot(cross(ab, ac), cross(pu, pv)), dot(m, n), EdgeSide{t, p, u, v});
}

/// Squared distance to one feature, as a quotient; numbered as in ClosestOnTriangle.
struct FeatureDistance2 {
  const Vec3d& p;
  const Triangle3d& t;
  int feature;
  template <class N>
  void quotient(N& above, N& below) const {
    using V = Vec<N, 3>;
    const V x(p), a(t.a), b(t.b), c(t.c);
    const auto to_line = [&](const V& from, const V& to) {
      const V along = to - from;
      above = length2(cross(along, x - from)), below = length2(along);
    };
    switch (feature) {
      case 0: {
        const V n = cross(b - a, c - a);
        const N height = dot(n, x - a);
        above = height * height, below = length2(n);
        return;
      }
      case 1:
        return to_line(a, b);
      case 2:
        return to_line(b, c);
      case 3:
        return to_line(c, a);
      default:
        above = length2(x - (feature == 4 ? a : feature == 5 ? b : c)), below = N(1);
    }
  }
};

struct DistanceOrder {
  FeatureDistance2 first, second;
  template <class N>
  N operator()() const {
    N a, b, c, d;
    first.quotient(a, b), second.quotient(c, d);
    return a * d - c * b;
  }
};

}  // namespace detail

/// The feature of a triangle nearest to p: 0 the face, 1 edge ab, 2 edge bc, 3 edge ca, 4 corner a, 5 b, 6 c.
/// A point on the border of two regions belongs to the smaller feature.
inline int exact_feature(const Vec3d& p, const Triangle3d& t) {
  // All the signs below would be exact zeros, which are dear.
  if (p == t.a) return 4;
  if (p == t.b) return 5;
  if (p == t.c) return 6;
  const int d1 = detail::dot_sign(t.a, t.b, p, t.a), d2 = detail::dot_sign(t.a, t.c, p, t.a);
  if (d1 <= 0 && d2 <= 0) return 4;
  const int d3 = detail::dot_sign(t.a, t.b, p, t.b), e3 = detail::dot_sign(t.b, t.c, p, t.b);
  if (d3 >= 0 && e3 <= 0) return 5;
  const int d6 = detail::dot_sign(t.a, t.c, p, t.c), e6 = detail::dot_sign(t.b, t.c, p, t.c);
  if (d6 >= 0 && e6 >= 0) return 6;
  // An edge without a length is left to the others.
  if (d1 >= 0 && d3 <= 0 && !(t.a == t.b) && detail::edge_side(t, p, t.a, t.b) <= 0) return 1;
  if (e3 >= 0 && e6 <= 0 && !(t.b == t.c) && detail::edge_side(t, p, t.b, t.c) <= 0) return 2;
  if (d2 >= 0 && d6 <= 0 && !(t.a == t.c) && detail::edge_side(t, p, t.c, t.a) <= 0) return 3;
  return 0;
}

namespace detail {

/// All in one function, as callers that rarely run have the compiler save space: exact queries of the wide
/// tree are a tenth faster by it.
[[gnu::flatten, gnu::noinline]] inline void bounded_quotient(const FeatureDistance2& nearest,
                                                             BoundedDouble& above, BoundedDouble& below) {
  nearest.quotient(above, below);
}

/// Rounded once.
template <class T>
T rounded_distance2(const FeatureDistance2& nearest) {
  BoundedDouble above, below;
  bounded_quotient(nearest, above, below);
  if (above.certain_sign() == 0) return 0;  // of which no digit is left to round
  if (const auto r = rounded_if_certain<T>(above, below)) return *r;
  Dyadic n, d;
  nearest.quotient(n, d);
  return rounded_quotient<T>(n, d);
}

}  // namespace detail

/// The squared distance, rounded once to the nearest double.
inline double exact_distance2(const Vec3d& p, const Triangle3d& triangle) {
  return detail::rounded_distance2<double>({p, triangle, exact_feature(p, triangle)});
}

struct DistanceBracket {
  double low, high;
};

/// Bounds on the distance (not squared) found in double, infinite where its range ends. The point computed is
/// off the triangle by at most 6 roundings of its largest coordinate an axis, sqrt(3) · 6 < 16; the distance
/// to it takes 4 roundings. The dot product with w takes 4 (1 + 1 + 2), its length 3 and the quotient 1,
/// relative to |w| |p - corner|. The sum of both kinds of bound is doubled against its own roundings.
inline DistanceBracket distance_bracket(const Vec3d& p, const Triangle3d& t) {
  const Vec3d q = closest_point_on_triangle(p, t).point, w = p - q;
  const double d = std::sqrt(length2(w));
  double reach = 0, least = std::numeric_limits<double>::infinity(), farthest = 0;
  for (const Vec3d* corner : {&t.a, &t.b, &t.c}) {
    for (int k = 0; k < 3; ++k) reach = std::max(reach, std::abs((*corner)[k]));
    const Vec3d v = p - *corner;
    least = std::min(least, dot(w, v)), farthest = std::max(farthest, detail::absolute_dot(w, v));
  }
  constexpr double u = 0x1p-53;
  if (!(0x1p-400 < d && d < 0x1p400 && farthest < 0x1p900 && reach < 0x1p900))
    return {0, std::numeric_limits<double>::infinity()};
  return {(least - 16 * u * farthest) / d, d + u * (8 * d + 32 * reach)};
}

/// -1 if p is nearer to the first triangle, 1 if nearer to the second, 0 if as near.
inline int compare_distance(const Vec3d& p, const Triangle3d& first, const Triangle3d& second) {
  const DistanceBracket a = distance_bracket(p, first), b = distance_bracket(p, second);
  if (a.high < b.low) return -1;
  if (b.high < a.low) return 1;
  return exact_sign(
      detail::DistanceOrder{{p, first, exact_feature(p, first)}, {p, second, exact_feature(p, second)}});
}

}  // namespace treeline::geometry
