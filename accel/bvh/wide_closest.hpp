// One point's distances to what a wide tree over triangles holds: to the boxes of a node, and to the
// triangles of a leaf, with bounds on what float may have done to them.
//
// Triangles, without a branch: the nearest points of three segments, and a point of the face; every one of
// them is a point of the triangle whatever rounding did, so that the least distance is never below the true
// one but by the roundings of measuring it. How far it may be above, and what follows for the search, is
// derived here, with u = 2^-24, d the true distance, a, b, c the corners, L² = max(|ab|², |ac|²):
//   Measuring. The vector from the point of the triangle to p is off by u (|p - a| + 2 · 2 L + |p - a - …| +
//   |the vector|) <= u (3 d + 8 L), by 3 u d more where the mesh was moved (see `off`), its square by 3 u of
//   itself. In squares, by 2 d u (4.5 d + 8 L) <= u (10 d² + 64 L²), or 16 d² where moved.
//   Segments. The parameter is off by 11 u |p - a| / |ab|, along the segment: second order, 121 u² |p - a|².
//   Face. The foot of p's perpendicular is off by at most t = 36 u k |p - a|, k = |ab| |ac| / |n|: 5.7 u k
//   for the tilt of the normal n and as much for its length, 12 u k for each of the two weights (two cross
//   products of 5.7 u |x| |y| and two dot products of 3 u). Held in the triangle, it is a point at most t
//   from the true foot or from the border beside it, so that the squared distance grows by at most t² <= 2
//   (36 u k)² (d² + L²); for k <= 128 that is 2.6 u (d² + L²). Slivers, k > 128. No point of a triangle is
//   farther from its longest side than its height there, h = |n| / longest side, and that point of the side
//   is as near to p as d² + h², h² <= min(|ab|², |ac|²) / k².
// So the squared distance found lies within `error` = u (14 d² + 72 L²), 20 d² where moved, of the true one,
// but for slivers, where it may be above by min(|ab|², |ac|²) / 2^14 more. Where squares of areas are so
// small that underflow took their digits, 1 takes the place of 2^14. Sources: the segments and the plane are
// Eberly's candidates ("Distance between point and triangle in 3D"); the bounds are our own.
#pragma once

#include "accel/bvh/wide_ray.hpp"

namespace treeline::accel::wide {

/// Coordinates and queries up to here have squared areas within float's range.
inline constexpr float closest_reach = 0x1p28f;
/// Slack of a squared distance to a box, relative: gaps are off by u, by 3 u more where moved, twice, and
/// three squares sum with 3 u; 16 covers the 11, and the comparison.
inline constexpr float box_distance_slack = 16 * geometry::tolerance::unit_roundoff<float>;

/// Squared distances between a box, or a point that is one, and the boxes whose planes along an axis
/// plane(axis, high) gives.
template <int N, class Plane>
[[gnu::always_inline]] inline simd::Floats<N> distance2_to_boxes(const geometry::Vec<float, 3>& low,
                                                                 const geometry::Vec<float, 3>& high,
                                                                 Plane&& plane) {
  using F = simd::Floats<N>;
  F sum;
  for (int k = 0; k < 3; ++k) {
    const F gap =
        max(max(plane(k, 0) - F::broadcast(high[k]), F::broadcast(low[k]) - plane(k, 1)), F::broadcast(0));
    sum = k == 0 ? gap * gap : sum + gap * gap;
  }
  return sum;
}

/// Some queries' box in the tree's space. Rounding is monotonic: no box is found farther from it than from
/// any of them.
struct ClosestPlaces {
  geometry::Box<float, 3> box;

  /// Squared distances to the boxes whose planes along an axis plane(axis, high) gives.
  template <int N, class Plane>
  [[gnu::always_inline]] simd::Floats<N> to_boxes(Plane&& plane) const {
    return distance2_to_boxes<N>(box.low, box.high, plane);
  }
};

template <class F>
struct Lanes3 {
  F v[3];
  friend Lanes3 operator-(const Lanes3& a, const Lanes3& b) {
    return {{a.v[0] - b.v[0], a.v[1] - b.v[1], a.v[2] - b.v[2]}};
  }
  friend Lanes3 operator+(const Lanes3& a, const Lanes3& b) {
    return {{a.v[0] + b.v[0], a.v[1] + b.v[1], a.v[2] + b.v[2]}};
  }
  friend Lanes3 operator*(const Lanes3& a, const F& s) { return {{a.v[0] * s, a.v[1] * s, a.v[2] * s}}; }
  friend F dot(const Lanes3& a, const Lanes3& b) {
    return a.v[0] * b.v[0] + a.v[1] * b.v[1] + a.v[2] * b.v[2];
  }
  friend Lanes3 cross(const Lanes3& a, const Lanes3& b) {
    return {{a.v[1] * b.v[2] - a.v[2] * b.v[1], a.v[2] * b.v[0] - a.v[0] * b.v[2],
             a.v[0] * b.v[1] - a.v[1] * b.v[0]}};
  }
};

/// The query in the tree's space, in float.
class ClosestPlace {
 public:
  /// moved: whether the tree's space is not the user's, so that p carries a rounding. That is at most u |p|
  /// along an axis, and along an axis where it is not 0 the mesh is at least |p| / 3 away: the tree's origin
  /// is in the middle of an interval [x, y] with y <= 2 x, and differences of numbers within a factor of two
  /// are exact (Sterbenz 1974).
  ClosestPlace(const geometry::Vec<float, 3>& p, bool moved)
      : p_(p), of_square_((moved ? 20 : 14) * unit), of_edge_(72 * unit) {}

