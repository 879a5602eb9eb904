// The wide tree over points where squared distances vanish or overflow: the best of BestCandidates.
//
// Boxes are ranked as points are, nearest first, equally near ones by the lowest id below, so that a pile of
// equal points, or points that no type tells apart, costs one path to a leaf and not the pile. Cost: some 2
// ns a box in double, 10 in long double; queries come here rarely. Known weakness: no vectors.
#pragma once

#include <algorithm>

#include "accel/bvh/wide_double.hpp"
#include "accel/candidates.hpp"

namespace treeline::accel::wide {

template <int D, class T, class W>
class Ranking {
 public:
  using Best = BestCandidates<T, D>;
  using Point = geometry::Vec<T, D>;

  Ranking(const TreeOver<D, T>& tree, Best& best, W& work)
      : tree_(tree), p_(best.query().scaled), best_(best), work_(work) {}

  void run() { tree_.top == 0 ? take(0) : enter(tree_.top, 0); }

 private:
  struct Child {
    T distance2;
    typename Best::Wide wide, rank;
    Id first_id;
    std::size_t number;
    bool operator<(const Child& o) const {
      return rank < o.rank || (rank == o.rank && first_id < o.first_id);
    }
  };
  bool wants(const Child& c) const { return best_.wants(c.distance2, c.wide, c.first_id); }

  void enter(int level, std::size_t at) {
    work_.node();
    const WideQuery<T, D>& query = best_.query();
    Child children[lanes];
    int count = 0;
    const std::size_t first = at * lanes, last = std::min(first + lanes, tree_.size(level - 1));
    for (std::size_t i = first; i < last; ++i) {
      const auto box = child_box(tree_, level, i);
      const T distance2 = squared_distance(box, p_);
      const auto wide = query.set.wide_square(box, query.wide);
      const Child child{distance2, wide, query.rank(distance2, wide),
                        tree_.level(level)[at].first_id[i - first], i};
      if (wants(child)) children[count++] = child;
    }
    std::sort(children, children + count);
    for (int i = 0; i < count && wants(children[i]); ++i)
      level == 1 ? take(children[i].number) : enter(level - 1, children[i].number);
  }
  void take(std::size_t number) {
    work_.node(), work_.primitive(lanes);
    const Leaf<D, T>& leaf = tree_.leaves[number];
    for (int i = 0; i < lanes && leaf.id[i] != no_id; ++i) {
      PointEntry<T, D> e;
      for (int a = 0; a < D; ++a) e.point[a] = leaf.x[a][i];
      e.id = leaf.id[i];
      best_.offer(e, squared_distance(e.point, p_));
    }
  }

  const TreeOver<D, T>& tree_;
  const Point& p_;
  Best& best_;
  W& work_;
};

}  // namespace treeline::accel::wide
