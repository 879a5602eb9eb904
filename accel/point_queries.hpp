// Everything a NeighborIndex says, over the two traversals that a tree of points must have:
//   visit_near(q, visitor, work): offers leaves to the visitor, near ones first, but those beyond
//   visitor.limit(); visit_box(box, leaf, work): calls leaf(PointLeaf) for every leaf that may hold a point
//   of the box.
// Checks of the input, the choice of a collector, batches and scaling are here, once for all trees. A tree
// with searches of its own says `searches_itself` and has, all in scaled coordinates:
//   search_nearest(q, out, work), search_nearest_group(queries, k, out) for at most group_size queries at
//   once, search_within(q, limit, list, work), search_inside(box, ids, work);
// and one that ranks in the wider type itself says `ranks_itself` and has
//   visit_best(q, best, work) with a BestCandidates.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "accel/batch.hpp"
#include "accel/candidates.hpp"
#include "accel/point_checks.hpp"

namespace treeline::accel {

/// NearestOptions in scaled and squared terms.
template <class T>
struct SearchLimits {
  T within = std::numeric_limits<T>::infinity();
  T shrink = 1;  // cells farther than the worst of k found so far times this are left out
  std::size_t leaves = static_cast<std::size_t>(-1);
  bool exact = true;

  /// Whether there are k to find however few leaves are left, since nothing is too far away.
  bool fills() const { return std::isinf(within); }
};

template <class Tree, class T, int D>
class PointQueries {
  using Checks = PointChecks<T, D>;

 public:
  using Scalar = T;
  static constexpr int dimension = D;
  using Point = geometry::Vec<T, D>;
  using Box = geometry::Box<T, D>;
  static constexpr bool searches_itself = false, ranks_itself = false;
  static constexpr bool keeps_each_point_once = true;

  // ---- one query: see NeighborIndex -------------------------------------------------------------------

  std::size_t nearest(const Point& q, std::size_t k, std::span<Neighbor<T>> out) const {
    NoWork work;
    return nearest(q, k, out, work);
  }
  template <WorkCounter W>
  std::size_t nearest(const Point& q, std::size_t k, std::span<Neighbor<T>> out, W& work) const {
    return nearest(q, k, NearestOptions<T>{}, out, work);
  }
  /// Those that the options leave; returns how many.
  std::size_t nearest(const Point& q, std::size_t k, const NearestOptions<T>& options,
                      std::span<Neighbor<T>> out) const {
    NoWork work;
    return nearest(q, k, options, out, work);
  }
  template <WorkCounter W>
  std::size_t nearest(const Point& q, std::size_t k, const NearestOptions<T>& options,
                      std::span<Neighbor<T>> out, W& work) const {
    Checks::check_k(k);
    Checks::check_options(options);
    Checks::check_query(q, "query");
    const std::size_t m = std::min(k, size());
    Checks::check_room(out.size(), m);
    return find_nearest(q, options, out.first(m), work);
  }
  void within(const Point& q, T radius, std::vector<Neighbor<T>>& out) const {
    NoWork work;
    within(q, radius, out, work);
  }
  template <WorkCounter W>
  void within(const Point& q, T radius, std::vector<Neighbor<T>>& out, W& work) const {
    Checks::check_radius(radius);
    Checks::check_query(q, "query");
    out.clear();
    append_within(q, radius, out, work);
  }
  void within(const Point& q, T radius, const WithinOptions& options, std::vector<Neighbor<T>>& out) const {
    NoWork work;
    within(q, radius, options, out, work);
  }
  template <WorkCounter W>
  void within(const Point& q, T radius, const WithinOptions& options, std::vector<Neighbor<T>>& out,
              W& work) const {
    Checks::check_radius(radius);
    Checks::check_query(q, "query");
    if (!options.ranked() || size() == 0) return within(q, radius, out, work);
    const Reach<T> reach = set_.reach(radius);
    const bool some = options.at_most < size();
    if (reach.widely && (some || radius > 0)) return rank_within(q, reach, options.at_most, out, work);
    const T limit = reach.square;
    out.clear();
    if (radius == 0) return append_at(q, out, work), std::sort(out.begin(), out.end());
    const Point scaled = set_.scaled(q);
    if (some && options.at_most <= few) {  // no list of all that lie there
      out.resize(options.at_most);
      if (out.empty()) return;
      if constexpr (Tree::searches_itself && Tree::keeps_each_point_once)
        tree().search_nearest(scaled, {limit}, std::span(out), work);
      else  // a tree that copies points may search for the nearest in haste
        collect(scaled, SortedBest<T>(out, limit), {}, work);
      return out.resize(settle(q, scaled, limit, out, work));
    }
    append_scaled(scaled, limit, out, work);
    const std::size_t wanted = std::min(options.at_most, out.size());
    std::partial_sort(out.begin(), out.begin() + static_cast<std::ptrdiff_t>(wanted), out.end());
    out.resize(wanted);
    settle(q, scaled, limit, out, work);
  }
  /// All at a squared distance of at most radius2, as nearest() tells it.
  void within_squared(const Point& q, T radius2, std::vector<Neighbor<T>>& out) const {
    Checks::check_radius2(radius2);
    within(q, PointMeasure<T, D>::radius_over(radius2), out);
    std::erase_if(out, [&](const Neighbor<T>& n) { return n.distance2 > radius2; });
  }
  std::size_t count_within(const Point& q, T radius) const {
    Checks::check_radius(radius);
    Checks::check_query(q, "query");
    if (size() == 0) return 0;
    if (std::isinf(radius)) return size();
    const Reach<T> reach = set_.reach(radius);
    if (reach.widely) {
      NoWork work;
      if (radius == 0) {
        std::vector<Id> ids;
        append_inside({q, q}, ids, work);
        return ids.size();
      }
      return all_within({set_, q}, reach, work).size();
    }
    if constexpr (Tree::searches_itself) {
      return tree().count_within_limit(set_.scaled(q), reach.square);
    } else {
      NoWork work;
      CountWithin<T> counter(reach.square);
      tree().visit_near(set_.scaled(q), counter, work);
      return counter.count;
    }
  }
  void inside(const Box& box, std::vector<Id>& out) const {
    NoWork work;
    inside(box, out, work);
  }
  template <WorkCounter W>
  void inside(const Box& box, std::vector<Id>& out, W& work) const {
    Checks::check_box(box, "box");
    out.clear();
    append_inside(box, out, work);
  }

