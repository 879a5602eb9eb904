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

/// A ray on its way to the nearest hit.
template <class Layout, class Test>
class ClosestFlight {
 public:
  template <class Ray, class Point, class Box>
  void start(const Ray& ray, const Point& centre, const Box& bounds, Ref root) {
    new (&box_ray_) BoxRay<Layout>(ray, centre, bounds);
    new (&test) Test(ray, centre, bounds, box_ray_.reach);
    best = {end_of(ray)};
    limit_ = key_of<Layout>(best.t), ref_ = root;
    stack_.clear(root);
  }
  /// False when it has arrived.
  [[gnu::always_inline]] bool step(const Line* lines) {
    if (!is_leaf(ref_)) {
      const auto& node = node_at<Layout>(lines, ref_);
      const auto hits = meet(node, box_ray_, best.t);
      if (hits.bits != 0) {
        ref_ = descend<false, Layout>(node, hits, stack_);
        prefetch<Layout>(lines, ref_);
        return true;
      }
    } else if (try_leaf<Layout, false>(lines, ref_, test, best)) {
      limit_ = key_of<Layout>(best.t);
    }
    do {
      if (stack_.empty()) return false;
      --stack_.height;
    } while (stack_.key[stack_.height] > limit_);
    ref_ = stack_.ref[stack_.height];
    prefetch<Layout>(lines, ref_);
    return true;
  }

  union {
    Test test;
  };
  NearestHit<Layout> best;
  std::size_t index;  // for the caller to use, as is shift
  int shift;

  ClosestFlight() {}

 private:
  union {
    BoxRay<Layout> box_ray_;
  };
  std::uint32_t limit_;
  Ref ref_;
  RayStack<Layout> stack_;
};

/// The same for any hit: best.id tells whether there was one.
template <class Layout, class Test>
class AnyFlight {
 public:
  template <class Ray, class Point, class Box>
  void start(const Ray& ray, const Point& centre, const Box& bounds, Ref root) {
    new (&box_ray_) BoxRay<Layout>(ray, centre, bounds);
    new (&test_) Test(ray, centre, bounds, box_ray_.reach);
    best_ = {end_of(ray)};
    hit = false, height_ = 0, ref_ = root;
  }
  [[gnu::always_inline]] bool step(const Line* lines) {
    if (!is_leaf(ref_)) {
      const auto& node = node_at<Layout>(lines, ref_);
      const std::uint32_t bits = meet(node, box_ray_, best_.t).bits;
      if (bits != 0) {
        const auto& children = Layout::children(node);
        ref_ = children[std::bit_width(bits) - 1];
        prefetch<Layout>(lines, ref_);
        height_ += simd::store_chosen<Layout::width>(bits, children, stack_ + height_) - 1;
        return true;
      }
    } else if (try_leaf<Layout, true>(lines, ref_, test_, best_)) {
      hit = true;
      return false;
    }
    if (height_ == 0) return false;
    ref_ = stack_[--height_];
    prefetch<Layout>(lines, ref_);
    return true;
  }

  bool hit;
  std::size_t index;  // for the caller to use, as is shift
  int shift;

  AnyFlight() {}

 private:
  union {
    BoxRay<Layout> box_ray_;
  };
  union {
    Test test_;
  };
  NearestHit<Layout> best_;
  int height_;
  Ref ref_;
  Ref stack_[ray_stack_size<Layout>];
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
