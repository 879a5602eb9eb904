// One ray on its way through the wide tree over triangles: boxes of a node, triangles of a leaf.
//
// Boxes: the slab test for eight at once, the padding that makes it conservative folded into two constants a
// ray and axis (Ize 2013; see padded_ray.hpp). Triangles: Woop, Benthin and Wald 2013 for eight at once. The
// shear of a corner depends on that corner alone, each product of an edge function is rounded by itself, and
// zero counts as inside: no ray passes between two triangles that share an edge or a vertex. t is a mean of
// the corners' heights with weights that are not negative, so it does not leave the triangle. Nothing fuses,
// so all instruction sets answer the same. Known weakness: for a triangle seen edge-on the weights, and t
// within its range, are inaccurate.
#pragma once

#include "accel/bvh/wide_triangle_layout.hpp"
#include "accel/ray_query.hpp"
#include "accel/simd/lanes8.hpp"
#include "geometry/predicates.hpp"
#include "geometry/ray.hpp"

namespace treeline::accel::wide {

using simd::Floats8;

/// Slack of a plane crossing, relative to the reach (see reach_of()): the sheared corner of a triangle is off
/// by 6 u of the reach along an axis, the crossing by 3 u, both with room to spare.
inline constexpr float box_slack = 12 * geometry::tolerance::unit_roundoff<float>;

/// How far the mean of a triangle's corners may be beside the ray before its weights count as cancelled,
/// relative to the reach: an eighth of what the corners' own roundings may leave between a hit and its ray
/// (hit_slack).
inline constexpr float mean_slack = geometry::tolerance::hit_slack<float> / 8;

/// What the box test needs of a ray. With slack as above and reach, the largest distance along an axis from
/// the ray's origin to a side of all boxes.
struct BoxRay {
  alignas(16) float enter_from[4], exit_from[4], inverse[4];
  std::uint32_t near_plane[3];  // bytes from the start of a node; the far one is at near ^ 32
  float t_min, reach;

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
    for (std::uint32_t k = 0; k < 3; ++k) near_plane[k] = k * 64 + (backward >> k & 1) * 32;
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
        enter_from[k] = near_plane[k] & 32 ? -most : most;
        exit_from[k] = -enter_from[k];
      }
  }
};

/// Where the ray enters the boxes of a node, and one bit for each that it meets before `limit`.
struct BoxHits {
  Floats8 enter;
  std::uint32_t bits;
};
[[gnu::always_inline]] inline BoxHits meet(const RayNode& node, const BoxRay& ray, float limit) {
  const auto* planes = reinterpret_cast<const unsigned char*>(&node);
  Floats8 enter[3], exit[3];
  for (int k = 0; k < 3; ++k) {
    const auto plane = [&](std::uint32_t offset) {
      return Floats8::load(reinterpret_cast<const float*>(planes + offset));
    };
    const Floats8 inverse = Floats8::broadcast(ray.inverse[k]);
    enter[k] = (plane(ray.near_plane[k]) - Floats8::broadcast(ray.enter_from[k])) * inverse;
    exit[k] = (plane(ray.near_plane[k] ^ 32) - Floats8::broadcast(ray.exit_from[k])) * inverse;
  }
  // What is not a number (0 times infinity) falls out, and at most another bound with it: that never narrows.
  const Floats8 first = max(max(enter[0], enter[1]), max(enter[2], Floats8::broadcast(ray.t_min)));
  const Floats8 last = min(min(exit[0], exit[1]), min(exit[2], Floats8::broadcast(limit)));
  return {first, bits_le(first, last)};
}

/// The nearest hit so far.
struct NearestHit {
  float t;  // nothing beyond is of interest
  Id id = no_id;
  const RayLeaf* leaf = nullptr;
  std::uint32_t lane = 0;
};

/// The triangle test, prepared for a ray.
class WoopTest {
 public:
  WoopTest(const geometry::Ray<float>& ray, const geometry::Vec<float, 3>& centre,
           const geometry::Box<float, 3>& /*bounds*/, float reach)
      : slack_(mean_slack * reach + std::numeric_limits<float>::min()) {
    const int z = largest_axis(ray.direction), axes[3] = {(z + 1) % 3, (z + 2) % 3, z};
    for (int k = 0; k < 3; ++k) {
      axis_[k] = static_cast<std::uint32_t>(axes[k]) * 32;
      origin_[k] = ray.origin[axes[k]] - centre[axes[k]];
    }
    speed_ = ray.direction[z];
    for (int k = 0; k < 2; ++k) direction_[k] = ray.direction[axes[k]], shear_[k] = direction_[k] / speed_;
    t_min_ = ray.t_min;
  }

