// Packets: up to sixteen rays that go about the same way walk through the wide tree together.
//
// A node is visited once for all of them: first its boxes are tested against the interval that the rays' slab
// constants span, all boxes at once (Boulos, Wald and Shirley 2006), then each box that passes against all
// rays at once, so that only rays that meet a box go on into it. What only a few rays meet, each of them
// visits by itself (Benthin et al. 2012). Every test is the one that a ray alone takes or lets through more,
// so the answers are those of single rays. Rays of a packet go into the same octant, along none of its
// borders. Cost: a node step of the whole packet is some three of a ray alone. Known weakness: rays that part
// soon pay for the tests that they did not need.
//
// Why the interval lets through what a ray alone meets: rounded subtraction and multiplication are monotone,
// so a bound computed from the ends of the constants is a bound of the values computed from what lies
// between.
#pragma once

#include "accel/bvh/wide_ray.hpp"

namespace treeline::accel::wide {

inline constexpr int packet_size = 16;

/// Layouts whose planes are read as they are.
template <class Layout>
concept WalksInPackets = std::same_as<typename Layout::Node, RayNode<Layout::width>>;

template <WalksInPackets Layout, class Test>
class Packet {
  static_assert(std::is_trivially_destructible_v<Test>, "rays are made in the place of others");

 public:
  Packet() {}
  bool empty() const { return size_ == 0; }
  bool full() const { return size_ == packet_size; }

  /// False, with nothing done, for a ray that does not go with those that are here.
  template <class Ray, class Point, class Box>
  bool add(const Ray& ray, const Point& centre, const Box& bounds, std::size_t index, int shift) {
    const BoxRay<Layout>& box = *new (&of_[size_].box) BoxRay<Layout>(ray, centre, bounds);
    for (int k = 0; k < 3; ++k) {
      if (!std::isnormal(box.inverse[k]) || (size_ > 0 && box.near_plane[k] != of_[0].box.near_plane[k]))
        return false;
      enter_from_[k][size_] = box.enter_from[k], exit_from_[k][size_] = box.exit_from[k];
      inverse_[k][size_] = box.inverse[k];
    }
    new (&of_[size_].test) Test(ray, centre, bounds, box.reach);
    of_[size_].best = {end_of(ray)}, of_[size_].index = index, of_[size_].shift = shift;
    t_min_[size_] = ray.t_min, limit_[size_] = of_[size_].best.t;
    ++size_;
    return true;
  }

  /// Finds the nearest hit of every ray; `any`: whether there is one.
  template <bool any>
  void walk(const Line* lines, Ref root) {
    hit_ = walked<any>(lines, root);
  }
  /// finish(test, nearest hit, index, shift, whether there was any) for each ray; then the packet is empty.
  template <class Finish>
  void take(Finish&& finish) {
    for (int i = 0; i < size_; ++i)
      finish(of_[i].test, of_[i].best, of_[i].index, of_[i].shift, (hit_ >> i & 1u) != 0);
    size_ = 0;
  }

 private:
  using Rays = std::uint32_t;  // a bit each
  using F = simd::Floats<Layout::width>;
  using R = simd::Floats<packet_size>;
  static constexpr int worth_a_packet = 3;  // fewer rays go on alone

  struct One {
    union {
      BoxRay<Layout> box;
    };
    union {
      Test test;
    };
    NearestHit<Layout> best;
    std::size_t index;
    int shift;
    One() {}
  };
  /// The ends of the rays' constants from which bounds of `enter` (below) and `exit` (above) come.
  struct Interval {
    float enter_from[3], exit_from[3], inverse[3][2];
    float t_min;
  };

