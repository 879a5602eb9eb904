// Wide bounding volume hierarchy over points: the fastest index here for neighbours in two and three
// dimensions, on every kind of cloud.
//
// 16 child boxes a node and 16 points a leaf, both measured by one pass of vector instructions; no pointers;
// full leaves. Boxes visit fewer leaves than the cells of a KD tree, and with vectors a box costs no more
// than a plane: wide nodes do for neighbours what they do for single rays (Wald, Benthin and Boulos 2008).
// Layout, tags and exactness are described in wide_layout.hpp, wide_search.hpp and wide_build.hpp. Cost: O(n
// log n) to build, O(log n + k) expected per query, 16 + 1.9 bytes a point in three dimensions (its own copy
// of the points included; large trees are rounded up to huge pages). Doubles are searched by boxes of floats,
// and measured as doubles (wide_double.hpp): 28 + 4.9 bytes. Known weakness: a single query waits for memory
// at every level, batches hide that; at more than a few dimensions boxes stop pruning.
#pragma once

#include "accel/bvh/wide_double_search.hpp"
#include "accel/bvh/wide_rank.hpp"
#include "accel/point_build.hpp"
#include "accel/point_queries.hpp"
#include "accel/slice.hpp"

namespace treeline::accel {

struct WidePointOptions {
  /// rank builds fastest; perimeter visits fewest leaves (up to a quarter fewer on uneven clouds).
  enum class Split { rank, perimeter } split = Split::rank;
  NonFinite non_finite = NonFinite::refuse;
  int threads = 1;  ///< that build; the tree does not depend on it
};

template <class T, int D>
class Bvh<Points<T, D>, Wide> : public PointQueries<Bvh<Points<T, D>, Wide>, T, D> {
  using Base = PointQueries<Bvh, T, D>;

 public:
  using typename Base::Box;
  using typename Base::Point;
  using Options = WidePointOptions;
  static constexpr bool searches_itself = true, ranks_itself = true;
  static constexpr std::size_t group_size = 8;

  /// Throws InvalidInput for points that are not finite (unless they are to be dropped), more points than ids
  /// can number, or threads < 1.
  explicit Bvh(std::span<const Point> points, Options options = {});

  /// The leaves' boxes; they do not overlap inside, nor do they cover the gaps between.
  std::vector<SliceCell> slice(int axis, double offset) const;

 private:
  friend Base;
  using Base::set_;
  using Base::stats_;
  using Found = Neighbor<T>;

  using Limits = SearchLimits<T>;

  template <class W>
  void search_nearest(const Point& q, const Limits& limits, std::span<Found> out, W& work) const;
  void search_nearest_group(std::span<const Point> queries, std::size_t k, const Limits& limits,
                            std::span<Found> out) const;
  template <class Best, class W>
  void search_from(const wide::Query<D, T>& q, wide::Path<D>& path, const Limits& limits,
                   std::span<Found> out, W& work) const;
  std::size_t count_within_limit(const Point& q, T limit) const;
  template <class W>
  void search_within(const Point& q, T limit, std::vector<Found>& out, W& work) const;
  template <class W>
  void search_inside(const Box& box, std::vector<Id>& out, W& work) const;
  template <class Visitor, class W>
  void visit_near(const Point& q, Visitor& visitor, W& work) const;

  template <class W>
  void visit_best(BestCandidates<T, D>& best, W& work) const {
    if (this->size() > 0) wide::Ranking<D, T, W>(tree_, best, work).run();
  }

  template <class F>
  static void with_collector(std::size_t k, F&& f);
  PointEntry<T, D> stored(std::size_t i) const {
    const wide::Leaf<D, T>& leaf = tree_.leaves[i / wide::lanes];
    PointEntry<T, D> e;
    for (int a = 0; a < D; ++a) e.point[a] = leaf.x[a][i % wide::lanes];
    e.id = leaf.id[i % wide::lanes];
    return e;
  }
  Box leaf_box(std::size_t leaf) const;
  void count();

