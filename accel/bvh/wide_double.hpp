// The wide tree over points in double: leaves of doubles below nodes whose boxes are floats.
//
// Boxes are measured from an origin of their own, the median of the cloud, and rounded outward, so that float
// resolves what lies near it however far from zero the cloud is. Distances to them are lower bounds and prune
// as they do in the float tree, at its cost; leaves, and whatever floats cannot settle, are measured in
// double, so answers are those of brute force bit for bit. The exact boxes are kept beside: they settle ties
// and near ties one child at a time, and stand in for the floats wherever those are too coarse for a query:
// in a part of the cloud that is farther from the origin than 2^20 typical leaves, and from afar. Search:
// wide_double_search.hpp. Memory: 28 + 1.8 + 3 bytes a point in three dimensions.
//
// The builder of the float tree sorts the points in float. What rounding made equal is told apart by the
// doubles, and runs too small for their place are measured anew from their own centre, so that the splits are
// those of the doubles: exact by rank, at the price of the float build and of one gather.
#pragma once

#include "accel/bvh/wide_build.hpp"

namespace treeline::accel::wide {

/// Lower and upper bounds by at most two units in the last place, never denormal as the machine reads it.
inline float float_below(double x) {
  if (x >= 0x1p127) return 0x1.fffffep126f;
  if (x <= -0x1p127) return -infinity;
  const auto f = static_cast<float>(x);
  return f - std::abs(f) * 0x1p-23f - std::numeric_limits<float>::min();
}
inline float float_above(double x) { return -float_below(-x); }

/// Local coordinates of ordinary points are about 2^this: their squares keep their digits down to gaps 2^-70
/// times as small, and are finite up to 2^50 times as far.
inline constexpr int local_exponent = 12;

/// Local coordinates, of which floats are made: relative to an origin, scaled by a power of two.
template <int D>
struct Frame {
  using Point = geometry::Vec<double, D>;
  Point origin{};
  double scale = 1;  // its square, too, is finite and normal

  void fit(double size) {
    if (size > 0) scale = std::ldexp(1.0, std::clamp(local_exponent - std::ilogb(size), -500, 500));
  }
  /// Off by half a unit in the last place: far less than what float_below and float_above add.
  double local(const Point& p, int axis) const { return (p[axis] - origin[axis]) * scale; }
  geometry::Vec<float, D> rounded(const Point& p) const {
    geometry::Vec<float, D> r;
    for (int a = 0; a < D; ++a) r[a] = static_cast<float>(std::clamp(local(p, a), -0x1p100, 0x1p100));
    return r;
  }
};

template <int D>
Frame<D> frame_of(std::span<const PointEntry<double, D>> entries, const geometry::Box<double, D>& box) {
  Frame<D> frame;
  if (entries.empty()) return frame;
  std::vector<double> x;
  const auto median = [&] {
    const auto middle = x.begin() + static_cast<std::ptrdiff_t>(x.size() / 2);
    std::nth_element(x.begin(), middle, x.end());
    return *middle;
  };
  const std::size_t step = entries.size() / 1024 + 1;
  for (int a = 0; a < D; ++a) {
    x.clear();
    for (std::size_t i = 0; i < entries.size(); i += step) x.push_back(entries[i].point[a]);
    frame.origin[a] = median();
  }
  x.clear();
  for (std::size_t i = 0; i < entries.size(); i += step) {
    double away = 0;
    for (int a = 0; a < D; ++a) away = std::max(away, std::abs(entries[i].point[a] - frame.origin[a]));
    if (away > 0) x.push_back(away);
  }
  frame.fit(x.empty() ? box.extent()[box.widest_axis()] : median());
  return frame;
}

template <int D>
struct alignas(64) ExactNode {
  double low[D][lanes], high[D][lanes];
};

template <int D>
struct DoubleTree : Tree<D, double> {
  using Base = Tree<D, double>;
  using Box = geometry::Box<double, D>;

  AlignedArray<ExactNode<D>> exact;  // beside each node
  Frame<D> frame;
  Box box;           // of all points
  double reach = 0;  // floats resolve leaves this far from the origin (local)

