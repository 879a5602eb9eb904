// Searches of the wide tree over points in double: what wide_search.hpp needs to know of such a query.
//
// A query's local coordinates are rounded to floats on either side of it, and each side of a box is measured
// from the nearer one. With low_f <= low and q <= q_f, fl(low_f - q_f) <= fl(low - q): what floats say of a
// box is at most what real numbers say of a point in it, times (1 + u)^(D + 2) for the difference, its square
// (which counts it twice), its rounding and D - 1 sums. The limit is inflated by as much, by the far smaller
// error of the limit itself, which doubles computed, and by a smallest float for what underflow takes. So no
// true neighbour is cut off; how many boxes are entered in vain is bounded by one check of the exact box for
// those that rounding leaves open.
//
// Where floats are too coarse (see wide_double.hpp), distances of the exact boxes take their place, less that
// of the cloud's box, which is large from afar and says nothing: all of it monotone under rounding, so that
// no slack is needed.
#pragma once

#include "accel/bvh/wide_double.hpp"
#include "accel/bvh/wide_search.hpp"
#include "accel/point_queries.hpp"
#include "accel/simd/sorted_pairs.hpp"

namespace treeline::accel::wide {

using simd::Doubles16;

template <int D>
struct PlacedPoint {
  geometry::Vec<double, D> point;
  float low[D], high[D];  // on either side of it, local
  float slack;            // of a float distance, about
  bool coarse;            // floats say too little here
  double base = 0;        // squared distance of the cloud's box; 0 unless coarse
};

template <int D>
PlacedPoint<D> placed(const DoubleTree<D>& tree, const geometry::Vec<double, D>& p) {
  PlacedPoint<D> r;
  r.point = p;
  double reach = 0;
  for (int a = 0; a < D; ++a) {
    const double x = tree.frame.local(p, a);
    r.low[a] = float_below(x), r.high[a] = float_above(x);
    reach = std::max(reach, std::abs(x));
  }
  r.slack = static_cast<float>(std::min(reach, 0x1p100)) * 0x1p-21f + 0x1p-50f;
  r.coarse = reach >= tree.reach;
  if (r.coarse) r.base = squared_distance(tree.box, p);
  if (!(r.base <= std::numeric_limits<double>::max())) r.base = 0;
  return r;
}
/// A float tree takes queries as they are.
template <int D>
const geometry::Vec<float, D>& placed(const Tree<D>&, const geometry::Vec<float, D>& p) {
  return p;
}
template <int D, class T>
using Placed = std::conditional_t<std::is_same_v<T, float>, geometry::Vec<float, D>, PlacedPoint<D>>;

template <int D>
struct Query<D, double> {
  const DoubleTree<D>& tree;
  const PlacedPoint<D>& place;
  Floats16 low[D], high[D];

