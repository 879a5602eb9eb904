// One ray on its way through the wide tree over triangles: the boxes of a node, then what is nearest.
//
// All boxes of a node take the slab test at once, the padding that makes it conservative folded into two
// constants a ray and axis (Ize 2013; see padded_ray.hpp); children are visited in order of distance. Leaves
// are tested as a policy says (wide_woop.hpp, wide_exact.hpp). Nothing fuses, so all instruction sets answer
// the same, and the answer is that of the tests whatever the layout: the least t, of equals the lowest id.
#pragma once

#include "accel/bvh/wide_triangle_layout.hpp"
#include "geometry/ray.hpp"
#include "geometry/tolerances.hpp"

namespace treeline::accel::wide {

/// Slack of a plane crossing, relative to the reach (see reach_of()): the sheared corner of a triangle is off
/// by 6 u of the reach along an axis, the crossing by 3 u, both with room to spare.
inline constexpr float box_slack = 12 * geometry::tolerance::unit_roundoff<float>;

/// What the box test needs of a ray. With slack as above and reach, the largest distance along an axis from
/// the ray's origin to a side of all boxes.
template <class Layout>
struct BoxRay {
  alignas(16) float enter_from[4], exit_from[4], inverse[4];
  std::uint32_t near_plane[3];  // bytes from the first plane of a node; the far one is at near ^ row
  float t_min, reach;
  static constexpr std::uint32_t row = Layout::plane_bytes;

  /// For a ray that is moved by -centre.
  BoxRay(const geometry::Ray<float>& ray, const geometry::Vec<float, 3>& centre,
         const geometry::Box<float, 3>& bounds)
      : t_min(ray.t_min) {
    static_assert(sizeof(geometry::Ray<float>) == 32 && sizeof(geometry::Box<float, 3>) == 24);
    using F = simd::Floats4;
    constexpr float u = geometry::tolerance::unit_roundoff<float>;
    // The lanes to spare hold a component of the direction, and t_min.
    // Read where the user wrote them: a copy made of smaller pieces could not be forwarded to the loads.
    const F origin = F::load(ray.origin.v) - F::load(centre.v);
    const F direction = F::load(ray.direction.v);
    const F low = F::load(bounds.low.v), high = F::load(&bounds.low.v[2]).rotated();  // low[2] goes last
    alignas(16) float far[4];
    max(absolute(low - origin), absolute(high - origin)).store(far);
    reach = std::max({far[0], far[1], far[2]});
    const float slack = box_slack * reach + std::numeric_limits<float>::min();
    // 3 u |origin|: the sums below round by at most u |origin|.
    const F padding = absolute(origin) * F::broadcast(3 * u) + F::broadcast(slack);
    F above = origin + padding, below = origin - padding;
    const F reciprocal = F::broadcast(1) / direction;
    reciprocal.store(inverse);
    where_negative(direction, below, above).store(enter_from);
    where_negative(direction, above, below).store(exit_from);
    const std::uint32_t backward = sign_bits(direction);
    for (std::uint32_t k = 0; k < 3; ++k) near_plane[k] = k * 2 * row + (backward >> k & 1) * row;
    // A quotient that is not accurate: this axis never excludes. A zero does, by infinities of either sign.
    alignas(16) float size[4];
    absolute(reciprocal).store(size);
    if (!(std::max({size[0], size[1], size[2]}) < infinity) ||
        std::min({size[0], size[1], size[2]}) < std::numeric_limits<float>::min())
      forget_inaccurate(ray);
  }