  DoubleTree() = default;
  DoubleTree(std::span<const PointEntry<double, D>> entries, const Box& all)
      : Base(entries.size()), exact(this->nodes.size()), frame(frame_of(entries, all)), box(all) {}
  const ExactNode<D>& exact_of(const Node<D>& node) const {
    return exact[static_cast<std::size_t>(&node - this->nodes.data())];
  }
  std::size_t bytes() const { return Base::bytes() + exact.bytes(); }
};

template <int D>
void set_child(DoubleTree<D>& tree, int level, std::size_t number, const geometry::Box<double, D>& box,
               Id first_id) {
  ExactNode<D>& parent = tree.exact[tree.first_node[static_cast<std::size_t>(level)] + number / lanes];
  geometry::Box<float, D> rounded;
  for (int a = 0; a < D; ++a) {
    parent.low[a][number % lanes] = box.low[a], parent.high[a][number % lanes] = box.high[a];
    rounded.low[a] = float_below(tree.frame.local(box.low, a));
    rounded.high[a] = float_above(tree.frame.local(box.high, a));
  }
  set_child(static_cast<Tree<D, double>&>(tree), level, number, rounded, first_id);
}
template <int D>
geometry::Box<double, D> child_box(const DoubleTree<D>& tree, int level, std::size_t number) {
  const ExactNode<D>& parent = tree.exact[tree.first_node[static_cast<std::size_t>(level)] + number / lanes];
  geometry::Box<double, D> box;
  for (int a = 0; a < D; ++a)
    box.low[a] = parent.low[a][number % lanes], box.high[a] = parent.high[a][number % lanes];
  return box;
}

/// The builder's source: entries hold a point's number in place of its id.
template <int D>
class RoundedPoints {
 public:
  static constexpr bool rounded = true;
  using Entry = PointEntry<float, D>;

  explicit RoundedPoints(std::span<const PointEntry<double, D>> points) : points_(points) {}
  const geometry::Vec<double, D>& point(const Entry& e) const { return points_[e.id].point; }
  Id id(const Entry& e) const { return points_[e.id].id; }
  /// Equal ones by id, so that the lowest lie together.
  bool less(const Entry& a, const Entry& b, int axis) const {
    const double x = point(a)[axis], y = point(b)[axis];
    return x < y || (x == y && a.id < b.id);
  }

  /// Whether a run's box has fewer than 2^12 steps of rounding along its widest side.
  static bool vague(const geometry::Box<float, D>& box) {
    float size = 0, farthest = 0;
    for (int a = 0; a < D; ++a) {
      size = std::max(size, box.high[a] - box.low[a]);
      farthest = std::max({farthest, std::abs(box.low[a]), std::abs(box.high[a])});
    }
    return size <= farthest * 0x1p-12f;
  }
  /// Measures a run from its centre; returns its box.
  geometry::Box<float, D> rebase(std::span<Entry> run) const {
    geometry::Box<double, D> exact;
    for (const Entry& e : run) exact.grow(point(e));
    Frame<D> frame{exact.centre()};
    frame.fit(exact.extent()[exact.widest_axis()]);
    geometry::Box<float, D> box;
    for (Entry& e : run) e.point = frame.rounded(point(e)), box.grow(e.point);
    return box;
  }

 private:
  std::span<const PointEntry<double, D>> points_;
};

/// How far from the origin floats resolve the leaves: 2^20 times the median of their widest sides.
template <int D>
double resolved_reach(const DoubleTree<D>& tree) {
  if (tree.top == 0) return std::numeric_limits<double>::infinity();  // no boxes at all
  std::vector<double> sides;
  const std::size_t leaves = tree.leaves.size();
  for (std::size_t i = 0; i < leaves; i += leaves / 1024 + 1) {
    const geometry::Vec<double, D> extent = child_box(tree, 1, i).extent();
    const double side = extent[geometry::largest_axis(extent)];
    if (side > 0) sides.push_back(side);
  }
  if (sides.empty()) return 0;
  const auto middle = sides.begin() + static_cast<std::ptrdiff_t>(sides.size() / 2);
  std::nth_element(sides.begin(), middle, sides.end());
  return *middle * tree.frame.scale * 0x1p20;
}

template <int D>
DoubleTree<D> built(const PointSet<double, D>& set, bool by_perimeter, int threads) {
  const std::span<const PointEntry<double, D>> points(set.entries);
  DoubleTree<D> tree(points, set.box);
  std::unique_ptr<PointEntry<float, D>[]> entries(new PointEntry<float, D>[points.size()]);
  for (std::size_t i = 0; i < points.size(); ++i)
    entries[i] = {tree.frame.rounded(points[i].point), static_cast<Id>(i)};
  Builder<D, DoubleTree<D>, RoundedPoints<D>>({entries.get(), points.size()}, by_perimeter, threads,
                                              RoundedPoints<D>(points))
      .build(tree);
  tree.reach = resolved_reach(tree);
  return tree;
}
/// Empties the set's entries.
template <int D>
Tree<D> built(PointSet<float, D>& set, bool by_perimeter, int threads) {
  Tree<D> tree(set.entries.size());
  Builder<D>(set.entries, by_perimeter, threads).build(tree);
  return tree;
}

template <int D, class T>
using TreeOver = std::conditional_t<std::is_same_v<T, float>, Tree<D>, DoubleTree<D>>;

}  // namespace treeline::accel::wide