  Query(const DoubleTree<D>& t, const PlacedPoint<D>& p) : tree(t), place(p) {
    for (int a = 0; a < D; ++a)
      low[a] = Floats16::broadcast(p.low[a]), high[a] = Floats16::broadcast(p.high[a]);
  }
  double scale2() const { return tree.frame.scale * tree.frame.scale; }
  /// What no box may exceed that holds a point within the squared distance.
  float node_limit(double limit) const {
    if (place.coarse) [[unlikely]]
      return static_cast<float>((limit - place.base) * scale2());
    constexpr double stretch = 1 + (D + 6) * 0x1p-24;
    return float_above(limit * scale2() * stretch) + std::numeric_limits<float>::min();
  }
  /// A box whose farthest corner floats find so near lies within.
  float inner_limit(double limit) const {
    constexpr double shrink = 1 - (D + 6) * 0x1p-24;
    return float_below(limit * scale2() * shrink) - std::numeric_limits<float>::min();
  }
  /// A box at least this near, as bits, needs no check.
  std::int32_t sure_limit(float node_limit) const {
    if (place.coarse) [[unlikely]]
      return (bits_of(node_limit) & ~simd::lane_mask) - 1;
    const float near = std::sqrt(node_limit) * (1 - 0x1p-20f) - place.slack;
    return near > 0 ? bits_of(near * near) : -1;
  }
};
template <int D>
Query<D> query_of(const Tree<D>&, const geometry::Vec<float, D>& p) {
  return Query<D>(p);
}
template <int D>
Query<D, double> query_of(const DoubleTree<D>& tree, const PlacedPoint<D>& p) {
  return {tree, p};
}

template <int D>
Doubles16 distances(const Leaf<D, double>& leaf, const Query<D, double>& q) {
  Doubles16 sum;
  for (int a = 0; a < D; ++a) {
    const Doubles16 d = Doubles16::load(leaf.x[a]) - Doubles16::broadcast(q.place.point[a]);
    sum = a == 0 ? d * d : sum + d * d;
  }
  return sum;
}

/// Of the exact boxes, in the terms of the query's node_limit.
template <int D>
[[gnu::noinline]] Floats16 coarse_distances(const Node<D>& node, const Query<D, double>& q) {
  const ExactNode<D>& exact = q.tree.exact_of(node);
  const Doubles16 zero = Doubles16::broadcast(0);
  Doubles16 sum;
  for (int a = 0; a < D; ++a) {
    const Doubles16 p = Doubles16::broadcast(q.place.point[a]);
    const Doubles16 d =
        simd::max(zero, simd::max(p - Doubles16::load(exact.high[a]), Doubles16::load(exact.low[a]) - p));
    sum = a == 0 ? d * d : sum + d * d;
  }
  alignas(64) double square[lanes];
  ((sum - Doubles16::broadcast(q.place.base)) * Doubles16::broadcast(q.scale2())).store(square);
  alignas(64) float rounded[lanes];
  for (int i = 0; i < lanes; ++i) rounded[i] = static_cast<float>(square[i]);
  return Floats16::load(rounded);
}

template <int D>
Floats16 distances(const Node<D>& node, const Query<D, double>& q) {
  if (q.place.coarse) [[unlikely]]
    return coarse_distances(node, q);
  const Floats16 zero = Floats16::broadcast(0);
  Floats16 sum;
  for (int a = 0; a < D; ++a) {
    const Floats16 right = q.low[a] - Floats16::load(node.high[a]),
                   left = Floats16::load(node.low[a]) - q.high[a];
    const Floats16 d = simd::max(zero, simd::max(right, left));
    sum = a == 0 ? d * d : sum + d * d;
  }
  return sum;
}

template <int D>
Floats16 farthest(const Node<D>& node, const Query<D, double>& q) {
  Floats16 sum;
  for (int a = 0; a < D; ++a) {
    const Floats16 right = q.high[a] - Floats16::load(node.low[a]),
                   left = Floats16::load(node.high[a]) - q.low[a];
    const Floats16 d = simd::max(right, left);
    sum = a == 0 ? d * d : sum + d * d;
  }
  return sum;
}

/// Children to visit for all points within a squared distance, and those that lie within (if `contained` asks
/// for them).
template <bool contained, int D>
Classified classify(const Node<D>& node, const Query<D>& q, float limit) {
  const auto limits = Floats16::broadcast(limit);
  // A box whose farthest corner is within holds nothing farther: rounding is monotone there, too.
  return {simd::bits_le(distances(node, q), limits),
          contained ? simd::bits_le(farthest(node, q), limits) : 0};
}
template <bool contained, int D>
Classified classify(const Node<D>& node, const Query<D, double>& q, double limit) {
  return {simd::bits_le(distances(node, q), Floats16::broadcast(q.node_limit(limit))),
          contained && !q.place.coarse
              ? simd::bits_le(farthest(node, q), Floats16::broadcast(q.inner_limit(limit)))
              : 0};
}

// ---- boxes ---------------------------------------------------------------------------------------------

template <int D>
struct PlacedBox {
  geometry::Box<double, D> box;
  geometry::Box<float, D> outer, inner;  // local
  bool coarse;
};
template <int D>
PlacedBox<D> placed(const DoubleTree<D>& tree, const geometry::Box<double, D>& box) {
  PlacedBox<D> r;
  r.box = box;
  double reach = 0;
  for (int a = 0; a < D; ++a) {
    const double low = tree.frame.local(box.low, a), high = tree.frame.local(box.high, a);
    r.outer.low[a] = float_below(low), r.inner.low[a] = float_above(low);
    r.outer.high[a] = float_above(high), r.inner.high[a] = float_below(high);
    reach = std::max({reach, std::abs(low), std::abs(high)});
  }
  r.coarse = reach >= tree.reach;
  return r;
}
template <int D>
const geometry::Box<float, D>& placed(const Tree<D>&, const geometry::Box<float, D>& box) {
  return box;
}

template <int D>
Classified classify(const DoubleTree<D>& tree, const Node<D>& node, const PlacedBox<D>& b) {
  Classified c{0xffff, 0xffff};
  for (int a = 0; a < D; ++a) {
    const auto add = [&]<class L>(const L& low, const L& high, auto outer_low, auto outer_high,
                                  auto inner_low, auto inner_high) {
      c.visit &= simd::bits_le(low, L::broadcast(outer_high)) & simd::bits_le(L::broadcast(outer_low), high);
      c.inside &= simd::bits_le(L::broadcast(inner_low), low) & simd::bits_le(high, L::broadcast(inner_high));
    };
    if (b.coarse) [[unlikely]] {
      const ExactNode<D>& exact = tree.exact_of(node);
      const double from = b.box.low[a], to = b.box.high[a];
      add(Doubles16::load(exact.low[a]), Doubles16::load(exact.high[a]), from, to, from, to);
    } else {
      add(Floats16::load(node.low[a]), Floats16::load(node.high[a]), b.outer.low[a], b.outer.high[a],
          b.inner.low[a], b.inner.high[a]);
    }
  }
  return c;
}
template <int D>
Classified classify(const Tree<D>&, const Node<D>& node, const geometry::Box<float, D>& box) {
  return classify(node, box);
}

/// The share of a float limit beyond which an approximate search leaves boxes out.
inline float shrink_of(const SearchLimits<float>& limits) { return limits.shrink; }
inline float shrink_of(const SearchLimits<double>& limits) { return float_above(limits.shrink); }

// ---- what a search for the k nearest collects ----------------------------------------------------------

/// One neighbour: the least of a leaf at once.
class OneBest {
 public:
  static constexpr int prefetched = 0;
  OneBest(std::span<Neighbor<double>> out, double within) : best_{within, no_id}, out_(out) {}
  const Neighbor<double>& worst() const { return best_; }
  void take(const Doubles16& distance2, const Id* ids) {
    const double least = simd::smallest(distance2);
    std::uint32_t there = simd::bits_le(distance2, Doubles16::broadcast(least));
    Neighbor<double> candidate{least, ids[std::countr_zero(there)]};
    while ((there &= there - 1) != 0) candidate.id = std::min(candidate.id, ids[std::countr_zero(there)]);
    if (candidate < best_) best_ = candidate;
  }
  void finish() { out_.front() = best_; }