  /// One bit for each triangle that is hit at a t of at most `limit`, and that t.
  [[gnu::always_inline]] std::uint32_t hits(const RayLeaf& leaf, float limit, float (&t)[width]) const {
    const Sheared a = sheared(leaf, 0), b = sheared(leaf, 1), c = sheared(leaf, 2);
    const Floats8 u = edge(c, b), v = edge(a, c), w = edge(b, a);
    const Floats8 zero = Floats8::broadcast(0);
    // All three of one sign, zero being of either: what is not a number is looked at below.
    const std::uint32_t inside =
        ~(bits_lt(min(min(u, v), w), zero) & bits_lt(zero, max(max(u, v), w))) & 0xffu;
    if (inside == 0) return 0;
    const Floats8 sum = u + v + w;
    const Floats8 time = (u * a.z + v * b.z + w * c.z) / (sum * Floats8::broadcast(speed_));
    time.store(t);
    const auto in_reach = [&](Floats8 x) {
      return bits_le(Floats8::broadcast(t_min_), x) & bits_le(x, Floats8::broadcast(limit));
    };
    std::uint32_t bits = inside & in_reach(time);
    // In doubt: a sum whose quotient could be inaccurate; an edge of zero; weights that cancelled, which show
    // in that the mean of the corners is not where the ray is.
    const Floats8 size = absolute(sum), least = min(min(absolute(u), absolute(v)), absolute(w));
    const auto beside = [&](Floats8 x, Floats8 y, Floats8 z) { return absolute(u * x + v * y + w * z); };
    const Floats8 gap = max(beside(a.x, b.x, c.x), beside(a.y, b.y, c.y));
    const std::uint32_t sure = bits_lt(Floats8::broadcast(smallest_sum), size) &
                               bits_lt(size, Floats8::broadcast(largest_sum)) & bits_lt(zero, least) &
                               bits_le(gap, size * Floats8::broadcast(slack_));
    for (std::uint32_t doubtful = inside & ~sure; doubtful != 0; doubtful &= doubtful - 1) {
      const int lane = std::countr_zero(doubtful);
      const bool hit = exactly(leaf, lane, t[lane]) && t_min_ <= t[lane] && t[lane] <= limit;
      bits = (bits & ~(1u << lane)) | (hit ? 1u << lane : 0u);
    }
    return bits;
  }

  /// Bits of triangles that the ray may hit when corners are off by up to `off` along an axis of the sheared
  /// space.
  [[gnu::always_inline]] std::uint32_t maybe(const RayLeaf& leaf, float off) const {
    const Sheared a = sheared(leaf, 0), b = sheared(leaf, 1), c = sheared(leaf, 2);
    const Floats8 u = edge(c, b), v = edge(a, c), w = edge(b, a);
    const auto size = [](const Sheared& p) { return max(absolute(p.x), absolute(p.y)); };
    const Floats8 offs = Floats8::broadcast(off);
    const Floats8 error = Floats8::broadcast(6 * off) * (max(max(size(a), size(b)), size(c)) + offs);
    const Floats8 least = min(min(u, v), w), most = max(max(u, v), w);
    return ~(bits_lt(least + error, Floats8::broadcast(0)) & bits_lt(error, most)) & 0xffu;
  }

  /// Weights of the second and third corner.
  void weights(const RayLeaf& leaf, std::uint32_t lane, float& u, float& v) const {
    const auto [e, sum] = exact_edges(leaf, static_cast<int>(lane));
    u = static_cast<float>(e[1] / sum), v = static_cast<float>(e[2] / sum);
  }

 private:
  static constexpr float smallest_sum = 1e-25f, largest_sum = 1e25f;
  struct Sheared {
    Floats8 x, y, z;
  };
  struct Edges {
    std::array<double, 3> value;
    double sum;
  };

