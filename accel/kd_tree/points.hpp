// KD tree over points (Bentley 1975): an inner node cuts space by one axis-aligned plane.
//
// Split rules: sliding midpoint (Maneewongvatana and Mount 1999), which keeps cells fat and is fast wherever
// points are spread evenly; or the median along the widest side of the points' box (Friedman, Bentley and
// Finkel 1977), which balances. A query descends to its own cell first and returns to the others while they
// are near enough. Bounds: planes, the distance per axis to the cuts between (Arya and Mount 1993), which
// cost no memory; or tight boxes, where a node keeps the box of its points, too, and is judged by it, as in a
// BVH. Cost: O(n log n) to build, O(log n + k) expected per query in low dimension, 16 + 32/fill bytes a
// point (float, 3-D; fill is the mean count of a leaf); boxes add 48/fill bytes and a second memory access a
// node. Known weakness: planes bound badly where points fill little of their cells (surfaces seen from off
// the surface), above all with median splits, whose cells are long: there a query visits hundreds of leaves
// where boxes let it visit tens.
#pragma once

#include "accel/point_build.hpp"
#include "accel/point_queries.hpp"
#include "accel/slice.hpp"

namespace treeline::accel {

struct KdPointOptions : BuildOptions {
  enum class Split { sliding_midpoint, median } split = Split::sliding_midpoint;
  enum class Bounds { planes, tight_box } bounds = Bounds::planes;
};

template <class T, int D>
class KdTree<Points<T, D>> : public PointQueries<KdTree<Points<T, D>>, T, D> {
  using Base = PointQueries<KdTree, T, D>;

 public:
  using typename Base::Box;
  using typename Base::Point;
  using Options = KdPointOptions;

  explicit KdTree(std::span<const Point> points, Options options = {});

  /// Cells tile the cloud's box. See SlicePlane for what is cut.
  std::vector<SliceCell> slice(int axis, double offset) const;

 private:
  friend Base;
  using Base::set_;
  using Base::stats_;
  using Entry = PointEntry<T, D>;

  /// An inner node has its left child right behind it; points left are <= offset on the axis, right >=
  /// offset.
  struct Node {
    T offset;
    std::uint32_t axis;   // leaf_axis, coincident_axis: a leaf
    std::uint32_t first;  // inner: right child; leaf: first entry
    std::uint32_t count;  // leaf: entries

    bool leaf() const { return axis >= leaf_axis; }
    PointLeaf points() const { return {first, count, axis == coincident_axis}; }
  };
  static constexpr std::uint32_t leaf_axis = D, coincident_axis = D + 1;

  void build(std::size_t first, std::size_t last, Box cell, std::size_t depth, const Options& options);
  AxisCut<T> midpoint_cut(std::size_t first, std::size_t last, const Box& cell, const Box& tight);

  template <class Visitor, class W>
  void visit_near(const Point& q, Visitor& visitor, W& work) const {
    if (nodes_.empty()) return;
    if (boxes_.empty())
      visit_by_planes(q, visitor, work);
    else
      visit_by_boxes(q, visitor, work);
  }
  template <class Visitor, class W>
  void visit_by_planes(const Point& q, Visitor& visitor, W& work) const;
  template <class Visitor, class W>
  void visit_by_boxes(const Point& q, Visitor& visitor, W& work) const;
  template <class Leaf, class W>
  void visit_box(const Box& box, Leaf&& leaf, W& work) const;