  Interval interval() {
    for (int i = size_; i < packet_size; ++i) {  // lanes to spare: as the first
      for (int k = 0; k < 3; ++k) {
        enter_from_[k][i] = enter_from_[k][0], exit_from_[k][i] = exit_from_[k][0];
        inverse_[k][i] = inverse_[k][0];
      }
      t_min_[i] = t_min_[0], limit_[i] = -infinity;
    }
    const auto ends = [](const float(&x)[packet_size]) { return std::pair(least(x), most(x)); };
    Interval all;
    for (int k = 0; k < 3; ++k) {
      const auto enter = ends(enter_from_[k]), exit = ends(exit_from_[k]), inverse = ends(inverse_[k]);
      const bool forward = inverse_[k][0] > 0;
      all.enter_from[k] = forward ? enter.second : enter.first;
      all.exit_from[k] = forward ? exit.first : exit.second;
      all.inverse[k][0] = inverse.first, all.inverse[k][1] = inverse.second;
    }
    all.t_min = ends(t_min_).first;
    return all;
  }

  /// No ray enters a box earlier, or meets one whose bit is not set.
  [[gnu::always_inline]] BoxHits<Layout::width> meet_any(const typename Layout::Node& node,
                                                         const Interval& all, float limit) const {
    const auto* planes = reinterpret_cast<const unsigned char*>(node.plane);
    const BoxRay<Layout>& first = of_[0].box;
    F enter[3], exit[3];
    for (int k = 0; k < 3; ++k) {
      const auto from = [&](std::uint32_t offset, float x) {
        return F::load(reinterpret_cast<const float*>(planes + offset)) - F::broadcast(x);
      };
      const F least = F::broadcast(all.inverse[k][0]), most = F::broadcast(all.inverse[k][1]);
      const F near = from(first.near_plane[k], all.enter_from[k]),
              far = from(first.near_plane[k] ^ first.row, all.exit_from[k]);
      enter[k] = min(near * least, near * most), exit[k] = max(far * least, far * most);
    }
    const F begin = max(max(enter[0], enter[1]), max(enter[2], F::broadcast(all.t_min)));
    const F end = min(min(exit[0], exit[1]), min(exit[2], F::broadcast(limit)));
    return {begin, bits_le(begin, end)};
  }
  /// Which rays meet one box of a node.
  [[gnu::always_inline]] Rays meet_one(const typename Layout::Node& node, int lane) const {
    const auto* planes = reinterpret_cast<const unsigned char*>(node.plane);
    const BoxRay<Layout>& first = of_[0].box;
    R enter[3], exit[3];
    for (int k = 0; k < 3; ++k) {
      const auto plane = [&](std::uint32_t offset) {
        return R::broadcast(reinterpret_cast<const float*>(planes + offset)[lane]);
      };
      const R inverse = R::load(inverse_[k]);
      enter[k] = (plane(first.near_plane[k]) - R::load(enter_from_[k])) * inverse;
      exit[k] = (plane(first.near_plane[k] ^ first.row) - R::load(exit_from_[k])) * inverse;
    }
    const R begin = max(max(enter[0], enter[1]), max(enter[2], R::load(t_min_)));
    const R end = min(min(exit[0], exit[1]), min(exit[2], R::load(limit_)));
    return bits_le(begin, end);
  }
  float farthest() const { return most(limit_); }

  // By halves, on registers: branches that ask which is less cannot be foreseen.
  static float least(const float (&x)[packet_size]) {
    return reduced(x, [](auto p, auto q) {
      using std::min;
      return min(p, q);
    });
  }
  static float most(const float (&x)[packet_size]) {
    return reduced(x, [](auto p, auto q) {
      using std::max;
      return max(p, q);
    });
  }
  template <class Pick>
  [[gnu::always_inline]] static float reduced(const float (&x)[packet_size], Pick&& pick) {
    static_assert(packet_size == 16);
    using Eight = simd::Floats<8>;
    alignas(32) float a[8], b[4];
    pick(Eight::load(x), Eight::load(x + 8)).store(a);
    pick(simd::Floats4::load(a), simd::Floats4::load(a + 4)).store(b);
    return pick(pick(b[0], b[1]), pick(b[2], b[3]));
  }

