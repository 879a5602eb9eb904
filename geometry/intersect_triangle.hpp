// Ray against triangle: a fast test and a watertight one.
//
// Both treat triangles as closed sets, hit from both sides, at t in the closed interval [t_min, t_max];
// triangles with exactly no area are never hit, nor is one whose plane contains the ray. Both confine t to
// where the ray is in the triangle's own box (by BoxTest, so rounding included). A t from cancelling terms
// can then not leave the triangle's range, and since box tests are monotone, no box around the triangle
// excludes an accepted hit: a tree of boxes gives bit by bit what brute force gives.
// It is the computed t that must lie in the interval: a hit within its rounding of t_min or t_max falls on
// either side. Widening the interval would only move that line, and at t_min = 0 by enough to let rays hit
// the large triangle that they start from.
#pragma once

#include <array>
#include <optional>

#include "geometry/intersect_box.hpp"
#include "geometry/predicates.hpp"
#include "geometry/ray.hpp"
#include "geometry/rounding.hpp"
#include "geometry/triangle.hpp"

namespace treeline::geometry {

template <class T>
struct TriangleHit {
  T t, u, v;  // the point is (1 - u - v) a + u b + v c
};

namespace detail {
/// The last word on a candidate hit; what both tests share.
template <class T>
std::optional<TriangleHit<T>> confined(TriangleHit<T> hit, const Triangle<T>& triangle,
                                       const BoxTest<T>& box_test, T t_min, T t_max) {
  constexpr T infinity = std::numeric_limits<T>::infinity();
  T enter, exit;
  if (!box_test(triangle.box(), -infinity, infinity, enter, exit)) return {};
  hit.t = std::min(std::max(hit.t, enter), exit);
  if (!(t_min <= hit.t && hit.t <= t_max) || is_degenerate(triangle)) return {};
  return hit;
}
}  // namespace detail

/// Möller and Trumbore 1997, "Fast, minimum storage ray/triangle intersection".
/// Cost: about 27 products and one division. Known weakness: two triangles compute their shared edge
/// differently, so rays aimed at edges and vertices can pass between them, and t cancels for triangles seen
/// edge-on.
struct MollerTrumbore {
  template <class N>
  struct Crossing {
    N t, u, v;
  };
  /// Where a line crosses the plane of a triangle, over any number type.
  template <class N>
  static Crossing<N> crossing(const std::array<N, 3>& origin, const std::array<N, 3>& direction,
                              const std::array<N, 3>& a, const std::array<N, 3>& b,
                              const std::array<N, 3>& c) {
    using V = std::array<N, 3>;
    const auto minus = [](const V& p, const V& q) { return V{p[0] - q[0], p[1] - q[1], p[2] - q[2]}; };
    const auto dot = [](const V& p, const V& q) { return p[0] * q[0] + p[1] * q[1] + p[2] * q[2]; };
    const auto cross = [](const V& p, const V& q) {
      return V{p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]};
    };
    const V ab = minus(b, a), ac = minus(c, a), from_a = minus(origin, a);
    const V p = cross(direction, ac), q = cross(from_a, ab);
    const N determinant = dot(ab, p);
    return {dot(ac, q) / determinant, dot(from_a, p) / determinant, dot(direction, q) / determinant};
  }

  template <class T>
  class Prepared {
   public:
    explicit Prepared(const Ray<T>& ray) : origin_(ray.origin), direction_(ray.direction), box_test_(ray) {}

    std::optional<TriangleHit<T>> operator()(const Triangle<T>& triangle, T t_min, T t_max) const {
      using N = Rounded<T>;
      const auto numbers = [](const Vec<T, 3>& p) { return std::array<N, 3>{{{p[0]}, {p[1]}, {p[2]}}}; };
      const Crossing<N> at = crossing<N>(numbers(origin_), numbers(direction_), numbers(triangle.a),
                                         numbers(triangle.b), numbers(triangle.c));
      const T t = at.t.value, u = at.u.value, v = at.v.value;
      // Also when the determinant is zero: u is NaN or infinite.
      if (!(u >= T(0) && u <= T(1)) || !(v >= T(0) && u + v <= T(1)) || !(t == t)) return {};
      return detail::confined<T>({t, u, v}, triangle, box_test_, t_min, t_max);
    }

   private:
    Vec<T, 3> origin_, direction_;
    BoxTest<T> box_test_;
  };
};

/// Woop, Benthin and Wald 2013, "Watertight ray/triangle intersection" (JCGT 2:1).
///
/// Corners are sheared so that the ray becomes the major axis; the triangle is hit if the origin of the
/// remaining plane lies in the projected triangle. The shear of a corner depends on that corner alone, and an
/// edge function U = Cx By - Cy Bx is the difference of two products, each rounded on its own (see
/// rounded()). Rounding is monotone, so a computed U is zero or has the exact sign, and is the exact negative
/// of what the triangle across the edge computes. Counting zero as inside, no ray passes between two
/// triangles that share an edge or a vertex.
///
/// When any edge value comes out zero or not finite, all three are recomputed with exact products. Never
/// missing does not need that; not inventing hits does: for a triangle that, seen from the ray, is narrower
/// than a rounding error, two edge functions can round to zero though the ray passes it at any distance
/// beside it, and when all three underflow or cancel to zero a hit would be lost for want of weights. With
/// exact signs the test is the exact point-in-triangle test of the sheared, rounded corners: off by at most
/// the padding of BoxTest in position, everywhere. If all three are zero even so, the ray lies in the
/// triangle's (rounded) plane: no hit; the neighbours across the silhouette have the ray on their closed
/// edges.
///
/// t is the mean of the corners' heights with weights that are not negative, and confined to the triangle's
/// box. Cost: 12 products before the first rejection; 4 divisions per candidate; exact products only on exact
/// zeros. Known weakness: the weights of a triangle seen edge-on are inaccurate (t stays within its box). A
/// mesh whose closedness rests on faces of exactly no area (a corner amidst another face's edge) may leak
/// there, because such faces are never hit.
struct Watertight {
  /// What makes a direction the axis z.
  template <class T>
  struct Shear {
    int x, y, z;  // axes
    T speed;      // along z
    T along_x, along_y;

