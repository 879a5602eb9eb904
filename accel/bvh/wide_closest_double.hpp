// The points of up to eight triangles nearest to a point, or each to one of its own, in double, whatever
// triangles they are.
//
// The candidates of geometry::closest_point_on_triangle (one on each edge, and one on the face where the
// point projects into it), eight triangles side by side and nothing fused, so that all instruction sets find
// the same bits. Error of a squared distance: as derived in wide_closest.hpp with double's u, and for slivers
// the lesser of t² and h². Cost: some 50 ns a call.
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>

#include "accel/bvh/wide_closest.hpp"
#include "accel/simd/lanes.hpp"
#include "geometry/rounding.hpp"
#include "geometry/triangle.hpp"

namespace treeline::accel::wide {

class EightClosest {
 public:
  static constexpr int most = 8;
  using Triangle = geometry::Triangle<double>;
  using Point = geometry::Vec<double, 3>;

  int size() const { return size_; }
  bool full() const { return size_ == most; }
  void clear() { size_ = 0; }
  template <int N>
  void add(const RayLeaf<N>& leaf, std::uint32_t lane) {
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k < 3; ++k) corner_[i][k][size_] = static_cast<double>(leaf.corner[i][k][lane]);
    id_[size_++] = leaf.id[lane];
  }

  using Lane = simd::Lanes<double>;

  void measure(const Point& point) {
    measure([&](int k) { return Lane::broadcast(point[k]); });
  }
  /// Each from a point of its own: coordinate(k) are those of the eight along an axis.
  template <class Coordinate>
  requires std::invocable<Coordinate, int>
  void measure(Coordinate&& coordinate) {
    std::fill_n(feature_, size_, unknown);
    using F = Lane;
    using V = Lanes3<F>;
    // What is in the lanes beyond is measured along, and not looked at. One alone, the most frequent number,
    // is in all of them.
    if (size_ > 1)
      for (int i = size_; i < most; ++i)
        for (auto& rows : corner_)
          for (auto& row : rows) row[i] = 0;
    const auto row = [&](int i, int k) {
      return size_ == 1 ? F::broadcast(corner_[i][k][0]) : F::load(corner_[i][k]);
    };
    const auto corner = [&](int i) { return V{{row(i, 0), row(i, 1), row(i, 2)}}; };
    const V a = corner(0), b = corner(1), c = corner(2);
    const V p{{coordinate(0), coordinate(1), coordinate(2)}};
    const F zero = F::broadcast(0), one = F::broadcast(1);
    const V ab = b - a, bc = c - b, ca = a - c, pa = p - a, pb = p - b, pc = p - c;
    const F ab2 = dot(ab, ab), bc2 = dot(bc, bc), ca2 = dot(ca, ca);
    const auto from_edge = [&](int edge, const V& to_p, const V& along, const F& whole, const V& from_end) {
      const F along_p = dot(to_p, along);
      // 0 / 0, of an edge without a length, becomes 0.
      const F s = min(max(along_p / whole, zero), one);
      along_p.store(along_[edge]), whole.store(edge2_[edge]), dot(to_p, to_p).store(corner2_[edge]);
      const V r = to_p - along * s;
      // An end is the corner itself.
      const F d2 = chosen(one <= s, dot(from_end, from_end), dot(r, r));
      s.store(share_[edge]);
      d2.store(distance2_[edge]);
      return d2;
    };
    const F d_ab = from_edge(0, pa, ab, ab2, pb), d_bc = from_edge(1, pb, bc, bc2, pc),
            d_ca = from_edge(2, pc, ca, ca2, pa);
    const V ac = c - a, n = cross(ab, ac);
    const F n2 = dot(n, n);
    const F v = dot(cross(pa, ac), n) / n2, w = dot(cross(ab, pa), n) / n2;
    const V r = pa - ab * v - ac * w;
    const auto inside = (zero < v) & (zero < w) & (v + w < one);  // no: where either is NaN
    const F d_face = chosen(inside, dot(r, r), F::broadcast(std::numeric_limits<double>::infinity()));
    v.store(share_[3]), w.store(share_[4]), d_face.store(distance2_[3]);
    min(min(d_ab, d_bc), min(d_ca, d_face)).store(least_);
    n2.store(n2_);
  }