 private:
  [[gnu::noinline, gnu::cold]] void forget_inaccurate(const geometry::Ray<float>& ray) {
    constexpr float most = std::numeric_limits<float>::max();
    for (int k = 0; k < 3; ++k)
      if (ray.direction[k] != 0 && !std::isnormal(inverse[k])) {
        // Farther than any box, but not than the planes of an absent child.
        enter_from[k] = near_plane[k] & row ? -most : most;
        exit_from[k] = -enter_from[k];
      }
  }
};

/// Where the ray enters the boxes of a node, and one bit for each that it meets before `limit`.
template <int N>
struct BoxHits {
  simd::Floats<N> enter;
  std::uint32_t bits;
};
/// plane(k, offset): the planes along axis k that lie so many bytes from the first.
template <class Layout, class Plane>
[[gnu::always_inline]] inline BoxHits<Layout::width> meet_planes(Plane&& plane, const BoxRay<Layout>& ray,
                                                                 float limit) {
  using F = simd::Floats<Layout::width>;
  F enter[3], exit[3];
  for (int k = 0; k < 3; ++k) {
    const F inverse = F::broadcast(ray.inverse[k]);
    enter[k] = (plane(k, ray.near_plane[k]) - F::broadcast(ray.enter_from[k])) * inverse;
    exit[k] = (plane(k, ray.near_plane[k] ^ ray.row) - F::broadcast(ray.exit_from[k])) * inverse;
  }
  // What is not a number (0 times infinity) falls out, and at most another bound with it: that never narrows.
  const F first = max(max(enter[0], enter[1]), max(enter[2], F::broadcast(ray.t_min)));
  const F last = min(min(exit[0], exit[1]), min(exit[2], F::broadcast(limit)));
  return {first, bits_le(first, last)};
}
template <class Layout, int N>
[[gnu::always_inline]] inline BoxHits<N> meet(const RayNode<N>& node, const BoxRay<Layout>& ray,
                                              float limit) {
  const auto* planes = reinterpret_cast<const unsigned char*>(node.plane);
  return meet_planes(
      [&](int, std::uint32_t offset) {
        return simd::Floats<N>::load(reinterpret_cast<const float*>(planes + offset));
      },
      ray, limit);
}

/// The nearest hit so far.
template <class Layout>
struct NearestHit {
  float t;  // nothing beyond is of interest
  Id id = no_id;
  const typename Layout::Leaf* leaf = nullptr;
  std::uint32_t lane = 0;
};

/// True if something was hit that is nearer than `best`, or as near with a lower id; `any`: just anything.
template <class Layout, bool any, class Test>
[[gnu::always_inline]] inline bool try_leaf(const Line* lines, Ref ref, const Test& test,
                                            NearestHit<Layout>& best) {
  const typename Layout::Leaf& stored = leaf_at<Layout>(lines, ref);
  const auto& leaf = Layout::triangles(stored);
  alignas(32) float t[Layout::leaf_size];
  std::uint32_t bits = test.hits(leaf, best.t, t);
  if (any || bits == 0) return bits != 0;
  bool found = false;
  for (; bits != 0; bits &= bits - 1) {
    const auto lane = static_cast<std::uint32_t>(std::countr_zero(bits));
    if (t[lane] > best.t || (t[lane] == best.t && leaf.id[lane] >= best.id)) continue;
    best = {t[lane], leaf.id[lane], &stored, lane};
    found = true;
  }
  return found;
}

// ---- traversal -----------------------------------------------------------------------------------------

/// Children that wait, the nearest of a node on top.
template <class Layout>
struct RayStack {
  /// Two places below the first are never taken off, so that there is always something to ask for ahead.
  static constexpr int bottom = 2;
  alignas(64) std::uint32_t key[ray_stack_size<Layout>];
  Ref ref[ray_stack_size<Layout>];
  int height;