    explicit Shear(const Vec<T, 3>& direction) {
      z = largest_axis(direction);
      x = (z + 1) % 3, y = (x + 1) % 3;
      speed = direction[z];
      if (speed < T(0)) std::swap(x, y);  // keeps the winding
      along_x = direction[x] / speed, along_y = direction[y] / speed;
    }
  };
  template <class N>
  struct Sheared {
    N x, y, z;
  };
  /// A corner, given relative to the ray's origin and in the shear's axes, over any number type.
  template <class N>
  static Sheared<N> sheared(const N& x, const N& y, const N& z, const N& along_x, const N& along_y) {
    return {x - along_x * z, y - along_y * z, z};
  }
  template <class N>
  static std::array<N, 3> edges(const Sheared<N>& a, const Sheared<N>& b, const Sheared<N>& c) {
    const auto edge = [](const Sheared<N>& p, const Sheared<N>& q) { return p.x * q.y - p.y * q.x; };
    return {edge(c, b), edge(a, c), edge(b, a)};
  }

  template <class T>
  class Prepared {
   public:
    explicit Prepared(const Ray<T>& ray) : origin_(ray.origin), shear_(ray.direction), box_test_(ray) {}

    std::optional<TriangleHit<T>> operator()(const Triangle<T>& triangle, T t_min, T t_max) const {
      const Corner a = sheared(triangle.a), b = sheared(triangle.b), c = sheared(triangle.c);
      const auto edge = edges(a, b, c);
      const T u = edge[0].value, v = edge[1].value, w = edge[2].value;
      if (outside(u, v, w)) return {};
      const T sum = u + v + w;
      if (u != T(0) && v != T(0) && w != T(0) && std::isfinite(sum))
        return candidate<T>({u, v, w}, sum, a, b, c, triangle, t_min, t_max);

      const std::array<double, 3> e = exact_edges(a, b, c);
      const double exact_sum = e[0] + e[1] + e[2];
      if (outside(e[0], e[1], e[2]) || exact_sum == 0) return {};
      return candidate<double>(e, exact_sum, a, b, c, triangle, t_min, t_max);
    }

   private:
    using Number = Rounded<T>;
    using Corner = Sheared<Number>;

    Corner sheared(const Vec<T, 3>& corner) const {
      const Vec<T, 3> p = corner - origin_;
      return Watertight::sheared<Number>({p[shear_.x]}, {p[shear_.y]}, {p[shear_.z]}, {shear_.along_x},
                                         {shear_.along_y});
    }

    template <class S>
    static bool outside(S u, S v, S w) {
      return (u < S(0) || v < S(0) || w < S(0)) && (u > S(0) || v > S(0) || w > S(0));
    }

    /// The edge functions with exact signs, up to a common positive factor. Products of floats are exact in
    /// double. For doubles the corners are first scaled by a power of two near 1; where two rounded products
    /// agree, the difference of their errors is the exact value.
    static std::array<double, 3> exact_edges(const Corner& a, const Corner& b, const Corner& c) {
      double scale = 1;
      if constexpr (!std::is_same_v<T, float>) {
        const T largest =
            std::max({std::abs(a.x.value), std::abs(a.y.value), std::abs(b.x.value), std::abs(b.y.value),
                      std::abs(c.x.value), std::abs(c.y.value), std::numeric_limits<T>::min()});
        scale = std::ldexp(1.0, -std::ilogb(largest));
      }
      const auto exact = [scale](const Corner& p, const Corner& q) {
        const Split m = two_product(p.x.value * scale, q.y.value * scale),
                    n = two_product(p.y.value * scale, q.x.value * scale);
        return m.value != n.value ? m.value - n.value : m.error - n.error;
      };
      return {exact(c, b), exact(a, c), exact(b, a)};
    }

    template <class S>
    std::optional<TriangleHit<T>> candidate(const std::array<S, 3>& edges, S sum, const Corner& a,
                                            const Corner& b, const Corner& c, const Triangle<T>& triangle,
                                            T t_min, T t_max) const {
      const S u = edges[0] / sum, v = edges[1] / sum, w = edges[2] / sum;
      const T height = static_cast<T>(u * S(a.z.value) + v * S(b.z.value) + w * S(c.z.value));
      return detail::confined<T>({height / shear_.speed, T(v), T(w)}, triangle, box_test_, t_min, t_max);
    }

    Vec<T, 3> origin_;
    Shear<T> shear_;
    BoxTest<T> box_test_;
  };
};

}  // namespace treeline::geometry
