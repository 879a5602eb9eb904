// What the builders of the point trees share: boxes of runs, order within equal points, the book of
// statistics.
#pragma once

#include "accel/point_set.hpp"

namespace treeline::accel {

template <class T, int D>
geometry::Box<T, D> box_of(const PointSet<T, D>& set, std::size_t first, std::size_t last) {
  geometry::Box<T, D> box;
  for (std::size_t i = first; i < last; ++i) box.grow(set.entries[i].point);
  return box;
}

template <class T, int D>
void sort_by_id(PointSet<T, D>& set, std::size_t first, std::size_t last) {
  const auto begin = set.entries.begin();
  std::sort(begin + static_cast<std::ptrdiff_t>(first), begin + static_cast<std::ptrdiff_t>(last),
            [](const auto& a, const auto& b) { return a.id < b.id; });
}

/// Reorders a run so that its first half lies below or on the cut along the axis, the second half above or on
/// it. A cut by rank always halves, whatever is equal.
template <class T>
struct AxisCut {
  int axis;
  T offset;
  std::size_t middle;  // the first entry above
};
template <class T, int D>
AxisCut<T> halve(PointSet<T, D>& set, std::size_t first, std::size_t last, int axis) {
  const auto less = [axis](const auto& a, const auto& b) { return a.point[axis] < b.point[axis]; };
  const auto from = set.entries.begin() + static_cast<std::ptrdiff_t>(first);
  const auto to = set.entries.begin() + static_cast<std::ptrdiff_t>(last);
  const auto middle = from + (to - from) / 2;
  std::nth_element(from, middle, to, less);
  const T below = std::max_element(from, middle, less)->point[axis], above = middle->point[axis];
  return {axis, below + (above - below) / T(2), first + (last - first) / 2};
}

/// Surface area of a box, half the perimeter in a plane, beyond three dimensions the sum of the sides; in
/// units of `unit`, so that it neither overflows nor vanishes.
template <class T, int D>
double surface(const geometry::Box<T, D>& box, double unit) {
  geometry::Vec<double, D> e;
  for (int a = 0; a < D; ++a)
    e[a] = box.empty() ? 0 : (static_cast<double>(box.high[a]) - static_cast<double>(box.low[a])) / unit;
  if constexpr (D == 3) return 2 * (e[0] * e[1] + e[1] * e[2] + e[2] * e[0]);
  double sum = 0;
  for (int a = 0; a < D; ++a) sum += e[a];
  return sum;
}
template <class T, int D>
double longest_side(const geometry::Box<T, D>& box) {
  const int a = box.widest_axis();
  return static_cast<double>(box.high[a]) - static_cast<double>(box.low[a]);
}

/// The chance that a random line through the whole also meets the part; 0 where lines have no such measure.
template <class T, int D>
double line_share(const geometry::Box<T, D>& part, const geometry::Box<T, D>& whole) {
  if (D != 3) return 0;
  const double unit = longest_side(whole);
  const double all = unit > 0 ? surface(whole, unit) : 0;
  return all > 0 ? surface(part, unit) / all : 0;
}

inline void add_inner(TreeStats& stats, double share) {
  ++stats.inner_nodes;
  stats.sah_cost += share;
}
inline void add_leaf(TreeStats& stats, std::size_t count, std::size_t depth, double share) {
  ++stats.leaves;
  stats.depth = std::max(stats.depth, depth);
  stats.largest_leaf = std::max(stats.largest_leaf, count);
  stats.sah_cost += share * static_cast<double>(count);
}

}  // namespace treeline::accel