  void clear(Ref root) { height = bottom, ref[0] = ref[1] = root; }
  bool empty() const { return height == bottom; }
};

/// A key that is not below any key of what the limit does not rule out.
template <class Layout>
std::uint32_t key_of(float limit) {
  return std::bit_cast<std::uint32_t>(std::max(limit, 0.0f)) | (Layout::width - 1u);
}

/// The child to go on with; the others that were met wait, the nearest on top. One is the most frequent
/// number, and known early: a ray that stands alone is better off with a branch. For any other number it is
/// not, since branches mispredicted cost more than the exchanges that they save.
template <bool branches, class Layout>
[[gnu::always_inline]] inline Ref descend(const typename Layout::Node& node,
                                          const BoxHits<Layout::width>& hits, RayStack<Layout>& stack) {
  if (branches && (hits.bits & (hits.bits - 1)) == 0)
    return Layout::child(node, static_cast<std::uint32_t>(std::countr_zero(hits.bits)));
  const simd::Keys<Layout::width> keys(hits.enter, hits.bits);
  const auto& children = Layout::children(node);
  keys.write_sorted(children, stack.key + stack.height, stack.ref + stack.height);
  stack.height += std::popcount(hits.bits) - 1;
  return children[keys.nearest()];
}

template <class Layout, class Test, class W>
void closest(const Line* lines, Ref root, const BoxRay<Layout>& ray, const Test& test,
             NearestHit<Layout>& best, W& work) {
  RayStack<Layout> stack;
  stack.clear(root);
  Ref ref = root;
  std::uint32_t limit = key_of<Layout>(best.t);
  for (;;) {
    if (!is_leaf(ref)) {
      work.node();
      const auto& node = node_at<Layout>(lines, ref);
      const auto hits = meet(node, ray, best.t);
      if (hits.bits != 0) {
        ref = descend<true, Layout>(node, hits, stack);
        // What is likely to be next but one: 5 to 15 % on rays that go anywhere, nothing lost on others.
        prefetch<Layout>(lines, stack.ref[stack.height - 1]);
        prefetch<Layout>(lines, stack.ref[stack.height - 2]);
        continue;
      }
    } else {
      work.primitive(Layout::leaf_size);
      if (try_leaf<Layout, false>(lines, ref, test, best)) limit = key_of<Layout>(best.t);
    }
    do {
      if (stack.empty()) return;
      --stack.height;
    } while (stack.key[stack.height] > limit);
    ref = stack.ref[stack.height];
  }
}

/// Calls visit(leaf, id, lane, t) for every triangle hit up to t_max, in no particular order.
template <class Layout, class Test, class Visit>
void all(const Line* lines, Ref root, const BoxRay<Layout>& ray, const Test& test, float t_max,
         Visit&& visit) {
  Ref stack[ray_stack_size<Layout>];
  stack[0] = root;
  for (int height = 1; height > 0;) {
    const Ref ref = stack[--height];
    if (!is_leaf(ref)) {
      const auto& node = node_at<Layout>(lines, ref);
      height += simd::store_chosen<Layout::width>(meet(node, ray, t_max).bits, Layout::children(node),
                                                  stack + height);
      continue;
    }
    const typename Layout::Leaf& stored = leaf_at<Layout>(lines, ref);
    const auto& leaf = Layout::triangles(stored);
    alignas(32) float t[Layout::leaf_size];
    for (std::uint32_t bits = test.hits(leaf, t_max, t); bits != 0; bits &= bits - 1) {
      const auto lane = static_cast<std::uint32_t>(std::countr_zero(bits));
      if (lane == 0 || leaf.id[lane] != leaf.id[lane - 1]) visit(stored, leaf.id[lane], lane, t[lane]);
    }
  }
}

template <class Layout, class Test, class W>
bool any(const Line* lines, Ref root, const BoxRay<Layout>& ray, const Test& test, float t_max, W& work) {
  Ref stack[ray_stack_size<Layout>];
  stack[0] = root;  // never taken off: always something to ask for ahead
  int height = 1;
  NearestHit<Layout> best{t_max};
  Ref ref = root;
  for (;;) {
    if (!is_leaf(ref)) {
      work.node();
      const auto& node = node_at<Layout>(lines, ref);
      const std::uint32_t bits = meet(node, ray, t_max).bits;
      if (bits != 0) {
        // The last is most worth a visit.
        const auto& children = Layout::children(node);
        ref = children[std::bit_width(bits) - 1];
        height += simd::store_chosen<Layout::width>(bits, children, stack + height) - 1;
        prefetch<Layout>(lines, stack[height - 1]);
        continue;
      }
    } else {
      work.primitive(Layout::leaf_size);
      if (try_leaf<Layout, true>(lines, ref, test, best)) return true;
    }
    if (height == 1) return false;
    ref = stack[--height];
  }
}

}  // namespace treeline::accel::wide