  [[gnu::always_inline]] Sheared sheared(const RayLeaf& leaf, int corner) const {
    const auto* p = reinterpret_cast<const unsigned char*>(leaf.corner[corner]);
    const auto along = [&](int k) {
      return Floats8::load(reinterpret_cast<const float*>(p + axis_[k])) - Floats8::broadcast(origin_[k]);
    };
    const Floats8 z = along(2);
    return {along(0) - Floats8::broadcast(shear_[0]) * z, along(1) - Floats8::broadcast(shear_[1]) * z, z};
  }
  [[gnu::always_inline]] static Floats8 edge(const Sheared& p, const Sheared& q) {
    return p.x * q.y - p.y * q.x;
  }

  /// The same for one triangle with exact products: those of floats are exact in double.
  Edges exact_edges(const RayLeaf& leaf, int lane) const {
    double x[3], y[3];
    for (int i = 0; i < 3; ++i) shear_one(leaf, lane, i, x[i], y[i]);
    const auto edge = [&](int p, int q) { return x[p] * y[q] - y[p] * x[q]; };
    Edges e{{edge(2, 1), edge(0, 2), edge(1, 0)}, 0};
    e.sum = e.value[0] + e.value[1] + e.value[2];
    return e;
  }
  /// Where the ray passes nearest to a triangle, from its corners as they are.
  geometry::TriangleHit<float> nearest(const RayLeaf& leaf, int lane) const {
    geometry::Ray<float> ray;
    geometry::Triangle<float> triangle;
    geometry::Vec<float, 3>* const corner[3] = {&triangle.a, &triangle.b, &triangle.c};
    for (int k = 0; k < 3; ++k) {
      const auto axis = static_cast<int>(axis_[k] / 32);
      ray.origin[axis] = origin_[k], ray.direction[axis] = k < 2 ? direction_[k] : speed_;
      for (int i = 0; i < 3; ++i) (*corner[i])[axis] = leaf.corner[i][axis][lane];
    }
    return detail::nearest_approach<double>(ray, triangle);
  }
  float height(const RayLeaf& leaf, int lane, int corner) const {
    return leaf.corner[corner][axis_[2] / 32][lane] - origin_[2];
  }
  void shear_one(const RayLeaf& leaf, int lane, int corner, double& x, double& y) const {
    const float z = height(leaf, lane, corner);
    const auto along = [&](int k) {
      return leaf.corner[corner][axis_[k] / 32][lane] - origin_[k] - geometry::rounded(shear_[k] * z);
    };
    x = double(along(0)), y = double(along(1));
  }
  [[gnu::noinline, gnu::cold]] bool exactly(const RayLeaf& leaf, int lane, float& t) const {
    const auto [e, sum] = exact_edges(leaf, lane);
    if ((e[0] < 0 || e[1] < 0 || e[2] < 0) && (e[0] > 0 || e[1] > 0 || e[2] > 0)) return false;
    if (sum == 0) return false;  // the ray lies in the plane
    t = nearest(leaf, lane).t;
    return true;
  }

  float origin_[3], shear_[2], speed_, t_min_, slack_, direction_[2];
  std::uint32_t
      axis_[3];  // bytes from a corner's first coordinates to those along x, y, z of the sheared space
};

/// True if something was hit that is nearer than `best`, or as near with a lower id; `any`: just anything.
template <bool any, class Test>
[[gnu::always_inline]] inline bool try_leaf(const RayLeaf& leaf, const Test& test, NearestHit& best) {
  alignas(32) float t[width];
  std::uint32_t bits = test.hits(leaf, best.t, t);
  if (any || bits == 0) return bits != 0;
  bool found = false;
  for (; bits != 0; bits &= bits - 1) {
    const auto lane = static_cast<std::uint32_t>(std::countr_zero(bits));
    if (t[lane] > best.t || (t[lane] == best.t && leaf.id[lane] >= best.id)) continue;
    best = {t[lane], leaf.id[lane], &leaf, lane};
    found = true;
  }
  return found;
}

// ---- traversal -----------------------------------------------------------------------------------------

/// Children that wait, the nearest of a node on top.
struct RayStack {
  /// Two places below the first are never taken off, so that there is always something to ask for ahead.
  static constexpr int bottom = 2;
  alignas(64) std::uint32_t key[ray_stack_size];
  Ref ref[ray_stack_size];
  int height;

  void clear(Ref root) { height = bottom, ref[0] = ref[1] = root; }
  bool empty() const { return height == bottom; }
};