  // ---- batches ----------------------------------------------------------------------------------------

  /// The answers of query i are out[i·k] … out[i·k + k - 1].
  void nearest(std::span<const Point> queries, std::size_t k, std::span<Neighbor<T>> out,
               int threads = 1) const {
    nearest(queries, k, NearestOptions<T>{}, out, threads);
  }
  void nearest(std::span<const Point> queries, std::size_t k, const NearestOptions<T>& options,
               std::span<Neighbor<T>> out, int threads = 1) const {
    Checks::check_k(k);
    Checks::check_options(options);
    Checks::check_queries(queries);
    Checks::check_rows(out.size(), queries.size(), k);
    const std::size_t m = std::min(k, size());
    parallel_ranges(queries.size(), threads, [&](std::size_t begin, std::size_t end) {
      NoWork work;
      if constexpr (Tree::searches_itself)
        if (m == k && !set_.reach(options.max_distance).widely)
          return find_nearest_groups(queries.subspan(begin, end - begin), k, options, out.subspan(begin * k));
      for (std::size_t i = begin; i < end; ++i) {
        const auto answers = out.subspan(i * k, k);
        const std::size_t found = find_nearest(queries[i], options, answers.first(m), work);
        std::ranges::fill(answers.subspan(found), Neighbor<T>{});
      }
    });
  }
  /// The k nearest others of each point itself: those of the point with id i are out[i·k] … out[i·k + k - 1],
  /// padded like a batch's; rows of points that were dropped stay empty. Asked in the order in which the tree
  /// keeps the points, so that neighbours share the caches.
  void nearest_of_all(std::size_t k, std::span<Neighbor<T>> out, int threads = 1) const {
    static_assert(Tree::keeps_each_point_once, "a tree that copies points has no order of its own to ask in");
    Checks::check_k(k);
    const std::size_t rows = size() + stats_.dropped;
    if (rows > 0 && out.size() / k < rows)
      throw InvalidInput("out holds " + std::to_string(out.size()) + " answers; it must hold " +
                         std::to_string(k) + " for each of " + std::to_string(rows) + " points");
    std::ranges::fill(out.first(rows * k), Neighbor<T>{});
    parallel_ranges(size(), threads, [&](std::size_t begin, std::size_t end) {
      std::vector<Point> points;
      std::vector<Id> ids;
      std::vector<Neighbor<T>> found;
      for (std::size_t next; begin < end; begin = next) {
        next = std::min(end, begin + batch_chunk);
        points.clear(), ids.clear();
        for (std::size_t i = begin; i < next; ++i) {
          const PointEntry<T, D> e = tree().stored(i);
          points.push_back(set_.original(e)), ids.push_back(e.id);
        }
        found.resize(points.size() * (k + 1));
        nearest(points, k + 1, std::span(found));
        for (std::size_t i = 0; i < points.size(); ++i) {
          const auto row = std::span(found).subspan(i * (k + 1), k + 1);
          // Itself is among them unless k + 1 others at the same place have lower ids.
          const auto itself =
              std::find_if(row.begin(), row.end() - 1, [&](const auto& n) { return n.id == ids[i]; });
          auto to = out.begin() + static_cast<std::ptrdiff_t>(ids[i] * k);
          to = std::copy(row.begin(), itself, to);
          std::copy(itself + 1, row.end(), to);
        }
      }
    });
  }
  void within(std::span<const Point> queries, T radius, Lists<Neighbor<T>>& out, int threads = 1) const {
    Checks::check_radius(radius);
    Checks::check_queries(queries);
    parallel_lists(queries.size(), threads, out, [&](std::size_t i, std::vector<Neighbor<T>>& list) {
      NoWork work;
      append_within(queries[i], radius, list, work);
    });
  }
  void inside(std::span<const Box> boxes, Lists<Id>& out, int threads = 1) const {
    Checks::check_boxes(boxes);
    parallel_lists(boxes.size(), threads, out, [&](std::size_t i, std::vector<Id>& list) {
      NoWork work;
      append_inside(boxes[i], list, work);
    });
  }

