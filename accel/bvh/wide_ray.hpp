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
#include "accel/simd/lanes8.hpp"
#include "geometry/predicates.hpp"
#include "geometry/ray.hpp"

namespace treeline::accel::wide {

using simd::Floats8;

/// Slack of a plane crossing, relative to the reach (see reach_of()): the sheared corner of a triangle is off
/// by 6 u of the reach along an axis, the crossing by 3 u, both with room to spare.
inline constexpr float box_slack = 12 * geometry::tolerance::unit_roundoff<float>;

/// Largest distance along an axis from the ray's origin to a side of a box.
inline float reach_from(const geometry::Vec<float, 3>& origin, const geometry::Box<float, 3>& box) {
  float reach = 0;
  for (int k = 0; k < 3; ++k)
    reach = std::max({reach, std::abs(box.low[k] - origin[k]), std::abs(box.high[k] - origin[k])});
  return reach;
}

/// What the box test needs of a ray.
struct BoxRay {
  float enter_from[3], exit_from[3], inverse[3];
  std::uint32_t near_plane[3];  // bytes from the start of a node; the far one is at near ^ 32
  float t_min;

  BoxRay(const geometry::Ray<float>& ray, const geometry::Box<float, 3>& bounds) : t_min(ray.t_min) {
    const float slack = box_slack * reach_from(ray.origin, bounds) + std::numeric_limits<float>::min();
    for (std::uint32_t k = 0; k < 3; ++k) {
      const float origin = ray.origin[static_cast<int>(k)], d = ray.direction[static_cast<int>(k)];
      // 3 u |origin|: the sums below round by at most u |origin|.
      const float padding = slack + 3 * geometry::tolerance::unit_roundoff<float> * std::abs(origin);
      float above = origin + padding, below = origin - padding;
      inverse[k] = 1 / d;
      if (d != 0 && !std::isnormal(inverse[k])) above = infinity, below = -infinity;  // never excludes
      const bool backward = std::signbit(d);
      enter_from[k] = backward ? below : above;
      exit_from[k] = backward ? above : below;
      near_plane[k] = k * 64 + (backward ? 32 : 0);
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
  Floats8 enter = Floats8::broadcast(ray.t_min), exit = Floats8::broadcast(limit);
  for (int k = 0; k < 3; ++k) {
    const auto plane = [&](std::uint32_t offset) {
      return Floats8::load(reinterpret_cast<const float*>(planes + offset));
    };
    const Floats8 inverse = Floats8::broadcast(ray.inverse[k]);
    // NaN (0 times infinity) never narrows.
    enter = max((plane(ray.near_plane[k]) - Floats8::broadcast(ray.enter_from[k])) * inverse, enter);
    exit = min((plane(ray.near_plane[k] ^ 32) - Floats8::broadcast(ray.exit_from[k])) * inverse, exit);
  }
  return {enter, bits_le(enter, exit)};
}

/// The nearest hit so far.
struct NearestHit {
  float t;  // nothing beyond is of interest
  Id id = no_id;
  const RayLeaf* leaf = nullptr;
  std::uint32_t lane = 0;
};

/// The triangle test, prepared for a ray.
template <bool checks_zeros>
class WoopTest {
 public:
  explicit WoopTest(const geometry::Ray<float>& ray) {
    const int z = largest_axis(ray.direction), axes[3] = {(z + 1) % 3, (z + 2) % 3, z};
    for (int k = 0; k < 3; ++k) {
      axis_[k] = static_cast<std::uint32_t>(axes[k]) * 32;
      origin_[k] = ray.origin[axes[k]];
    }
    speed_ = ray.direction[z];
    shear_[0] = ray.direction[axes[0]] / speed_, shear_[1] = ray.direction[axes[1]] / speed_;
    t_min_ = ray.t_min;
  }

  /// True if something was hit that is nearer than `best`, or as near with a lower id; `any`: just anything.
  template <bool any>
  [[gnu::always_inline]] bool operator()(const RayLeaf& leaf, NearestHit& best) const {
    const Sheared a = sheared(leaf, 0), b = sheared(leaf, 1), c = sheared(leaf, 2);
    const Floats8 u = edge(c, b), v = edge(a, c), w = edge(b, a);
    const Floats8 zero = Floats8::broadcast(0);
    // All three of one sign, zero being of either: what is not a number is looked at below.
    std::uint32_t bits = ~(bits_lt(min(min(u, v), w), zero) & bits_lt(zero, max(max(u, v), w))) & 0xffu;
    if (bits == 0) return false;
    const Floats8 sum = u + v + w;
    alignas(32) float t[width];
    ((u * a.z + v * b.z + w * c.z) / (sum * Floats8::broadcast(speed_))).store(t);
    // A sum whose quotient could be inaccurate or, where that counts, an edge of zero.
    const Floats8 size = absolute(sum);
    std::uint32_t sure =
        bits_lt(Floats8::broadcast(smallest_sum), size) & bits_lt(size, Floats8::broadcast(largest_sum));
    if constexpr (checks_zeros) sure &= bits_lt(zero, min(min(absolute(u), absolute(v)), absolute(w)));
    for (std::uint32_t doubtful = bits & ~sure; doubtful != 0; doubtful &= doubtful - 1) {
      const int lane = std::countr_zero(doubtful);
      if (!exactly(leaf, lane, t[lane])) bits &= ~(1u << lane);
    }
    bool found = false;
    for (; bits != 0; bits &= bits - 1) {
      const auto lane = static_cast<std::uint32_t>(std::countr_zero(bits));
      if (!(t[lane] >= t_min_ && t[lane] <= best.t)) continue;
      if constexpr (any) return true;
      if (t[lane] == best.t && leaf.id[lane] > best.id) continue;
      best = {t[lane], leaf.id[lane], &leaf, lane};
      found = true;
    }
    return found;
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
    double mean = 0;
    for (int i = 0; i < 3; ++i) mean += e[static_cast<std::size_t>(i)] / sum * double(height(leaf, lane, i));
    t = static_cast<float>(mean / double(speed_));
    return true;
  }

  float origin_[3], shear_[2], speed_, t_min_;
  std::uint32_t
      axis_[3];  // bytes from a corner's first coordinates to those along x, y, z of the sheared space
};

// ---- traversal -----------------------------------------------------------------------------------------

struct RayStack {
  alignas(64) std::uint32_t key[ray_stack_size];
  Ref ref[ray_stack_size];
};

/// A key that is not below any key of what the limit does not rule out.
inline std::uint32_t key_of(float limit) { return std::bit_cast<std::uint32_t>(std::max(limit, 0.0f)) | 7u; }

template <class Test, class W>
void closest(const Line* lines, Ref root, const BoxRay& ray, const Test& test, NearestHit& best, W& work) {
  RayStack stack;
  int height = 0;
  Ref ref = root;
  std::uint32_t limit = key_of(best.t);
  for (;;) {
    if (!is_leaf(ref)) {
      work.node();
      const RayNode& node = node_at(lines, ref);
      const BoxHits hits = meet(node, ray, best.t);
      if (hits.bits != 0) {
        const simd::Keys8 keys(hits.enter, hits.bits);
        ref = node.child[keys.nearest() & 7u];
        keys.write_sorted(node.child, stack.key + height, stack.ref + height);
        height += std::popcount(hits.bits) - 1;
        continue;
      }
    } else {
      work.primitive(width);
      if (test.template operator()<false>(leaf_at(lines, ref), best)) limit = key_of(best.t);
    }
    do {
      if (height == 0) return;
      --height;
    } while (stack.key[height] > limit);
    ref = stack.ref[height];
  }
}

template <class Test, class W>
bool any(const Line* lines, Ref root, const BoxRay& ray, const Test& test, float t_max, W& work) {
  Ref stack[ray_stack_size];
  int height = 0;
  NearestHit best{t_max};
  Ref ref = root;
  for (;;) {
    if (!is_leaf(ref)) {
      work.node();
      const RayNode& node = node_at(lines, ref);
      const std::uint32_t bits = meet(node, ray, t_max).bits;
      // All that are met; the largest, which is the last, is taken off again below.
      height += simd::store_set8(bits, node.child, stack + height);
    } else {
      work.primitive(width);
      if (test.template operator()<true>(leaf_at(lines, ref), best)) return true;
    }
    if (height == 0) return false;
    ref = stack[--height];
  }
}

}  // namespace treeline::accel::wide
