// One closest-point query on its way through the wide tree over triangles.
//
// Depth first, the nearest child box first, as rays go (wide_ray.hpp). Leaves are measured in float with
// certain bounds (wide_closest.hpp): what may still be nearest is noted, and what has been noted, as a rule
// one to six triangles, is measured in double at the end. So the answer is that of double over all triangles,
// whatever float did and whatever way was taken: the least squared distance, of equals the lowest id. With
// `certified`, where doubles leave open which is nearest, it is decided exactly (wide_closest_exact.hpp).
// Coordinates so large that float's squares of areas would overflow are measured in double throughout.
#pragma once

#include <optional>

#include "accel/bvh/triangle_input.hpp"
#include "accel/bvh/wide_closest_double.hpp"
#include "accel/bvh/wide_closest_exact.hpp"
#include "accel/bvh/wide_collapse.hpp"

namespace treeline::accel::wide {

/// A tree and its space.
struct ClosestSpace {
  const RayTree& tree;
  const TriangleInput::Place& place;
  bool has_vanished = false;  // triangles that a refit left without an area, in the tree at (0, 0, 0)
  bool gives_hints = true;
};

/// The nearest triangle so far; what is measured is in the user's units.
struct ClosestSoFar {
  double distance2 = std::numeric_limits<double>::infinity();
  double low = distance2, high = distance2;  // bounds on the true squared distance; where certified
  Id id = no_id;
  Feature feature = Feature::face;
  geometry::Vec3d point{};
  Ref leaf = no_ref;                 // where it, or one before it, is, for a hint
  std::optional<ExactlyNear> exact;  // where certified, and found out
};

/// What is asked.
struct ClosestQuestion {
  geometry::Vec<float, 3> point;
  double limit;  // distances beyond are of no interest
};

template <class Layout, bool certified>
class ClosestSearch {
 public:
  using Point = geometry::Vec<double, 3>;

  ClosestSearch(const ClosestSpace& space, const ClosestQuestion& question, ClosestSoFar& best)
      : space_(space),
        question_(question),
        best_(best),
        factor_(static_cast<double>(space.place.scale.factor())),
        inverse_(static_cast<double>(space.place.scale.inverse())),
        inverse2_(inverse_ * inverse_),
        point_((Point(question.point) - Point(space.place.centre)) * factor_) {}

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
    return std::min(limit2, best2) / inverse2_ * (1 + 0x1p-40);
  }

  // ---- in float ------------------------------------------------------------------------------------

  struct Noted {
    Ref leaf;
    std::uint32_t lane;
    float low;
  };