  template <bool any>
  Rays walked(const Line* lines, Ref root) {
    const Interval all = interval();
    RayStack<Layout> stack;
    Rays rays[ray_stack_size<Layout>];
    stack.clear(root);
    Ref ref = root;
    const Rays everyone = (1u << size_) - 1;
    Rays here = everyone, hit = 0;
    float limit = farthest();
    bool nearer = false;  // than when that was found
    std::uint32_t last_key = key_of<Layout>(limit);
    for (;;) {
      if (std::popcount(here) < worth_a_packet) {
        for (; here != 0; here &= here - 1) hit |= alone<any>(lines, ref, std::countr_zero(here));
        nearer = true;
      } else if (is_leaf(ref)) {
        for (; here != 0; here &= here - 1) {
          const int i = std::countr_zero(here);
          One& one = of_[i];
          if (!try_leaf<Layout, any>(lines, ref, one.test, one.best)) continue;
          hit |= 1u << i, limit_[i] = any ? -infinity : one.best.t, nearer = true;
        }
      } else {
        const auto& node = node_at<Layout>(lines, ref);
        BoxHits<Layout::width> met = meet_any(node, all, limit);
        Rays of_child[Layout::width];
        std::uint32_t left = 0;
        for (std::uint32_t bits = met.bits; bits != 0; bits &= bits - 1) {
          const int lane = std::countr_zero(bits);
          of_child[lane] = meet_one(node, lane) & here;
          left |= (of_child[lane] != 0 ? 1u : 0u) << lane;
        }
        if (left != 0) {
          const int first = stack.height, count = std::popcount(left);
          if constexpr (any) {  // in the order of the node: the last is most worth a visit
            int to = first;
            for (; left != 0; left &= left - 1, ++to) {
              const int lane = std::countr_zero(left);
              stack.key[to] = 0, stack.ref[to] = node.child[lane], rays[to] = of_child[lane];
            }
          } else {
            const simd::Keys<Layout::width> keys(met.enter, left);
            keys.write_sorted(node.child, stack.key + first, stack.ref + first);
            for (int i = first; i < first + count; ++i)
              rays[i] = of_child[stack.key[i] & (Layout::width - 1u)];
          }
          stack.height += count - 1;
          ref = stack.ref[stack.height], here = rays[stack.height];
          prefetch<Layout>(lines, stack.ref[stack.height - 1]);
          continue;
        }
        here = 0;
      }
      if (any && hit == everyone) return hit;
      if (nearer) limit = farthest(), last_key = key_of<Layout>(limit), nearer = false;
      do {
        if (stack.empty()) return hit;
        --stack.height;
        here = rays[stack.height] & bits_reaching(stack.key[stack.height]) & ~(any ? hit : 0u);
      } while (stack.key[stack.height] > last_key || here == 0);
      ref = stack.ref[stack.height];
    }
  }

  /// Rays whose way is not over before what has this key, which is of a distance that is not negative.
  Rays bits_reaching(std::uint32_t key) const {
    const float from = std::bit_cast<float>(key & ~(Layout::width - 1u));
    return bits_le(R::broadcast(from), max(R::load(limit_), R::broadcast(0)));
  }

  template <bool is_any>
  Rays alone(const Line* lines, Ref ref, int i) {
    One& one = of_[i];
    NoWork work;
    if constexpr (is_any) {
      if (!wide::any(lines, ref, one.box, one.test, one.best.t, work)) return 0;
      limit_[i] = -infinity;
      return 1u << i;
    } else {
      wide::closest(lines, ref, one.box, one.test, one.best, work);
      limit_[i] = one.best.t;
      return 0;
    }
  }

  int size_ = 0;
  Rays hit_ = 0;
  alignas(64) float enter_from_[3][packet_size], exit_from_[3][packet_size], inverse_[3][packet_size];
  alignas(64) float t_min_[packet_size], limit_[packet_size];
  One of_[packet_size];
};

}  // namespace treeline::accel::wide