  const geometry::Vec<float, 3>& point() const { return p_; }

  /// Squared distances to the boxes whose planes along an axis plane(axis, high) gives.
  template <int N, class Plane>
  [[gnu::always_inline]] simd::Floats<N> to_boxes(Plane&& plane) const {
    return distance2_to_boxes<N>(p_, p_, plane);
  }

  /// For each triangle of a leaf: bounds on the squared distance. Lanes of `gone` do not count.
  template <int N>
  struct Bounds {
    simd::Floats<N> low, high;
    std::uint32_t slivers, lost;  // bits: low is to be lower, by `room` / 2^14 or all of `room`
    simd::Floats<N> room;

    /// Bits of triangles that may be as near as `limit`.
    [[gnu::always_inline]] std::uint32_t within(float limit) const {
      using F = simd::Floats<N>;
      const F most = F::broadcast(limit);
      std::uint32_t bits = bits_le(low, most);
      if (slivers != 0) [[unlikely]] {
        bits |= slivers & bits_le(low - room * F::broadcast(sliver_room), most);
        if (lost != 0) bits |= lost & bits_le(low - room, most);
      }
      return bits;
    }
    /// The lower bound of one that is a sliver.
    float sliver_low(std::uint32_t lane) const {
      alignas(64) float x[N];
      (low - room * simd::Floats<N>::broadcast((lost >> lane & 1) != 0 ? 1.0f : sliver_room)).store(x);
      return x[lane];
    }
  };
  template <int N>
  [[gnu::always_inline]] Bounds<N> to_triangles(const RayLeaf<N>& leaf) const {
    using F = simd::Floats<N>;
    using V = Lanes3<F>;
    const auto corner = [&](int i) {
      return V{{F::load(leaf.corner[i][0]), F::load(leaf.corner[i][1]), F::load(leaf.corner[i][2])}};
    };
    const V a = corner(0), b = corner(1), c = corner(2);
    const V p{{F::broadcast(p_[0]), F::broadcast(p_[1]), F::broadcast(p_[2])}};
    const F zero = F::broadcast(0), one = F::broadcast(1);
    // What is not a number, 0 / 0, becomes 0: max and min give their second where either is.
    const auto held = [&](const F& x) { return min(max(x, zero), one); };
    const V ab = b - a, ac = c - a, bc = c - b, pa = p - a, pb = p - b;
    const F ab2 = dot(ab, ab), ac2 = dot(ac, ac);
    const auto from_segment = [&](const V& to_p, const V& along, const F& whole)
        __attribute__((always_inline)) {
      const V r = to_p - along * held(dot(to_p, along) / whole);
      return dot(r, r);
    };
    const F to_edges =
        min(min(from_segment(pa, ab, ab2), from_segment(pa, ac, ac2)), from_segment(pb, bc, dot(bc, bc)));
    const V n = cross(ab, ac);
    const F n2 = dot(n, n), per_n2 = one / n2;
    const F v = held(dot(cross(pa, ac), n) * per_n2);
    const F w = min(max(dot(cross(ab, pa), n) * per_n2, zero), one - v);
    const V r = pa - ab * v - ac * w;
    const F found = min(dot(r, r), to_edges);
    const F error = found * F::broadcast(of_square_) + max(ab2, ac2) * F::broadcast(of_edge_) +
                    F::broadcast(smallest_square);
    Bounds<N> bounds;
    bounds.low = found - error, bounds.high = found + error;
    const F limit = ab2 * ac2 * F::broadcast(1.0f / (largest_k * largest_k));
    bounds.slivers = bits_lt(n2, max(limit, F::broadcast(smallest_area2)));
    bounds.lost = bits_lt(n2, F::broadcast(smallest_area2));
    bounds.room = min(ab2, ac2);
    return bounds;
  }

 private:
  static constexpr float unit = geometry::tolerance::unit_roundoff<float>;
  static constexpr float largest_k = 128, sliver_room = 1.02f / (largest_k * largest_k);
  /// Below, the squares of areas may have lost digits to underflow: those of edges of some 2^-30.
  static constexpr float smallest_area2 = 0x1p-120f;
  /// Squared distances below may have lost digits: of 2^-60 and less.
  static constexpr float smallest_square = 0x1p-116f;

  geometry::Vec<float, 3> p_;
  float of_square_, of_edge_;
};

/// Place: ClosestPlace or ClosestPlaces.
template <int N, class Place>
[[gnu::always_inline]] inline BoxHits<N> near(const RayNode<N>& node, const Place& place, float limit) {
  const auto d2 =
      place.template to_boxes<N>([&](int k, int high) { return simd::Floats<N>::load(node.plane[k][high]); });
  return {d2, bits_le(d2, simd::Floats<N>::broadcast(limit))};
}

}  // namespace treeline::accel::wide