/// Asks for the lines of a node or leaf.
inline void prefetch(const Line* lines, Ref ref) {
  const char* p = reinterpret_cast<const char*>(lines) + std::size_t{ref & ~1u} * (line / 2);
  for (std::size_t i = 0; i < node_lines; ++i) __builtin_prefetch(p + i * line);
}

/// A key that is not below any key of what the limit does not rule out.
inline std::uint32_t key_of(float limit) { return std::bit_cast<std::uint32_t>(std::max(limit, 0.0f)) | 7u; }

/// The child to go on with; the others that were met wait, the nearest on top. One is the most frequent
/// number, and known early: a ray that stands alone is better off with a branch. For any other number it is
/// not, since branches mispredicted cost more than the exchanges that they save.
template <bool branches>
[[gnu::always_inline]] inline Ref descend(const RayNode& node, const BoxHits& hits, RayStack& stack) {
  if (branches && (hits.bits & (hits.bits - 1)) == 0) return node.child[std::countr_zero(hits.bits)];
  const simd::Keys8 keys(hits.enter, hits.bits);
  keys.write_sorted(node.child, stack.key + stack.height, stack.ref + stack.height);
  stack.height += std::popcount(hits.bits) - 1;
  return node.child[keys.nearest() & 7u];
}

template <class Test, class W>
void closest(const Line* lines, Ref root, const BoxRay& ray, const Test& test, NearestHit& best, W& work) {
  RayStack stack;
  stack.clear(root);
  Ref ref = root;
  std::uint32_t limit = key_of(best.t);
  for (;;) {
    if (!is_leaf(ref)) {
      work.node();
      const RayNode& node = node_at(lines, ref);
      const BoxHits hits = meet(node, ray, best.t);
      if (hits.bits != 0) {
        ref = descend<true>(node, hits, stack);
        // What is likely to be next but one: 5 to 15 % on rays that go anywhere, nothing lost on others.
        prefetch(lines, stack.ref[stack.height - 1]), prefetch(lines, stack.ref[stack.height - 2]);
        continue;
      }
    } else {
      work.primitive(width);
      if (try_leaf<false>(leaf_at(lines, ref), test, best)) limit = key_of(best.t);
    }
    do {
      if (stack.empty()) return;
      --stack.height;
    } while (stack.key[stack.height] > limit);
    ref = stack.ref[stack.height];
  }
}

/// Calls visit(leaf, lane, t) for every triangle hit up to t_max, in no particular order.
template <class Test, class Visit>
void all(const Line* lines, Ref root, const BoxRay& ray, const Test& test, float t_max, Visit&& visit) {
  Ref stack[ray_stack_size];
  stack[0] = root;
  for (int height = 1; height > 0;) {
    const Ref ref = stack[--height];
    if (!is_leaf(ref)) {
      const RayNode& node = node_at(lines, ref);
      height += simd::store_set8(meet(node, ray, t_max).bits, node.child, stack + height);
      continue;
    }
    const RayLeaf& leaf = leaf_at(lines, ref);
    alignas(32) float t[width];
    for (std::uint32_t bits = test.hits(leaf, t_max, t); bits != 0; bits &= bits - 1) {
      const auto lane = static_cast<std::uint32_t>(std::countr_zero(bits));
      if (lane == 0 || leaf.id[lane] != leaf.id[lane - 1]) visit(leaf, lane, t[lane]);
    }
  }
}

template <class Test, class W>
bool any(const Line* lines, Ref root, const BoxRay& ray, const Test& test, float t_max, W& work) {
  Ref stack[ray_stack_size];
  stack[0] = root;  // never taken off: always something to ask for ahead
  int height = 1;
  NearestHit best{t_max};
  Ref ref = root;
  for (;;) {
    if (!is_leaf(ref)) {
      work.node();
      const RayNode& node = node_at(lines, ref);
      const std::uint32_t bits = meet(node, ray, t_max).bits;
      if (bits != 0) {
        // The last is most worth a visit.
        ref = node.child[std::bit_width(bits) - 1];
        height += simd::store_set8(bits, node.child, stack + height) - 1;
        prefetch(lines, stack[height - 1]);
        continue;
      }
    } else {
      work.primitive(width);
      if (try_leaf<true>(leaf_at(lines, ref), test, best)) return true;
    }
    if (height == 1) return false;
    ref = stack[--height];
  }
}

}  // namespace treeline::accel::wide
