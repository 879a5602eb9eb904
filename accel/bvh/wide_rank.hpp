// The wide tree over points where squared distances vanish or overflow: the best of BestCandidates.
//
// Boxes are measured in the candidates' wider type, nearest first, equally near ones by the lowest id below,
// so that a pile of equal points, or points that no type tells apart, costs one path to a leaf and not the
// pile. Cost: some 2 ns a box in double, 10 in long double; queries come here rarely. Known weakness: no
// vectors.
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

  /// `p`: the query as the tree takes it.
  Ranking(const TreeOver<D, T>& tree, const Point& p, Best& best, W& work)
      : tree_(tree), p_(p), best_(best), work_(work) {}

  void run() { tree_.top == 0 ? take(0) : enter(tree_.top, 0); }

 private:
  struct Child {
    typename Best::Wide distance2;
    Id first_id;
    std::size_t number;
    bool operator<(const Child& o) const {
      return distance2 < o.distance2 || (distance2 == o.distance2 && first_id < o.first_id);
    }
  };

  void enter(int level, std::size_t at) {
    work_.node();
    Child children[lanes];
    int count = 0;
    const std::size_t first = at * lanes, last = std::min(first + lanes, tree_.size(level - 1));
    for (std::size_t i = first; i < last; ++i) {
      const Child child{rank_of<T>(wide_distance2(child_box(tree_, level, i), best_.query())),
                        tree_.level(level)[at].first_id[i - first], i};
      if (best_.wants(child.distance2, child.first_id)) children[count++] = child;
    }
    std::sort(children, children + count);
    for (int i = 0; i < count && best_.wants(children[i].distance2, children[i].first_id); ++i)
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
