// One ray on its way through a tree: the leaf test, and the nearest hit so far.
//
// Problem: trees prune by where cells are, so a hit must be where its triangle is, or its tree would lose it.
// The t of a needle or of a triangle seen edge-on comes from cancelling terms and may lie far from the
// triangle. Method: a hit that the ray test accepts is settled: its point on the ray and its point on the
// triangle must agree within hit_slack. Where they do not (rare), the ray's nearest approach to the triangle
// is found in wider arithmetic and takes its place, or, if even that is farther away, the hit was false.
// Hence every hit of every tree, brute force included, is within hit_slack of its triangle, and a traversal
// with that slack finds exactly the hits that brute force finds. What is a hit depends on the ray and the
// triangle alone, never on what else is in the tree. Ties in t go to the lower id.
//
// Leaves are tested eight triangles at a time (leaf_filter.hpp); what remains goes through the ray test
// proper. All trees call the same function for that, never inlined: the compiler may contract products and
// sums differently where it inlines, and answers would differ in their last bit. Cost: the ray test, and
// about 40 operations per accepted hit.
#pragma once

#include <bit>

#include "accel/concepts.hpp"
#include "accel/leaf_filter.hpp"
#include "accel/padded_ray.hpp"
#include "accel/triangle_leaves.hpp"

namespace treeline::accel {

namespace detail {
template <class T>
struct WiderType {
  using Type = double;
};
template <>
struct WiderType<double> {
  using Type = long double;
};

/// The triangle's point nearest to the line of a ray, in W; t is where the line passes it.
template <class W, class T>
geometry::TriangleHit<T> nearest_approach(const geometry::Ray<T>& ray,
                                          const geometry::Triangle<T>& triangle) {
  using V = geometry::Vec<W, 3>;
  const V origin(ray.origin), d(ray.direction);
  const V corner[3] = {V(triangle.a) - origin, V(triangle.b) - origin, V(triangle.c) - origin};
  const V ab = corner[1] - corner[0], ac = corner[2] - corner[0], normal = cross(ab, ac);
  const W across = dot(normal, d), area2 = length2(normal);
  if (across != W(0)) {
    const W t = dot(normal, corner[0]) / across;
    const V from_a = d * t - corner[0];
    const W u = dot(cross(from_a, ac), normal) / area2, v = dot(cross(ab, from_a), normal) / area2;
    if (u >= W(0) && v >= W(0) && u + v <= W(1)) return {T(t), T(u), T(v)};
  }
  const W speed2 = length2(d);
  const auto beside = [&](const V& p) { return p - d * (dot(p, d) / speed2); };
  W best = std::numeric_limits<W>::infinity(), weight[3] = {1, 0, 0}, t = 0;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    const V edge = corner[j] - corner[i], p = beside(corner[i]), e = beside(edge);
    const W whole = length2(e);
    const W s = whole > W(0) ? std::clamp(-dot(p, e) / whole, W(0), W(1)) : W(0);
    const W gap = length2(p + e * s);
    if (!(gap < best)) continue;
    best = gap;
    weight[i] = W(1) - s, weight[j] = s, weight[(i + 2) % 3] = W(0);
    t = dot(corner[i] + edge * s, d) / speed2;
  }
  return {T(t), T(weight[1]), T(weight[2])};
}
}  // namespace detail

template <class Primitives>
class RayQuery {
 public:
  using T = typename Primitives::Scalar;
  using Ray = geometry::Ray<T>;
  using Stored = StoredTriangle<T>;

  /// `centre` is the tree's.
  RayQuery(const Ray& ray, const geometry::Vec<T, 3>& centre)
      : ray_(ray),
        reach_(reach_of(centre, {ray.origin, ray.origin})),
        padded_(ray, reach_),
        filter_(ray),
        test_(ray),
        limit_(ray.t_max) {}

  const Ray& ray() const { return ray_; }
  /// How far the origin is from the tree's centre, along an axis.
  T reach() const { return reach_; }
  const PaddedRay<T>& padded() const { return padded_; }
  /// Nothing beyond is of interest.
  T limit() const { return limit_; }
  const Hit<T>& hit() const { return best_; }
  /// The triangle hit, as the tree keeps it; null if none.
  const Stored* stored() const { return best_ ? &stored_ : nullptr; }

  /// Tests the leaf of count triangles that begins at reference `first`. True when the query is answered: at
  /// the first hit, if `any`.
  template <bool any>
  [[gnu::noinline]] bool test(const TriangleLeaves<T>& leaves, std::size_t first, std::size_t count) {
    const T* rows = leaves.rows(first);
    for (std::size_t begin = 0; begin < count; begin += 8) {
      std::uint32_t left = filter_(rows + begin, count);
      if (count - begin < 8) left &= (1u << (count - begin)) - 1;
      for (; left != 0; left &= left - 1) {
        const Stored candidate =
            leaves.get(first, count, begin + static_cast<std::size_t>(std::countr_zero(left)));
        if (const auto raw = test_(candidate.triangle, ray_.t_min, ray_.t_max)) {
          if (offer(candidate, *raw) && any) return true;
        }
      }
    }
    return false;
  }

 private:
  bool offer(const Stored& candidate, geometry::TriangleHit<T> hit) {
    if (!on_both(candidate.triangle, hit)) {
      hit = detail::nearest_approach<typename detail::WiderType<T>::Type>(ray_, candidate.triangle);
      if (!(ray_.t_min <= hit.t && hit.t <= ray_.t_max) || !on_both(candidate.triangle, hit)) return false;
    }
    if (hit.t > limit_ || (hit.t == best_.t && candidate.id > best_.primitive)) return false;
    best_ = {hit.t, candidate.id, hit.u, hit.v};
    stored_ = candidate;
    limit_ = hit.t;
    return true;
  }

  bool on_both(const geometry::Triangle<T>& triangle, const geometry::TriangleHit<T>& hit) const {
    const T slack = geometry::tolerance::hit_slack<T> * reach_of(ray_.origin, triangle.box()) +
                    std::numeric_limits<T>::min();
    const auto from_origin = triangle.a - ray_.origin;
    const auto on_triangle =
        from_origin + (triangle.b - triangle.a) * hit.u + (triangle.c - triangle.a) * hit.v;
    for (int k = 0; k < 3; ++k)
      if (!(std::abs(on_triangle[k] - ray_.direction[k] * hit.t) <= slack)) return false;
    return true;
  }

  Ray ray_;
  T reach_;
  PaddedRay<T> padded_;
  LeafFilter<typename Primitives::Test, T> filter_;
  typename Primitives::Test::template Prepared<T> test_;
  T limit_;
  Hit<T> best_;
  Stored stored_{};
};

}  // namespace treeline::accel
