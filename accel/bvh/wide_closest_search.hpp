// One closest-point query on its way through the wide tree over triangles.
//
// Depth first, the nearest child box first, as rays go (wide_ray.hpp). Leaves are measured in float with
// certain bounds (wide_closest.hpp): what may still be nearest is noted, and what has been noted, as a rule
// one to six triangles, is measured in double at the end. So the answer is that of double over all triangles,
// whatever float did and whatever way was taken: the least squared distance, of equals the lowest id. With
// `certified`, where doubles leave open which is nearest, it is decided exactly (wide_closest_judge.hpp).
// Coordinates so large that float's squares of areas would overflow are measured in double throughout.
#pragma once

#include "accel/bvh/wide_closest_judge.hpp"
#include "accel/bvh/wide_closest_notes.hpp"

namespace treeline::accel::wide {

template <class Layout, bool certified>
class ClosestSearch {
 public:
  using Point = geometry::Vec<double, 3>;

  ClosestSearch(const ClosestSpace& space, const ClosestQuestion& question, ClosestSoFar& best)
      : space_(space), question_(question), best_(best), point_(space.placed(question.point)) {}

  /// hint: a leaf that is likely to be near, or no_ref.
  template <class W>
  void run(Ref hint, W& work) {
    if (space_.tree.root == no_ref) return;
    double farthest = static_cast<double>(space_.place.reach);
    for (int k = 0; k < 3; ++k) farthest = std::max(farthest, std::abs(point_[k]));
    if (farthest <= static_cast<double>(closest_reach))
      in_float(hint, work);
    else
      in_double(work);
  }

 private:
  const Line* lines() const { return space_.tree.lines.data(); }

  /// What squared distances are to be at most, in the tree's units, its own rounding included.
  double most() const {
    const double limit2 = question_.limit * question_.limit;
    const double best2 = certified ? best_.high : best_.distance2;
    return std::min(limit2, best2) / space_.inverse2() * (1 + 0x1p-40);
  }

  // ---- in float ------------------------------------------------------------------------------------

  template <class W>
  [[gnu::always_inline]] void in_float(Ref hint, W& work) {
    const ClosestPlace place = space_.in_float(point_);
    notes_.upper = rounded_up(most());
    if (hint != no_ref) visit(hint, place);
    float limit = padded(notes_.upper);
    RayStack<Layout> stack;
    stack.clear(space_.tree.root);
    Ref ref = space_.tree.root;
    std::uint32_t limit_key = key_of<Layout>(limit);
    for (;;) {
      if (!is_leaf(ref)) {
        work.node();
        const auto& node = node_at<Layout>(lines(), ref);
        const auto hits = near(node, place, limit);
        if (hits.bits != 0) {
          ref = descend<true, Layout>(node, hits, stack);
          prefetch_whole<Layout>(lines(), stack.ref[stack.height - 1]);
          prefetch_whole<Layout>(lines(), stack.ref[stack.height - 2]);
          continue;
        }
      } else {
        work.primitive(Layout::leaf_size);
        prefetch_whole<Layout>(lines(), stack.ref[stack.height - 2]);
        if (ref != hint && visit(ref, place)) limit = padded(notes_.upper), limit_key = key_of<Layout>(limit);
      }
      do {
        if (stack.empty()) return settle();
        --stack.height;
      } while (stack.key[stack.height] > limit_key);
      ref = stack.ref[stack.height];
    }
  }

  [[gnu::always_inline]] bool visit(Ref ref, const ClosestPlace& place) {
    return notes_.visit(space_, ref, place, [this] { make_room(); });
  }

  [[gnu::noinline, gnu::cold]] void make_room() {
    settle();
    notes_.upper = std::min(notes_.upper, rounded_up(most()));
  }

  /// Measures what has been noted and may still be nearest.
  void settle() {
    notes_.take([&](Ref leaf, std::uint32_t lane) {
      add(Layout::triangles(leaf_at<Layout>(lines(), leaf)), leaf, lane);
    });
    measure();
  }

  // ---- in double -----------------------------------------------------------------------------------

  void add(const RayLeaf<Layout::leaf_size>& leaf, Ref ref, std::uint32_t lane) {
    leaf_[eight_.size()] = ref;
    eight_.add(leaf, lane);
    if (eight_.full()) measure();
  }
  void measure() {
    if (eight_.size() == 0) return;
    eight_.measure(point_);
    ClosestJudge<certified>(space_, question_, best_).take(eight_, 0, eight_.size(), leaf_);
    eight_.clear();
  }

  template <class W>
  [[gnu::noinline, gnu::cold]] void in_double(W& work) {
    struct Open {
      Ref ref;
      double distance2;
    };
    Open stack[ray_stack_size<Layout>];
    stack[0] = {space_.tree.root, 0};
    for (int height = 1; height > 0;) {
      const Open open = stack[--height];
      if (open.distance2 > most()) continue;
      if (is_leaf(open.ref)) {
        work.primitive(Layout::leaf_size);
        const auto& leaf = Layout::triangles(leaf_at<Layout>(lines(), open.ref));
        const std::uint32_t bits = space_.has_vanished ? extended(leaf) : (1u << Layout::leaf_size) - 1;
        for (std::uint32_t lane = 0; lane < Layout::leaf_size; ++lane)
          if (bits >> lane & 1) add(leaf, open.ref, lane);
        measure();
        continue;
      }
      work.node();
      const auto& node = node_at<Layout>(lines(), open.ref);
      const int first = height;
      for (int i = 0; i < Layout::count(node); ++i) {
        const double d2 = distance2(point_, box_in_double(Layout::box(node, i))) * (1 - 0x1p-40);
        if (d2 > most()) continue;
        int j = height++;  // the nearest on top
        for (; j > first && stack[j - 1].distance2 < d2; --j) stack[j] = stack[j - 1];
        stack[j] = {Layout::child(node, static_cast<std::uint32_t>(i)), d2};
      }
    }
  }
  static geometry::Box3d box_in_double(const geometry::Box<float, 3>& box) {
    return {Point(box.low), Point(box.high)};
  }

  const ClosestSpace& space_;
  const ClosestQuestion& question_;
  ClosestSoFar& best_;
  Point point_;  // in the tree's space
  ClosestNotes<Layout> notes_;
  EightClosest eight_;
  Ref leaf_[EightClosest::most];
};

}  // namespace treeline::accel::wide
