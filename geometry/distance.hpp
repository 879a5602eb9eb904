// Distances from a point to a box and to a triangle.
//
// Distances are squared, and those to a triangle are measured to the point that is returned, which lies in
// the triangle's box. The differences that enter the distance to a box are then never larger than those that
// enter the distance to a point in it, rounding included. Only the sums of squares may differ, because
// compilers may fuse products and sums in one place and not in another: compare them with a slack of gamma(2
// D).
#pragma once

#include "geometry/triangle.hpp"

namespace treeline::geometry {

/// Squared distance to a box that is not empty; 0 inside.
template <class T, int D>
constexpr T distance2(const Vec<T, D>& p, const Box<T, D>& box) {
  Vec<T, D> gap;
  for (int i = 0; i < D; ++i) gap[i] = std::max(std::max(box.low[i] - p[i], p[i] - box.high[i]), T(0));
  return length2(gap);
}

template <class T>
struct ClosestOnTriangle {
  Vec<T, 3> point;
  int feature = 0;  ///< 0 the face, 1 edge ab, 2 edge bc, 3 edge ca, 4 corner a, 5 corner b, 6 corner c
  T distance2 = std::numeric_limits<T>::infinity();
};

namespace detail {
/// The powers of two between which a squared area (a length to the fourth) keeps all its digits, and so do
/// the squares of the edges.
template <class T>
inline constexpr T smallest_area2 = std::numeric_limits<T>::digits < 30 ? T(0x1p-80) : T(0x1p-640);
template <class T>
inline constexpr T largest_area2 = T(1) / smallest_area2<T>;

/// The square of the sine of the angle at corner a below which float looks at a triangle in double: its
/// normal is off by some u / sine, and the point nearest to one on the face by that much of an edge.
inline constexpr float thin_sine2 = 1.0f / 256;

template <class T>
ClosestOnTriangle<T> closest_on_extreme_triangle(const Vec<T, 3>& p, const Triangle<T>& triangle);
ClosestOnTriangle<float> closest_on_thin_triangle(const Vec<float, 3>& p, const Triangle<float>& triangle);
}  // namespace detail

/// The point of a triangle nearest to p.
/// Method: the nearest of four candidates, one on each edge and, where the triangle has an area and p
/// projects into it, one on the face. Every candidate is a point of the triangle, so that the answer stays an
/// upper bound whatever rounding does, and needles, segments and single points need no case of their own. A
/// triangle whose squared area could over- or underflow is looked at scaled by a power of two; one that is
/// thin at corner a is looked at in double, where a second step from the point found first takes back what
/// the first was off by along the triangle. Cost: about 90 operations and 4 divisions (Ericson 2005,
/// section 5.1.5, skips some of them but loses slivers); twice that for a triangle of no area, or a thin one
/// in float.
template <class T, bool extreme = false>
ClosestOnTriangle<T> closest_point_on_triangle(const Vec<T, 3>& p, const Triangle<T>& triangle) {
  const Vec<T, 3> ab = triangle.b - triangle.a, ac = triangle.c - triangle.a, normal = cross(ab, ac);
  const T area2 = length2(normal);
  if constexpr (!extreme)
    if (!(area2 >= detail::smallest_area2<T> && area2 <= detail::largest_area2<T>)) [[unlikely]]
      return detail::closest_on_extreme_triangle(p, triangle);
  if constexpr (std::is_same_v<T, float>)
    if (area2 < detail::thin_sine2 * length2(ab) * length2(ac)) [[unlikely]]
      return detail::closest_on_thin_triangle(p, triangle);

  // Here no corner is NaN, or the area were: no need to look out for it.
  const Box<T, 3> box = extreme ? triangle.box()
                                : Box<T, 3>{min(min(triangle.a, triangle.b), triangle.c),
                                            max(max(triangle.a, triangle.b), triangle.c)};
  ClosestOnTriangle<T> best{triangle.a, 4};
  const auto offer = [&](const Vec<T, 3>& point, int feature) {
    const Vec<T, 3> q = min(max(point, box.low), box.high);
    const T d2 = distance2(p, q);
    if (d2 < best.distance2) best = {q, feature, d2};
  };
  const auto offer_edge = [&](const Vec<T, 3>& from, const Vec<T, 3>& to, int edge, int from_corner,
                              int to_corner) {
    const Vec<T, 3> along = to - from;
    const T s = dot(p - from, along), whole = length2(along);
    if (!(s > T(0))) return offer(from, from_corner);
    if (!(s < whole)) return offer(to, to_corner);
    offer(from + along * (s / whole), edge);
  };
  offer_edge(triangle.a, triangle.b, 1, 4, 5);
  offer_edge(triangle.b, triangle.c, 2, 5, 6);
  offer_edge(triangle.c, triangle.a, 3, 6, 4);

  const Vec<T, 3> ap = p - triangle.a;
  if (area2 > T(0)) {
    T v = dot(cross(ap, ac), normal) / area2, w = dot(cross(ab, ap), normal) / area2;
    if constexpr (!std::is_same_v<T, float>)
      if (area2 < T(detail::thin_sine2) * length2(ab) * length2(ac)) [[unlikely]] {
        const Vec<T, 3> rest = p - (triangle.a + (ab * v + ac * w));
        v += dot(cross(rest, ac), normal) / area2, w += dot(cross(ab, rest), normal) / area2;
      }
    if (v > T(0) && w > T(0) && v + w < T(1)) offer(triangle.a + (ab * v + ac * w), 0);
  }
  return best;
}

namespace detail {
template <class T>
ClosestOnTriangle<T> closest_on_extreme_triangle(const Vec<T, 3>& p, const Triangle<T>& triangle) {
  const Box<T, 3> box = triangle.box();
  T edge = 0, reach = 0;  // in halves: nothing overflows
  for (int k = 0; k < 3; ++k) {
    edge = std::max(edge, box.high[k] / 2 - box.low[k] / 2);
    reach = std::max({reach, std::abs(p[k] / 2), std::abs(box.low[k] / 2), std::abs(box.high[k] / 2)});
  }
  if (!(edge > T(0))) return closest_point_on_triangle<T, true>(p, triangle);
  // Edges of about 1; from so far that offsets could overflow, less.
  constexpr int farthest = std::numeric_limits<T>::max_exponent / 2 - 8;
  const int shift = std::min(-std::ilogb(edge), farthest - std::ilogb(reach));
  const auto scaled = [](const Vec<T, 3>& v, int exponent) {
    return Vec<T, 3>{std::ldexp(v[0], exponent), std::ldexp(v[1], exponent), std::ldexp(v[2], exponent)};
  };
  auto best = closest_point_on_triangle<T, true>(
      scaled(p, shift), {scaled(triangle.a, shift), scaled(triangle.b, shift), scaled(triangle.c, shift)});
  best.point = min(max(scaled(best.point, -shift), box.low), box.high);
  best.distance2 = distance2(p, best.point);
  return best;
}

/// The point is the nearest of the triangle but for its own rounding, by which it stays in the triangle's
/// box.
[[gnu::noinline]] inline ClosestOnTriangle<float> closest_on_thin_triangle(const Vec<float, 3>& p,
                                                                           const Triangle<float>& triangle) {
  const auto wide = closest_point_on_triangle(Vec<double, 3>(p), Triangle<double>(triangle));
  const Vec<float, 3> point(wide.point);
  return {point, wide.feature, distance2(p, point)};
}
}  // namespace detail

}  // namespace treeline::geometry