  wide::TreeOver<D, T> tree_;
};

// ---- build ---------------------------------------------------------------------------------------------

template <class T, int D>
Bvh<Points<T, D>, Wide>::Bvh(std::span<const Point> points, Options options)
    : Base(points, BuildOptions{options.non_finite}) {
  check_threads(options.threads);
  tree_ = wide::built(set_, options.split == Options::Split::perimeter, options.threads);
  set_.entries = {};  // the leaves have it all
  count();
}

template <class T, int D>
void Bvh<Points<T, D>, Wide>::count() {
  const std::size_t leaves = tree_.leaves.size();
  for (std::size_t i = 0; i < leaves; ++i) {
    const std::size_t points = std::min<std::size_t>(wide::lanes, this->size() - i * wide::lanes);
    add_leaf(stats_, points, static_cast<std::size_t>(tree_.top), line_share(leaf_box(i), set_.box));
  }
  for (int l = 1; l <= tree_.top; ++l)
    for (std::size_t i = 0; i < tree_.size(l); ++i) {
      Box box;
      const std::size_t last = std::min((i + 1) * wide::lanes, tree_.size(l - 1));
      for (std::size_t j = i * wide::lanes; j < last; ++j) box.grow(wide::child_box(tree_, l, j));
      add_inner(stats_, line_share(box, set_.box));
    }
  stats_.bytes = sizeof(*this) + tree_.bytes();
}

template <class T, int D>
auto Bvh<Points<T, D>, Wide>::leaf_box(std::size_t leaf) const -> Box {
  return tree_.top == 0 ? set_.box : wide::child_box(tree_, 1, leaf);
}

// ---- queries -------------------------------------------------------------------------------------------

/// Calls f with a tag of the collector that is fastest for k.
template <class T, int D>
template <class F>
void Bvh<Points<T, D>, Wide>::with_collector(std::size_t k, F&& f) {
  using namespace wide;
  if constexpr (std::is_same_v<T, float>) {
    if (k == 1) return f(std::type_identity<NearestOne>{});
    if (k <= 8) return f(std::type_identity<NearestFew<simd::SortedKeys<8>>>{});
    if (k <= 16) return f(std::type_identity<NearestFew<simd::SortedKeys<16>>>{});
    if (k <= 32) return f(std::type_identity<NearestFew<simd::SortedKeys<32>>>{});
    if (k <= simd::LongKeys::largest_k) return f(std::type_identity<NearestFew<simd::LongKeys>>{});
    f(std::type_identity<NearestMany>{});
  } else {
    if (k == 1) return f(std::type_identity<Nearest<D, OneBest>>{});
    if (k <= 8) return f(std::type_identity<Nearest<D, simd::SortedPairs<8>>>{});
    if (k <= 16) return f(std::type_identity<Nearest<D, simd::SortedPairs<16>>>{});
    if (k <= 32) return f(std::type_identity<Nearest<D, simd::SortedPairs<32>>>{});
    if (k <= SortedBest<T>::largest_k) return f(std::type_identity<Nearest<D, ManyBest<SortedBest<T>>>>{});
    f(std::type_identity<Nearest<D, ManyBest<HeapBest<T>>>>{});
  }
}

template <class T, int D>
template <class Best, class W>
void Bvh<Points<T, D>, Wide>::search_from(const wide::Query<D, T>& q, wide::Path<D>& path,
                                          const Limits& limits, std::span<Found> out, W& work) const {
  const auto find = [&](Best best) {
    if (limits.exact)
      wide::search<true>(tree_, q, path, best, {}, work);
    else
      wide::search<false>(tree_, q, path, best, {wide::shrink_of(limits), limits.leaves, limits.fills()},
                          work);
    if constexpr (std::is_same_v<T, float>)
      best.write(out);
    else
      best.finish();
  };
  if constexpr (std::is_same_v<T, float>)
    find(Best(out.size(), limits.within));
  else
    find(Best(q, out, limits.within));
}

template <class T, int D>
template <class W>
void Bvh<Points<T, D>, Wide>::search_nearest(const Point& p, const Limits& limits, std::span<Found> out,
                                             W& work) const {
  with_collector(out.size(), [&]<class Best>(std::type_identity<Best>) {
    const auto& place = wide::placed(tree_, p);
    const auto q = wide::query_of(tree_, place);
    wide::Path<D> path;
    for (int level = tree_.top; level > 0; --level) wide::descend(tree_, q, level, path, work);
    search_from<Best>(q, path, limits, out, work);
  });
}

template <class T, int D>
void Bvh<Points<T, D>, Wide>::search_nearest_group(std::span<const Point> queries, std::size_t k,
                                                   const Limits& limits, std::span<Found> out) const {
  NoWork work;
  with_collector(k, [&]<class Best>(std::type_identity<Best>) {
    wide::Placed<D, T> places[group_size];
    for (std::size_t i = 0; i < queries.size(); ++i) places[i] = wide::placed(tree_, queries[i]);
    wide::Path<D> paths[group_size];
    for (int level = tree_.top; level > 0; --level)
      for (std::size_t i = 0; i < queries.size(); ++i) {
        wide::descend(tree_, wide::query_of(tree_, places[i]), level, paths[i], work);
        wide::prefetch_children(tree_, level, paths[i].at / wide::lanes, 1u << paths[i].at % wide::lanes);
      }
    for (std::size_t i = 0; i < queries.size(); ++i)
      search_from<Best>(wide::query_of(tree_, places[i]), paths[i], limits, out.subspan(i * k, k), work);
  });
}

template <class T, int D>
std::size_t Bvh<Points<T, D>, Wide>::count_within_limit(const Point& p, T limit) const {
  const auto& place = wide::placed(tree_, p);
  const auto q = wide::query_of(tree_, place);
  const auto limits = wide::Lanes<T>::broadcast(limit);
  NoWork work;
  std::size_t count = 0;
  wide::visit(
      tree_, [&](const wide::Node<D>& node) { return wide::classify<true>(node, q, limit); },
      [&](std::size_t leaf) {
        count += static_cast<std::size_t>(
            std::popcount(simd::bits_le(wide::distances(tree_.leaves[leaf], q), limits)));
      },
      [&](std::size_t first, std::size_t last) {
        count += std::min(last * wide::lanes, this->size()) - first * wide::lanes;
      },
      work);
  return count;
}

template <class T, int D>
template <class W>
void Bvh<Points<T, D>, Wide>::search_within(const Point& p, T limit, std::vector<Found>& out, W& work) const {
  const auto& place = wide::placed(tree_, p);
  const auto q = wide::query_of(tree_, place);
  const auto limits = wide::Lanes<T>::broadcast(limit);
  wide::Appender<Found> found(out);
  if (std::isinf(limit)) {  // all there are: distances that overflow, too, but not the absent points
    work.node(), work.primitive(this->size());
    for (std::size_t i = 0; i < this->size(); ++i) {
      const PointEntry<T, D> e = stored(i);
      *found.room() = {squared_distance(e.point, p), e.id};
      found.taken(1);
    }
    return;
  }
  wide::visit(
      tree_, [&](const wide::Node<D>& node) { return wide::classify<false>(node, q, limit); },
      [&](std::size_t number) {
        const wide::Leaf<D, T>& leaf = tree_.leaves[number];
        const auto d = wide::distances(leaf, q);
        work.primitive(wide::lanes);
        found.taken(simd::store_set(simd::bits_le(d, limits), d, leaf.id, found.room()));
      },
      [](std::size_t, std::size_t) {}, work);
}

template <class T, int D>
template <class W>
void Bvh<Points<T, D>, Wide>::search_inside(const Box& box, std::vector<Id>& out, W& work) const {
  wide::Appender<Id> found(out);
  const auto& place = wide::placed(tree_, box);
  wide::visit(
      tree_, [&](const wide::Node<D>& node) { return wide::classify(tree_, node, place); },
      [&](std::size_t number) {
        const wide::Leaf<D, T>& leaf = tree_.leaves[number];
        work.primitive(wide::lanes);
        found.taken(simd::store_set(wide::points_inside(leaf, box), leaf.id, found.room()));
      },
      [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
          work.node();  // read, though not measured
          std::copy_n(tree_.leaves[i].id, wide::lanes, found.room());
          found.taken(std::min<std::size_t>(wide::lanes, this->size() - i * wide::lanes));
        }
      },
      work);
}