  // ---- what the tree tells of itself ------------------------------------------------------------------

  std::size_t size() const { return stats_.primitives; }
  std::size_t bytes() const { return stats_.bytes; }
  TreeStats stats() const { return stats_; }
  /// How its points are measured: the same for every tree over the same points.
  const PointMeasure<T, D>& measure() const { return set_; }
  /// Of the points kept; empty if there are none.
  Box box() const { return set_.original_box(); }

 protected:
  PointQueries(std::span<const Point> points, const BuildOptions& options) : set_(points, options) {
    stats_.primitives = stats_.references = set_.entries.size();
    stats_.dropped = set_.dropped;
  }

  PointSet<T, D> set_;
  TreeStats stats_;

 private:
  using Wide = SquareOf<T>;
  static constexpr std::size_t few = 128;  // so many neighbours searches keep without a heap, or nearly so

  const Tree& tree() const { return static_cast<const Tree&>(*this); }
  /// The i-th point as the tree keeps it, in scaled coordinates.
  PointEntry<T, D> stored(std::size_t i) const { return set_.entries[i]; }

  template <class W>
  std::size_t find_nearest(const Point& q, const NearestOptions<T>& options, std::span<Neighbor<T>> out,
                           W& work) const {
    if (out.empty()) return 0;
    if (const Reach<T> reach = set_.reach(options.max_distance); reach.widely) [[unlikely]]
      return rank_widely({set_, q}, reach, out, work);
    const Point scaled = set_.scaled(q);
    const SearchLimits<T> limits = limits_of(options);
    if constexpr (Tree::searches_itself)
      tree().search_nearest(scaled, limits, out, work);
    else if (out.size() <= SortedBest<T>::largest_k)
      collect(scaled, SortedBest<T>(out, limits.within), limits, work);
    else
      collect(scaled, HeapBest<T>(out, limits.within), limits, work);
    return settle(q, scaled, limits.within, out, work);
  }
  template <class Best, class W>
  void collect(const Point& scaled, Best best, const SearchLimits<T>& limits, W& work) const {
    if (limits.exact) {
      tree().visit_near(scaled, best, work);
    } else {
      Hasty<T, Best> hasty(best, limits.shrink, limits.leaves, limits.fills());
      tree().visit_near(scaled, hasty, work);
    }
    best.finish();
  }
  /// Several queries at once, so that one computes while others wait for memory.
  void find_nearest_groups(std::span<const Point> queries, std::size_t k, const NearestOptions<T>& options,
                           std::span<Neighbor<T>> out) const {
    NoWork work;
    const SearchLimits<T> limits = limits_of(options);
    Point scaled[Tree::group_size];
    for (std::size_t first = 0; first < queries.size(); first += Tree::group_size) {
      const std::size_t count = std::min(Tree::group_size, queries.size() - first);
      for (std::size_t i = 0; i < count; ++i) scaled[i] = set_.scaled(queries[first + i]);
      const auto answers = out.subspan(first * k, count * k);
      tree().search_nearest_group(std::span<const Point>(scaled, count), k, limits, answers);
      for (std::size_t i = 0; i < count; ++i)
        settle(queries[first + i], scaled[i], limits.within, answers.subspan(i * k, k), work);
    }
  }
  /// From scaled distances to true ones, and from places not taken to empty ones; returns how many were
  /// taken. Those that T cannot rank are ranked anew, and no others.
  template <class W>
  std::size_t settle(const Point& q, const Point& scaled, T within, std::span<Neighbor<T>> out,
                     W& work) const {
    std::size_t found = out.size();
    while (found > 0 && out[found - 1].id == no_id) out[--found] = {};
    if (found == 0) return 0;
    std::size_t ranked = 0;
    if (overflows(out[found - 1].distance2)) [[unlikely]] {
      ranked = rank_widely({set_, q}, {.square = within}, out.first(found), work);
    } else if (is_vague(out.front().distance2) && set_.is_small(scaled)) [[unlikely]] {
      while (ranked < found && is_vague(out[ranked].distance2)) ++ranked;
      rank_widely({set_, q}, {.square = std::min(within, std::nextafter(vague_square<T>(), T(0)))},
                  out.first(ranked), work);
    }
    if (set_.scale != T(1))
      for (auto& n : out.subspan(ranked, found - ranked)) n.distance2 = set_.unscaled_square(n.distance2);
    return found;
  }
  /// The best by rank within reach; returns how many there are.
  template <class W>
  std::size_t rank_widely(const WideQuery<T, D>& q, const Reach<T>& reach, std::span<Neighbor<T>> out,
                          W& work) const {
    std::vector<Neighbor<Wide>> ranked(out.size());
    BestCandidates<T, D> best(q, reach, ranked);
    if constexpr (Tree::ranks_itself)
      tree().visit_best(best, work);
    else
      tree().visit_near(q.scaled, best, work);
    best.finish();
    std::size_t found = 0;
    for (; found < ranked.size() && ranked[found].id != no_id; ++found)
      out[found] = {q.told_square(ranked[found].distance2), ranked[found].id};
    return found;
  }
  SearchLimits<T> limits_of(const NearestOptions<T>& options) const {
    const double stretch = 1 + options.epsilon;
    // Stretched by what the squared distances of a cell's point and of the worst found may be off, either
    // way. Never 0: times an infinite distance it would be NaN.
    const double shrink =
        (1 + 2 * static_cast<double>(geometry::tolerance::gamma<T>(D + 4))) / (stretch * stretch);
    return {set_.reach(options.max_distance).square,
            std::clamp(static_cast<T>(shrink), std::numeric_limits<T>::min(), T(1)), options.max_leaves,
            options.exact()};
  }
  /// All within reach, with their ranks.
  template <class W>
  std::vector<Neighbor<Wide>> all_within(const WideQuery<T, D>& q, const Reach<T>& reach, W& work) const {
    Candidates<T, D> near(q, reach);
    tree().visit_near(q.scaled, near, work);
    return std::move(near.list);
  }
  /// The at_most nearest within reach, nearest first.
  template <class W>
  void rank_within(const Point& p, const Reach<T>& reach, std::size_t at_most, std::vector<Neighbor<T>>& out,
                   W& work) const {
    const WideQuery<T, D> q(set_, p);
    out.clear();
    if (at_most < size()) {
      out.resize(at_most);
      return out.resize(out.empty() ? 0 : rank_widely(q, reach, out, work));
    }
    std::vector<Neighbor<Wide>> list = all_within(q, reach, work);
    std::sort(list.begin(), list.end());
    for (const auto& c : list) out.push_back({q.told_square(c.distance2), c.id});
  }
  /// Those at the query's very place.
  template <class W>
  void append_at(const Point& q, std::vector<Neighbor<T>>& out, W& work) const {
    std::vector<Id> ids;
    append_inside({q, q}, ids, work);
    for (const Id id : ids) out.push_back({T(0), id});
  }
  template <class W>
  void append_within(const Point& p, T radius, std::vector<Neighbor<T>>& out, W& work) const {
    if (size() == 0) return;
    if (radius == 0) return append_at(p, out, work);
    const Reach<T> reach = set_.reach(radius);
    if (reach.widely) [[unlikely]] {
      const WideQuery<T, D> q(set_, p);
      for (const auto& c : all_within(q, reach, work)) out.push_back({q.told_square(c.distance2), c.id});
      return;
    }
    const std::size_t before = out.size();
    const Point scaled = set_.scaled(p);
    append_scaled(scaled, reach.square, out, work);
    const std::vector<Neighbor<T>> wide = taken_widely(p, scaled, reach, before, out, work);
    if (set_.scale != T(1))
      for (std::size_t i = before; i < out.size(); ++i)
        out[i].distance2 = set_.unscaled_square(out[i].distance2);
    out.insert(out.end(), wide.begin(), wide.end());
  }
  /// Takes out of a list, from a place on, those whose scaled squares overflow, or have lost digits that the
  /// wider type keeps, and returns them with the squares that settle() gives them. What is in the list is
  /// looked at only where there may be such.
  template <class W>
  std::vector<Neighbor<T>> taken_widely(const Point& p, const Point& scaled, const Reach<T>& reach,
                                        std::size_t from, std::vector<Neighbor<T>>& out, W& work) const {
    std::vector<Neighbor<T>> told;
    const bool small = set_.is_small(scaled), huge = std::isinf(reach.square);
    if (!small && !huge) return told;
    const auto first = out.begin() + static_cast<std::ptrdiff_t>(from);
    bool any_huge = false, any_small = false;
    for (auto n = first; n != out.end(); ++n)
      any_huge |= overflows(n->distance2), any_small |= small && is_vague(n->distance2);
    if (!any_huge && !any_small) return told;
    out.erase(std::remove_if(first, out.end(),
                             [&](const Neighbor<T>& n) { return any_huge || is_vague(n.distance2); }),
              out.end());
    const T limit = any_huge ? reach.square : std::nextafter(vague_square<T>(), T(0));
    const WideQuery<T, D> q(set_, p);
    for (const auto& c : all_within(q, {.square = limit}, work))
      told.push_back({q.told_square(c.distance2), c.id});
    return told;
  }
  /// With distances in scaled coordinates.
  template <class W>
  void append_scaled(const Point& scaled, T limit, std::vector<Neighbor<T>>& out, W& work) const {
    if constexpr (Tree::searches_itself) {
      tree().search_within(scaled, limit, out, work);
    } else {
      WithinRadius<T> visitor(limit, out);
      tree().visit_near(scaled, visitor, work);
    }
  }
  template <class W>
  void append_inside(const Box& box, std::vector<Id>& out, W& work) const {
    if (size() == 0) return;
    // A point is inside if its scaled coordinates are between the bounds' as real numbers; where scaling took
    // digits, the original ones decide.
    const bool lossy = !set_.originals.empty();
    Box b;
    for (int a = 0; a < D; ++a) {
      b.low[a] = scaled_bound(box.low[a], !lossy, T(1)), b.high[a] = scaled_bound(box.high[a], !lossy, T(-1));
    }
    // Clipped to the cloud's box, so that infinite sides become finite.
    b = geometry::intersection(b, set_.box);
    if (b.empty()) return;
    const std::size_t before = out.size();
    if constexpr (Tree::searches_itself)
      tree().search_inside(b, out, work);
    else
      tree().visit_box(
          b,
          [&](const PointLeaf& leaf) {
            const auto* e = set_.entries.data() + leaf.first;
            work.primitive(leaf.coincident ? 1 : leaf.count);
            if (leaf.coincident && !b.contains(e->point)) return;
            for (const auto* const end = e + leaf.count; e != end; ++e)
              if (leaf.coincident || b.contains(e->point)) out.push_back(e->id);
          },
          work);
    if (lossy) [[unlikely]]
      out.erase(std::remove_if(out.begin() + static_cast<std::ptrdiff_t>(before), out.end(),
                               [&](Id id) { return !box.contains(set_.originals[id]); }),
                out.end());
  }
  /// The bound times the scale: to nearest, which is monotone; or, where that has lost digits, the next
  /// number in the direction of `side` if `inward`, so that no scaled coordinate lies between it and the true
  /// product.
  T scaled_bound(T bound, bool inward, T side) const {
    const T nearest = bound * set_.scale;
    if (!inward || std::isinf(bound)) return nearest;
    const T back = nearest * set_.inverse_scale;  // exact where nothing was lost
    const bool outside = side > 0 ? back < bound : back > bound;
    return outside ? std::nextafter(nearest, side * std::numeric_limits<T>::infinity()) : nearest;
  }
};

}  // namespace treeline::accel
