// Several rays in flight: while one waits for memory, the others take their steps.
//
// A ray that stands alone waits at every level for the node that the level above named; in a tree larger than
// the caches incoherent rays spend most of their time so. Here a thread keeps `in_flight` rays, takes one
// step (a node or a leaf) with each by turns, and asks for the lines of the next step before it turns to the
// next ray. The steps are those of wide_ray.hpp in the same order, and so are the answers. Cost: some 4 KiB
// of state a ray, which stays in the first caches. Known weakness: of no use while the tree fits the caches
// itself, where the state only costs.
#pragma once

#include "accel/bvh/wide_ray.hpp"

namespace treeline::accel::wide {

inline constexpr int in_flight = 12;

inline void prefetch_step(const Line* lines, Ref ref) {
  const char* p = reinterpret_cast<const char*>(lines) + std::size_t{ref & ~1u} * (line / 2);
  for (std::size_t i = 0; i < node_lines; ++i) __builtin_prefetch(p + i * line);
  if (is_leaf(ref)) __builtin_prefetch(p + node_lines * line);
}

/// A ray on its way to the nearest hit.
template <class Test>
class ClosestFlight {
 public:
  template <class Ray, class Box>
  void start(const Ray& ray, const Box& bounds, Ref root, std::size_t number) {
    new (&box_ray_) BoxRay(ray, bounds);
    new (&test) Test(ray);
    best = {ray.t_max};
    limit_ = key_of(ray.t_max), height_ = 0, ref_ = root, index = number;
  }
  /// False when it has arrived.
  [[gnu::always_inline]] bool step(const Line* lines) {
    if (!is_leaf(ref_)) {
      const RayNode& node = node_at(lines, ref_);
      const BoxHits hits = meet(node, box_ray_, best.t);
      if (hits.bits != 0) {
        const simd::Keys8 keys(hits.enter, hits.bits);
        ref_ = node.child[keys.nearest() & 7u];
        prefetch_step(lines, ref_);
        keys.write_sorted(node.child, stack_.key + height_, stack_.ref + height_);
        height_ += std::popcount(hits.bits) - 1;
        return true;
      }
    } else if (test.template operator()<false>(leaf_at(lines, ref_), best)) {
      limit_ = key_of(best.t);
    }
    do {
      if (height_ == 0) return false;
      --height_;
    } while (stack_.key[height_] > limit_);
    ref_ = stack_.ref[height_];
    prefetch_step(lines, ref_);
    return true;
  }

  union {
    Test test;
  };
  NearestHit best;
  std::size_t index;

  ClosestFlight() {}

 private:
  union {
    BoxRay box_ray_;
  };
  std::uint32_t limit_;
  int height_;
  Ref ref_;
  RayStack stack_;
};

/// The same for any hit: best.id tells whether there was one.
template <class Test>
class AnyFlight {
 public:
  template <class Ray, class Box>
  void start(const Ray& ray, const Box& bounds, Ref root, std::size_t number) {
    new (&box_ray_) BoxRay(ray, bounds);
    new (&test_) Test(ray);
    best_ = {ray.t_max};
    hit = false, height_ = 0, ref_ = root, index = number;
  }
  [[gnu::always_inline]] bool step(const Line* lines) {
    if (!is_leaf(ref_)) {
      const RayNode& node = node_at(lines, ref_);
      const std::uint32_t bits = meet(node, box_ray_, best_.t).bits;
      height_ += simd::store_set8(bits, node.child, stack_ + height_);
    } else if (test_.template operator()<true>(leaf_at(lines, ref_), best_)) {
      hit = true;
      return false;
    }
    if (height_ == 0) return false;
    ref_ = stack_[--height_];
    prefetch_step(lines, ref_);
    return true;
  }

  bool hit;
  std::size_t index;

  AnyFlight() {}

 private:
  union {
    BoxRay box_ray_;
  };
  union {
    Test test_;
  };
  NearestHit best_;
  int height_;
  Ref ref_;
  Ref stack_[ray_stack_size];
};

/// Calls start(flight, i) and, when it has arrived, finish(flight), for each i in [begin, end) once.
template <class Flight, class Start, class Finish>
void fly(const Line* lines, std::size_t begin, std::size_t end, Start&& start, Finish&& finish) {
  Flight flights[in_flight];
  int active = 0;
  for (; active < in_flight && begin < end; ++active) start(flights[active], begin++);
  Flight* order[in_flight];  // those on their way
  for (int i = 0; i < active; ++i) order[i] = &flights[i];
  while (active > 0)
    for (int i = 0; i < active; ++i) {
      if (order[i]->step(lines)) continue;
      finish(*order[i]);
      if (begin < end)
        start(*order[i], begin++);
      else
        order[i] = order[--active], --i;
    }
}

}  // namespace treeline::accel::wide