/// For visitors that take entries: leaves nearest first on each node, whatever the visitor measures.
template <class T, int D>
template <class Visitor, class W>
void Bvh<Points<T, D>, Wide>::visit_near(const Point& p, Visitor& visitor, W& work) const {
  if (this->size() == 0) return;
  const auto& place = wide::placed(tree_, p);
  const auto q = wide::query_of(tree_, place);
  wide::visit(
      tree_, [&](const wide::Node<D>& node) { return wide::classify<false>(node, q, visitor.limit()); },
      [&](std::size_t number) {
        const wide::Leaf<D, T>& leaf = tree_.leaves[number];
        work.primitive(wide::lanes);
        for (std::size_t i = 0; i < wide::lanes && leaf.id[i] != no_id; ++i) {
          const PointEntry<T, D> e = stored(number * wide::lanes + i);
          visitor.offer(e, squared_distance(e.point, p));
        }
      },
      [](std::size_t, std::size_t) {}, work);
}

// ---- pictures ------------------------------------------------------------------------------------------

template <class T, int D>
std::vector<SliceCell> Bvh<Points<T, D>, Wide>::slice(int axis, double offset) const {
  const SlicePlane<D> plane(axis, offset * static_cast<double>(set_.scale));
  std::vector<SliceCell> cells;
  for (std::size_t i = 0; i < tree_.leaves.size(); ++i) {
    const Box box = leaf_box(i);
    if (plane.cuts(box))
      cells.push_back({plane.outline(box), static_cast<std::size_t>(tree_.top),
                       std::min<std::size_t>(wide::lanes, this->size() - i * wide::lanes)});
  }
  return scaled(std::move(cells), static_cast<double>(set_.inverse_scale));
}

static_assert(NeighborIndex<Bvh<Points<float, 3>, Wide>> && Inspectable<Bvh<Points<float, 3>, Wide>>);
static_assert(NeighborIndex<Bvh<Points<float, 2>, Wide>> && Inspectable<Bvh<Points<float, 2>, Wide>>);
static_assert(NeighborIndex<Bvh<Points<double, 3>, Wide>> && Inspectable<Bvh<Points<double, 3>, Wide>>);

}  // namespace treeline::accel