  Id id(int i) const { return id_[i]; }
  double distance2(int i) const { return least_[i]; }
  Triangle triangle(int i) const {
    const auto corner = [&](int j) { return Point{corner_[j][0][i], corner_[j][1][i], corner_[j][2][i]}; };
    return {corner(0), corner(1), corner(2)};
  }
  /// What was measured lies at most `above` over the true squared distance, and `below` under it.
  void error(int i, double& above, double& below) const {
    constexpr double u = geometry::tolerance::unit_roundoff<double>;
    const double shorter = std::min(edge2_[0][i], edge2_[2][i]),
                 longer = std::max(edge2_[0][i], edge2_[2][i]);
    below = u * (20 * least_[i] + 72 * longer) + 0x1p-1000;
    // t² and h²; |n| itself is off by 6 u |ab| |ac|.
    const double t2 = 36 * u * 36 * u * (shorter / n2_[i]) * longer * corner2_[0][i],
                 h2 = 2 * (n2_[i] / longer + 36 * u * u * shorter);
    above = below + (t2 < h2 ? t2 : h2 > 0 ? h2 : 0);
  }
  /// The feature that is nearest, as in geometry::exact_feature, if the signs that tell are beyond doubt;
  /// else -1. A dot product is off by 8 u of its factors' lengths (5 u, and 3 u for p), which is doubled; a
  /// weight by 30 u k |p - a| |ac| / |n|, or |ab|, likewise.
  int certain_feature(int i) const {
    if (feature_[i] == unknown) feature_[i] = find_certain_feature(i);
    return feature_[i];
  }
  /// Whether two are nearest, for certain, in a corner or an edge that they share.
  bool share_feature(int i, int j) const {
    const int f = certain_feature(i), g = certain_feature(j);
    const auto same = [&](int m, int n) {
      for (int k = 0; k < 3; ++k)
        if (corner_[m][k][i] != corner_[n][k][j]) return false;
      return true;
    };
    if (f >= 4 && g >= 4) return same(f - 4, g - 4);
    if (f < 1 || g < 1 || f > 3 || g > 3) return false;
    return (same(f - 1, g - 1) && same(f % 3, g % 3)) || (same(f - 1, g % 3) && same(f % 3, g - 1));
  }
  /// The nearest point and where on the triangle it lies; of features as near the first in the order of
  /// ClosestOnTriangle's candidates.
  Feature nearest(int i, Point& point) const {
    int f = 0;
    for (int j = 1; j < 4; ++j)
      if (distance2_[j][i] < distance2_[f][i]) f = j;
    const Triangle t = triangle(i);
    const Point* const corners[] = {&t.a, &t.b, &t.c};
    const auto times = [](const Point& x, double s) {
      return Point{geometry::rounded(x[0] * s), geometry::rounded(x[1] * s), geometry::rounded(x[2] * s)};
    };
    if (f == 3) {
      point = t.a + (times(t.b - t.a, share_[3][i]) + times(t.c - t.a, share_[4][i]));
      return Feature::face;
    }
    const int next = (f + 1) % 3;
    const double s = share_[f][i];
    if (s <= 0 || s >= 1) {
      const int corner = s <= 0 ? f : next;
      point = *corners[corner];
      return static_cast<Feature>(static_cast<int>(Feature::vertex_a) + corner);
    }
    point = *corners[f] + times(*corners[next] - *corners[f], s);
    return static_cast<Feature>(static_cast<int>(Feature::edge_ab) + f);
  }

 private:
  int find_certain_feature(int i) const {
    constexpr double u = geometry::tolerance::unit_roundoff<double>, doubt2 = 16 * u * 16 * u;
    // Where p projects on each edge's line: before its start, behind its end; 0 where that is in doubt.
    int start[3], end[3];
    for (int j = 0; j < 3; ++j) {
      const double whole = edge2_[j][i], out = along_[j][i], past = out - whole, to_p = corner2_[j][i];
      start[j] = out * out > doubt2 * (to_p * whole) ? (out < 0 ? -1 : 1) : 0;
      end[j] = past * past > 2 * doubt2 * whole * (to_p + whole) ? (past < 0 ? -1 : 1) : 0;
    }
    for (int j = 0; j < 3; ++j)
      if (start[j] < 0 && end[(j + 2) % 3] > 0) return 4 + j;
    const double v = share_[3][i], w = share_[4][i], ab2 = edge2_[0][i], ac2 = edge2_[2][i];
    const double doubt = 64 * u * std::sqrt(ab2 * ac2 * corner2_[0][i]) / n2_[i];
    const double of_v = doubt * std::sqrt(ac2), of_w = doubt * std::sqrt(ab2), of_rest = of_v + of_w + 8 * u;
    const double rest = 1 - v - w;
    if (v > of_v && w > of_w && rest > of_rest) return 0;
    // Beside an edge, and on the outer side of it: of one edge at most.
    const bool outer[3] = {w < -of_w, rest < -of_rest * (1 + std::abs(v) + std::abs(w)), v < -of_v};
    for (int j = 0; j < 3; ++j)
      if (outer[j] && start[j] > 0 && end[j] < 0) return 1 + j;
    return -1;
  }

  static constexpr int unknown = -2;

  int size_ = 0;
  mutable int feature_[most];  // as found, certain or not, or unknown
  alignas(64) double corner_[3][3][most];
  Id id_[most];
  alignas(64) double distance2_[4][most];  // to ab, bc, ca, and the face, infinite where not above it
  alignas(64) double share_[5][most];      // along the edges; weights of b and c
  alignas(64) double least_[most], n2_[most];
  // Of each edge: the dot product with p, from its beginning, its squared length, and p's squared distance
  // from its beginning.
  alignas(64) double along_[3][most], edge2_[3][most], corner2_[3][most];
};

}  // namespace treeline::accel::wide
