// Closest points of queries along a curve through space, a few neighbours at a time.
//
// One walk lists the leaves within a radius of the few queries' box. Each query then measures in float those
// of the list that it cannot rule out, the one whose box is nearest first. If its bound ends within the
// radius, all that may be as near was in the list; else it asks the tree by itself. What the few have noted
// is measured in double together, eight pairs of query and triangle at a time. So nodes are met once for some
// queries, and few lanes stay empty; the answers are those of ClosestSearch, bit by bit. The radius follows
// the distances of the queries before; where lists outgrow their room (queries far from each other, or from
// all triangles), groups are tried ever more rarely.
//
// Measured at a million triangles, 262144 queries near them, one thread of a Zen 4, as speed over that of
// queries in the order given, each pair within one run: along the curve one at a time 2.16 on a sphere, 1.89
// on a rough terrain, 1.90 on small triangles in a cube; by lists 2.37, 2.09, 2.16; measured together, too,
// 2.76, 2.78, 2.80. Groups of 8 are as fast, and slower where queries are sparse; of 2 and 16 no faster.
// Listing for a group while the one before is measured, so that memory is asked for earlier, is up to 5 %
// slower.
#pragma once

#include "accel/bvh/wide_closest_search.hpp"

namespace treeline::accel::wide {

/// The leaves near some queries, with their boxes.
template <class Layout>
class NearbyLeaves {
 public:
  static constexpr int room = 48;

  /// Lists all whose squared distance to the places' box is at most `radius2`, or what rounding makes of it.
  /// False if there are more than fit.
  bool collect(const RayTree& tree, const ClosestPlaces& places, float radius2) {
    count_ = 0, radius2_ = radius2;
    if (is_leaf(tree.root)) return false;
    const Line* const lines = tree.lines.data();
    const float limit = padded(radius2);
    Ref stack[ray_stack_size<Layout>];
    stack[0] = tree.root;
    for (int height = 1; height > 0;) {
      const auto& node = node_at<Layout>(lines, stack[--height]);
      for (std::uint32_t bits = near(node, places, limit).bits; bits != 0; bits &= bits - 1) {
        const int i = std::countr_zero(bits);
        const Ref ref = Layout::child(node, static_cast<std::uint32_t>(i));
        if (!is_leaf(ref)) {
          stack[height++] = ref;
          continue;
        }
        if (count_ == room) return false;
        prefetch_whole<Layout>(lines, ref);
        add(ref, Layout::box(node, i));
      }
    }
    for (int j = count_; j % lanes != 0; ++j)
      for (auto& plane : plane_) plane[0][j] = infinity, plane[1][j] = -infinity;
    return true;
  }
  float radius2() const { return radius2_; }

  /// Calls visit(leaf) for those that may hold what is at most notes.upper away, the nearest box first;
  /// visit returns whether that has come down.
  template <class Visit>
  [[gnu::always_inline]] void each(const ClosestPlace& place, const ClosestNotes<Layout>& notes,
                                   Visit&& visit) const {
    if (count_ == 0) return;
    alignas(64) float distance2[room];
    F least = F::broadcast(infinity);
    for (int j = 0; j < count_; j += lanes) {
      const F d2 = place.to_boxes<lanes>([&](int k, int high) { return F::load(&plane_[k][high][j]); });
      d2.store(distance2 + j), least = min(least, d2);
    }
    const F nearest = F::broadcast(smallest(least));
    int first = 0;
    while (bits_le(F::load(distance2 + first), nearest) == 0) first += lanes;
    first += std::countr_zero(bits_le(F::load(distance2 + first), nearest));
    float limit = padded(notes.upper);
    if (!(distance2[first] <= limit)) return;
    if (visit(leaf_[first])) limit = padded(notes.upper);
    distance2[first] = infinity;
    for (int j = 0; j < count_; j += lanes)
      for (std::uint32_t bits = bits_le(F::load(distance2 + j), F::broadcast(limit)); bits != 0;
           bits &= bits - 1) {
        const int i = j + std::countr_zero(bits);
        if (distance2[i] <= limit && visit(leaf_[i])) limit = padded(notes.upper);
      }
  }

 private:
  static constexpr int lanes = 8;
  static_assert(room % lanes == 0);
  using F = simd::Floats<lanes>;
  static constexpr float infinity = std::numeric_limits<float>::infinity();

  void add(Ref ref, const geometry::Box<float, 3>& box) {
    for (int k = 0; k < 3; ++k) plane_[k][0][count_] = box.low[k], plane_[k][1][count_] = box.high[k];
    leaf_[count_++] = ref;
  }

  alignas(64) float plane_[3][2][room];
  Ref leaf_[room];
  int count_ = 0;
  float radius2_ = 0;
};

/// A tree and its space, asked by queries that follow each other along a curve.
template <class Layout, bool certified>
class ClosestGroups {
 public:
  static constexpr std::size_t most = 4;  // queries at once
  using Point = geometry::Vec<float, 3>;