 private:
  Neighbor<double> best_;
  std::span<Neighbor<double>> out_;
};

/// Many neighbours: a SortedBest or a HeapBest.
template <class List>
class ManyBest {
 public:
  static constexpr int prefetched = 2;
  ManyBest(std::span<Neighbor<double>> out, double within) : list_(out, within) {}
  const Neighbor<double>& worst() const { return list_.worst(); }
  void offer(double distance2, Id id) { list_.offer(distance2, id); }
  void finish() { list_.finish(); }

 private:
  List list_;
};

/// List: OneBest, simd::SortedPairs or ManyBest. `limit` and `sure` are the worst distance's in the query's
/// terms.
template <int D, class List>
class Nearest {
 public:
  static constexpr int prefetched = List::prefetched;
  Nearest(const Query<D, double>& q, std::span<Neighbor<double>> out, double within)
      : list_(out, within), q_(q) {
    update();
  }
  std::int32_t limit() const { return limit_; }
  std::int32_t sure() const { return sure_; }
  Id last_id() const { return worst_.id; }
  const Neighbor<double>& worst() const { return worst_; }
  void take(const Doubles16& distance2, const Id* ids) {
    std::uint32_t near = simd::bits_le(distance2, Doubles16::broadcast(worst_.distance2));
    if (near == 0) return;
    if constexpr (requires { list_.take(distance2, ids); }) {
      list_.take(distance2, ids);
    } else {
      alignas(64) double d[lanes];
      distance2.store(d);
      for (; near != 0; near &= near - 1) {
        const int i = std::countr_zero(near);
        list_.offer(d[i], ids[i]);
      }
    }
    update();
  }
  void finish() { list_.finish(); }

 private:
  void update() {
    worst_ = list_.worst();
    const float limit = q_.node_limit(worst_.distance2);
    limit_ = bits_of(limit), sure_ = q_.sure_limit(limit);
  }
  List list_;
  Neighbor<double> worst_;
  const Query<D, double>& q_;
  std::int32_t limit_, sure_;
};

template <int D, class List>
bool is_close(std::int32_t tagged, const Nearest<D, List>& best) {
  return tagged > best.sure();
}
template <int D, class List>
[[gnu::noinline]] bool matters(const Node<D>& node, const Query<D, double>& q, int lane,
                               const Nearest<D, List>& best) {
  const ExactNode<D>& exact = q.tree.exact_of(node);
  geometry::Box<double, D> box;
  for (int a = 0; a < D; ++a) box.low[a] = exact.low[a][lane], box.high[a] = exact.high[a][lane];
  const double distance2 = squared_distance(box, q.place.point), worst = best.worst().distance2;
  return distance2 < worst || (distance2 == worst && node.first_id[lane] < best.last_id());
}

}  // namespace treeline::accel::wide