  template <class W>
  [[gnu::always_inline]] void in_float(Ref hint, W& work) {
    const ClosestPlace place(geometry::Vec<float, 3>(point_), space_.place.centre != geometry::Vec3f{});
    upper_ = float_most();
    if (hint != no_ref) visit(hint, place);
    float limit = padded(upper_);
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
          ask_for(stack.ref[stack.height - 1]);
          ask_for(stack.ref[stack.height - 2]);
          continue;
        }
      } else {
        work.primitive(Layout::leaf_size);
        ask_for(stack.ref[stack.height - 2]);
        if (ref != hint && visit(ref, place)) limit = padded(upper_), limit_key = key_of<Layout>(limit);
      }
      do {
        if (stack.empty()) return settle();
        --stack.height;
      } while (stack.key[stack.height] > limit_key);
      ref = stack.ref[stack.height];
    }
  }

  /// For all lines of a node or leaf.
  void ask_for(Ref ref) const {
    const unsigned char* const p = at<Layout>(lines(), ref & ~1u);
    for (std::size_t i = 0; i < sizeof(typename Layout::Leaf); i += line) __builtin_prefetch(p + i);
  }

  static float padded(float upper) {
    return std::min(upper * (1 + box_distance_slack), std::numeric_limits<float>::max());
  }
  /// most(), rounded up.
  float float_most() const {
    constexpr double largest = std::numeric_limits<float>::max();
    return static_cast<float>(std::min(most() * (1 + 0x1p-22) + 0x1p-116, largest));
  }

  /// Notes what may be nearest. True if the limit has come down.
  [[gnu::always_inline]] bool visit(Ref ref, const ClosestPlace& place) {
    using F = simd::Floats<Layout::leaf_size>;
    const auto& leaf = Layout::triangles(leaf_at<Layout>(lines(), ref));
    const auto bounds = place.to_triangles(leaf);
    std::uint32_t bits = bounds.within(upper_);
    if (bits == 0) return false;
    if (space_.has_vanished) [[unlikely]] {
      bits &= present(leaf);
      if (bits == 0) return false;
    }
    bool nearer = false;
    if (!space_.has_vanished) {
      nearer = bits_lt(bounds.high, F::broadcast(upper_)) != 0;
      if (nearer) upper_ = smallest(bounds.high), bits = bounds.within(upper_);
    } else {
      alignas(64) float high[Layout::leaf_size];
      bounds.high.store(high);
      for (std::uint32_t left = bits; left != 0; left &= left - 1)
        if (const float h = high[std::countr_zero(left)]; h < upper_) upper_ = h, nearer = true;
      bits &= bounds.within(upper_);
    }
    alignas(64) float low[Layout::leaf_size];
    bounds.low.store(low);
    for (; bits != 0; bits &= bits - 1) {
      const auto lane = static_cast<std::uint32_t>(std::countr_zero(bits));
      if (count_ == room) make_room();
      noted_[count_++] = {ref, lane, (bounds.slivers >> lane & 1) != 0 ? bounds.sliver_low(lane) : low[lane]};
    }
    return nearer;
  }
  static std::uint32_t present(const RayLeaf<Layout::leaf_size>& leaf) {
    std::uint32_t bits = 0;
    for (int j = 0; j < Layout::leaf_size; ++j) {
      bool same = true;
      for (int k = 0; k < 3; ++k)
        same = same && leaf.corner[0][k][j] == leaf.corner[1][k][j] &&
               leaf.corner[0][k][j] == leaf.corner[2][k][j];
      bits |= (same ? 0u : 1u) << j;
    }
    return bits;
  }

  [[gnu::noinline, gnu::cold]] void make_room() {
    settle();
    upper_ = std::min(upper_, float_most());
  }

  /// Measures what has been noted and may still be nearest.
  void settle() {
    for (int i = 0; i < count_; ++i) {
      const Noted& noted = noted_[i];
      if (noted.low > upper_) continue;
      add(Layout::triangles(leaf_at<Layout>(lines(), noted.leaf)), noted.leaf, noted.lane);
    }
    count_ = 0;
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
    int winner = -1;
    best_lane_ = -1;
    for (int i = 0; i < eight_.size(); ++i)
      if (is_better(i)) winner = i;
    if (winner >= 0) {
      Point point;
      best_.feature = eight_.nearest(winner, point);
      best_.point = point * inverse_ + Point(space_.place.centre);
      if (space_.gives_hints) best_.leaf = leaf_[winner];
      if (certified && !best_.exact) best_.exact = user_triangle(winner);
    }
    eight_.clear();
  }
  /// Takes the i-th as the best if it is.
  bool is_better(int i) {
    const double d2 = eight_.distance2(i) * inverse2_;
    const Id id = eight_.id(i);
    if constexpr (!certified) {
      if (d2 > best_.distance2 || (d2 == best_.distance2 && id >= best_.id)) return false;
      if (!(d2 <= question_.limit * question_.limit)) return false;
      best_.distance2 = d2, best_.id = id;
      return true;
    } else {
      if (id == best_.id) return false;
      double above, below;
      eight_.error(i, above, below);
      const double low = d2 - above * inverse2_, high = d2 + below * inverse2_;
      if (low > best_.high) return false;
      std::optional<ExactlyNear> exact;
      const double limit2 = question_.limit * question_.limit;
      if (high > limit2) {
        if (low > limit2) return false;
        if (!is_within(user_point(), *(exact = user_triangle(i)), question_.limit)) return false;
      }
      if (!(high < best_.low)) {
        if (best_lane_ >= 0 && eight_.share_feature(i, best_lane_)) {
          if (id > best_.id) return false;
        } else {
          if (!exact) exact = user_triangle(i);
          if (!best_.exact) best_.exact = user_triangle(best_lane_);
          const int order = compare(user_point(), *exact, *best_.exact);
          if (order > 0 || (order == 0 && id > best_.id)) return false;
        }
      }
      best_.distance2 = d2, best_.low = low, best_.high = high, best_.id = id;
      best_.exact = std::move(exact), best_lane_ = i;
      return true;
    }
  }
  Point user_point() const { return Point(question_.point); }
  /// As the user gave it, but for coordinates that scaling has made denormal or 0 beside the typical one
  /// (triangle_scale.hpp): moving lost nothing.
  std::optional<ExactlyNear> user_triangle(int i) const {
    const auto t = eight_.triangle(i);
    const auto corner = [&](const Point& p) { return p * inverse_ + Point(space_.place.centre); };
    return ExactlyNear(user_point(), {corner(t.a), corner(t.b), corner(t.c)}, eight_.certain_feature(i));
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
        const std::uint32_t bits = space_.has_vanished ? present(leaf) : (1u << Layout::leaf_size) - 1;
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

  static constexpr int room = 64;

  const ClosestSpace& space_;
  const ClosestQuestion& question_;
  ClosestSoFar& best_;
  double factor_, inverse_, inverse2_;
  Point point_;  // in the tree's space
  float upper_ = 0;
  int count_ = 0;
  Noted noted_[room];
  EightClosest eight_;
  int best_lane_ = -1;  // of `eight_`, where the best is among them
  Ref leaf_[EightClosest::most];
};

}  // namespace treeline::accel::wide