  ClosestGroups(const ClosestSpace& space, double limit)
      : space_(space),
        limit_(limit),
        first_upper_(rounded_up(limit * limit / space.inverse2() * (1 + 0x1p-40))) {}

  /// best[i]: for queries[i], of which there are at most `most`.
  void find(std::span<const Point> queries, ClosestSoFar* best) {
    std::fill_n(best, queries.size(), ClosestSoFar{});
    bool done[most] = {};
    const bool listed = list(queries);
    if (listed) ask_list(queries, best, done);
    float farthest2 = 0;
    for (std::size_t i = 0; i < queries.size(); ++i) {
      if (!done[i]) {
        NoWork work;
        const ClosestQuestion question{queries[i], limit_};
        ClosestSearch<Layout, certified>(space_, question, best[i]).run(hint_, work);
      }
      if (best[i].leaf != no_ref) hint_ = best[i].leaf;
      farthest2 =
          std::max(farthest2, std::min(first_upper_, rounded_up(best[i].distance2 / space_.inverse2())));
    }
    // The farthest neighbours to come are rarely in this group: the radius comes down slowly, unless it was
    // too large to make a list.
    const float next = std::max(farthest2 * 1.2f, listed ? radius2_ * 0.8f : 0.0f);
    radius2_ = std::min(next, std::numeric_limits<float>::max());
  }

 private:
  /// Whether leaves_ has what is near all of them.
  bool list(std::span<const Point> queries) {
    if (groups_to_skip_ > 0) return --groups_to_skip_, false;
    ClosestPlaces places;
    double farthest = static_cast<double>(space_.place.reach);
    for (std::size_t i = 0; i < queries.size(); ++i) {
      point_[i] = space_.placed(queries[i]);
      places.box.grow(Point(point_[i]));
      for (int k = 0; k < 3; ++k) farthest = std::max(farthest, std::abs(point_[i][k]));
    }
    if (space_.tree.root != no_ref && farthest <= static_cast<double>(closest_reach) &&
        leaves_.collect(space_.tree, places, radius2_)) {
      skips_ = 1;
      return true;
    }
    groups_to_skip_ = skips_;
    skips_ = std::min(2 * skips_, most_skips);
    return false;
  }

  /// done[i]: best[i] is found.
  void ask_list(std::span<const Point> queries, ClosestSoFar* best, bool* done) {
    for (std::size_t i = 0; i < queries.size(); ++i) {
      const ClosestPlace place = space_.in_float(point_[i]);
      notes_.upper = first_upper_;
      bool fits = true;
      leaves_.each(
          place, notes_, [&](Ref leaf) __attribute__((always_inline)) {
            return notes_.visit(space_, leaf, place,
                                [&] { fits = false, notes_.take([](Ref, std::uint32_t) {}); });
          });
      done[i] = fits && notes_.upper <= leaves_.radius2();
      notes_.take([&](Ref leaf, std::uint32_t lane) {
        if (!done[i]) return;
        if (pairs_.full()) measure(queries, best);
        add(leaf, lane, i);
      });
    }
    measure(queries, best);
  }
  void add(Ref leaf, std::uint32_t lane, std::size_t query) {
    const int i = pairs_.size();
    for (int k = 0; k < 3; ++k) from_[k][i] = point_[query][k];
    query_[i] = query, leaf_[i] = leaf;
    pairs_.add(Layout::triangles(leaf_at<Layout>(space_.tree.lines.data(), leaf)), lane);
  }
  void measure(std::span<const Point> queries, ClosestSoFar* best) {
    if (pairs_.size() == 0) return;
    pairs_.measure([&](int k) { return EightClosest::Lane::load(from_[k]); });
    for (int begin = 0, end = 0; begin < pairs_.size(); begin = end) {
      const std::size_t q = query_[begin];
      while (end < pairs_.size() && query_[end] == q) ++end;
      const ClosestQuestion question{queries[q], limit_};
      ClosestJudge<certified>(space_, question, best[q]).take(pairs_, begin, end, leaf_);
    }
    pairs_.clear();
  }

  static constexpr int most_skips = 32;

  const ClosestSpace& space_;
  double limit_;
  float first_upper_;
  Ref hint_ = no_ref;
  float radius2_ = 0;
  int groups_to_skip_ = 0, skips_ = 1;

  geometry::Vec3d point_[most];  // in the tree's space
  NearbyLeaves<Layout> leaves_;
  ClosestNotes<Layout> notes_;
  EightClosest pairs_;
  alignas(64) double from_[3][EightClosest::most] = {};
  std::size_t query_[EightClosest::most];  // of a pair
  Ref leaf_[EightClosest::most];
};

}  // namespace treeline::accel::wide