  std::vector<Node> nodes_;
  std::vector<Box> boxes_;  // of each node's points; empty if planes bound
};

// ---- build ---------------------------------------------------------------------------------------------

template <class T, int D>
KdTree<Points<T, D>>::KdTree(std::span<const Point> points, Options options) : Base(points, options) {
  const std::size_t n = set_.entries.size();
  if (n > 0) {
    nodes_.reserve(2 * (n / static_cast<std::size_t>(options.leaf_size)) + 1);
    if (options.bounds == Options::Bounds::tight_box) boxes_.reserve(nodes_.capacity());
    build(0, n, set_.box, 0, options);
    nodes_.shrink_to_fit(), boxes_.shrink_to_fit();
  }
  stats_.bytes =
      sizeof(*this) + set_.bytes() + nodes_.capacity() * sizeof(Node) + boxes_.capacity() * sizeof(Box);
}

template <class T, int D>
void KdTree<Points<T, D>>::build(std::size_t first, std::size_t last, Box cell, std::size_t depth,
                                 const Options& options) {
  const std::size_t count = last - first, index = nodes_.size();
  const Box tight = box_of(set_, first, last);
  const bool coincident = tight.low == tight.high;
  const bool boxed = options.bounds == Options::Bounds::tight_box;
  const double share = line_share(boxed ? tight : cell, set_.box);
  nodes_.emplace_back();
  if (boxed) boxes_.push_back(tight);
  if (coincident || count <= static_cast<std::size_t>(options.leaf_size)) {
    if (coincident) sort_by_id(set_, first, last);
    nodes_[index] = {T(0), coincident ? coincident_axis : leaf_axis, static_cast<std::uint32_t>(first),
                     static_cast<std::uint32_t>(count)};
    return add_leaf(stats_, count, depth, share);
  }
  const bool free = depth < static_cast<std::size_t>(free_depth(set_.entries.size()));
  const AxisCut<T> cut = free && options.split == Options::Split::sliding_midpoint
                             ? midpoint_cut(first, last, cell, tight)
                             : halve(set_, first, last, tight.widest_axis());
  add_inner(stats_, share);
  Box left = cell, right = cell;
  left.high[cut.axis] = right.low[cut.axis] = cut.offset;
  build(first, cut.middle, left, depth + 1, options);
  nodes_[index] = {cut.offset, static_cast<std::uint32_t>(cut.axis),
                   static_cast<std::uint32_t>(nodes_.size()), 0};
  build(cut.middle, last, right, depth + 1, options);
}

template <class T, int D>
AxisCut<T> KdTree<Points<T, D>>::midpoint_cut(std::size_t first, std::size_t last, const Box& cell,
                                              const Box& tight) {
  // The longest side of the cell along which the points can be told apart at all.
  int axis = -1;
  for (int a = 0; a < D; ++a)
    if (tight.low[a] < tight.high[a] && (axis < 0 || cell.extent()[a] > cell.extent()[axis])) axis = a;
  const T offset = std::clamp(cell.centre()[axis], tight.low[axis], tight.high[axis]);
  // Points on the cut may go either way: as many left as makes the halves most equal.
  const auto begin = set_.entries.begin();
  const auto from = begin + static_cast<std::ptrdiff_t>(first),
             to = begin + static_cast<std::ptrdiff_t>(last);
  const auto below = std::partition(from, to, [&](const Entry& e) { return e.point[axis] < offset; });
  const auto on = std::partition(below, to, [&](const Entry& e) { return e.point[axis] == offset; });
  const auto middle = std::clamp(from + (to - from) / 2, below, on);
  return {axis, offset, static_cast<std::size_t>(middle - begin)};
}

// ---- queries -------------------------------------------------------------------------------------------

// The bound of a cell is squared_length of the distances per axis from q to the nearest cut between: every
// point of a cell beyond a cut is at least as far along that axis, so see there why nothing is lost to
// rounding. They are kept per axis and added anew at each step, since adding a new cut and subtracting the
// old would round twice.
template <class T, int D>
template <class Visitor, class W>
void KdTree<Points<T, D>>::visit_by_planes(const Point& q, Visitor& visitor, W& work) const {
  struct Far {
    std::uint32_t node;
    T bound, offsets[D];
  };
  Far stack[max_depth];
  int waiting = 0;

  Far here;
  here.node = 0;
  for (int a = 0; a < D; ++a) here.offsets[a] = interval_offset(set_.box.low[a], set_.box.high[a], q[a]);
  here.bound = squared_length<T, D>(here.offsets);
  if (here.bound > visitor.limit()) return;
  while (true) {
    const Node* node = &nodes_[here.node];
    work.node();
    while (!node->leaf()) {
      const T ahead = q[static_cast<int>(node->axis)] - node->offset;
      const std::uint32_t left = static_cast<std::uint32_t>(node - nodes_.data()) + 1;
      Far& far = stack[waiting];
      for (int a = 0; a < D; ++a) far.offsets[a] = here.offsets[a];
      far.offsets[node->axis] = std::abs(ahead);
      far.bound = squared_length<T, D>(far.offsets);
      far.node = ahead > 0 ? left : node->first;
      if (far.bound <= visitor.limit()) ++waiting;
      node = &nodes_[ahead > 0 ? node->first : left];
      work.node();
    }
    set_.offer(node->points(), q, visitor, work);
    do {
      if (waiting == 0) return;
      here = stack[--waiting];
    } while (here.bound > visitor.limit());
  }
}

// A tight box lies within its cell on every axis, so that it bounds at least as well as the planes, as
// computed, too: they only say where to go first between boxes equally near.
template <class T, int D>
template <class Visitor, class W>
void KdTree<Points<T, D>>::visit_by_boxes(const Point& q, Visitor& visitor, W& work) const {
  struct Far {
    T bound;
    std::uint32_t node;
  };
  Far stack[max_depth];
  int waiting = 0;
  Far here{squared_distance(boxes_[0], q), 0};
  if (here.bound > visitor.limit()) return;
  while (true) {
    const Node* node = &nodes_[here.node];
    work.node();
    while (!node->leaf()) {
      const std::uint32_t left = here.node + 1, right = node->first;
      const T to_left = squared_distance(boxes_[left], q), to_right = squared_distance(boxes_[right], q);
      const bool swap =
          to_right < to_left || (to_right == to_left && q[static_cast<int>(node->axis)] > node->offset);
      stack[waiting] = swap ? Far{to_left, left} : Far{to_right, right};
      here = swap ? Far{to_right, right} : Far{to_left, left};
      if (stack[waiting].bound <= visitor.limit()) ++waiting;
      if (here.bound > visitor.limit()) break;
      node = &nodes_[here.node];
      work.node();
    }
    if (here.bound <= visitor.limit()) set_.offer(node->points(), q, visitor, work);
    do {
      if (waiting == 0) return;
      here = stack[--waiting];
    } while (here.bound > visitor.limit());
  }
}

template <class T, int D>
template <class Leaf, class W>
void KdTree<Points<T, D>>::visit_box(const Box& box, Leaf&& leaf, W& work) const {
  std::uint32_t stack[max_depth];
  int waiting = 0;
  std::uint32_t index = 0;
  while (true) {
    const Node& node = nodes_[index];
    work.node();
    if (!boxes_.empty() && !boxes_[index].overlaps(box)) {
      // Nothing of it is inside, although its cell meets the box.
    } else if (node.leaf()) {
      leaf(node.points());
    } else {
      const int axis = static_cast<int>(node.axis);
      const bool left = box.low[axis] <= node.offset, right = box.high[axis] >= node.offset;
      if (left && right) stack[waiting++] = node.first;
      if (left || right) {
        index = left ? index + 1 : node.first;
        continue;
      }
    }
    if (waiting == 0) return;
    index = stack[--waiting];
  }
}

// ---- pictures ------------------------------------------------------------------------------------------

template <class T, int D>
std::vector<SliceCell> KdTree<Points<T, D>>::slice(int axis, double offset) const {
  const SlicePlane<D> plane(axis, offset * static_cast<double>(set_.scale));
  std::vector<SliceCell> cells;
  if (!plane.cuts(set_.box)) return cells;
  const auto visit = [&](const auto& self, std::size_t index, const Box& cell, std::size_t depth) -> void {
    const Node& node = nodes_[index];
    if (node.leaf()) {
      cells.push_back({plane.outline(cell), depth, node.count});
      return;
    }
    const int a = static_cast<int>(node.axis);
    Box left = cell, right = cell;
    left.high[a] = right.low[a] = node.offset;
    // A plane along the cut belongs to the right side only, so that nothing is drawn twice.
    const bool along = D == 3 && a == plane.axis, is_left = plane.offset < static_cast<double>(node.offset);
    if (!along || is_left) self(self, index + 1, left, depth + 1);
    if (!along || !is_left) self(self, node.first, right, depth + 1);
  };
  visit(visit, 0, set_.box, 0);
  return scaled(std::move(cells), static_cast<double>(set_.inverse_scale));
}

static_assert(NeighborIndex<KdTree<Points<float, 3>>> && Inspectable<KdTree<Points<float, 3>>>);
static_assert(NeighborIndex<KdTree<Points<double, 2>>> && Inspectable<KdTree<Points<double, 2>>>);

}  // namespace treeline::accel
