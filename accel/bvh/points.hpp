// Bounding volume hierarchy over points: an inner node holds tight bounds of its two children.
//
// Bounds: boxes, or balls (Omohundro 1989). Split rules: rank, the median along the widest side of the box
// (balanced, full leaves); or the binned surface area heuristic (Wald 2007), which follows the shape of
// uneven clouds. In a plane perimeters take the place of areas, and beyond three dimensions the sum of the
// sides. Cost: O(n log n) to build, O(log n + k) expected per query in low dimension, 16 + 64/fill bytes a
// point with boxes, 16 + 48/fill with balls (float, 3-D; fill is the mean count of a leaf). Known weakness: a
// scalar traversal measures two bounds a step, where a KD tree subtracts one number: slower where points fill
// space evenly. Balls bound worse than boxes wherever points lie flat, and take a square root each.
#pragma once

#include <array>
#include <optional>

#include "accel/bvh/ball.hpp"
#include "accel/point_build.hpp"
#include "accel/point_queries.hpp"
#include "accel/slice.hpp"

namespace treeline::accel {

struct BvhPointOptions : BuildOptions {
  enum class Split { rank, sah } split = Split::rank;
  enum class Bounds { box, ball } bounds = Bounds::box;
};

template <class T, int D>
class Bvh<Points<T, D>> : public PointQueries<Bvh<Points<T, D>>, T, D> {
  using Base = PointQueries<Bvh, T, D>;

 public:
  using typename Base::Box;
  using typename Base::Point;
  using Options = BvhPointOptions;

  explicit Bvh(std::span<const Point> points, Options options = {});

  /// The leaves' bounds, which do not cover the gaps between. Boxes do not overlap inside; balls do, and
  /// reach beyond the cloud's box.
  std::vector<SliceCell> slice(int axis, double offset) const;

 private:
  friend Base;
  using Base::set_;
  using Base::stats_;
  using Entry = PointEntry<T, D>;

  struct Child {
    std::uint32_t first;       // inner: node; leaf: first entry
    std::uint32_t count : 31;  // leaf: entries; inner: 0
    std::uint32_t coincident : 1;

    bool leaf() const { return count > 0; }
    PointLeaf points() const { return {first, count, coincident == 1}; }
  };
  template <class Bound>
  struct Node {  // with boxes one cache line for float in 3-D
    Bound bounds[2];
    Child children[2];
  };
  template <class Bound>
  using Nodes = std::vector<Node<Bound>>;

  template <class Bound>
  Child build(Nodes<Bound>& nodes, std::size_t first, std::size_t last, const Box& box, std::size_t depth,
              const Options& options);
  std::size_t sah_cut(std::size_t first, std::size_t last, const Box& box);

  bool balls() const { return !balls_.empty(); }
  template <class Visitor, class W>
  void visit_near(const Point& q, Visitor& visitor, W& work) const {
    balls() ? visit_near(balls_, q, visitor, work) : visit_near(boxes_, q, visitor, work);
  }
  template <class Leaf, class W>
  void visit_box(const Box& box, Leaf&& leaf, W& work) const {
    balls() ? visit_box(balls_, box, leaf, work) : visit_box(boxes_, box, leaf, work);
  }
  template <class Bound, class Visitor, class W>
  void visit_near(const Nodes<Bound>& nodes, const Point& q, Visitor& visitor, W& work) const;
  template <class Bound, class Leaf, class W>
  void visit_box(const Nodes<Bound>& nodes, const Box& box, Leaf&& leaf, W& work) const;
  template <class Bound>
  void add_cells(const Nodes<Bound>& nodes, const SlicePlane<D>& plane, std::vector<SliceCell>& cells) const;

  Nodes<Box> boxes_;  // one of the two is empty
  Nodes<Ball<T, D>> balls_;
  Child root_{};
};

// ---- build ---------------------------------------------------------------------------------------------

template <class T, int D>
Bvh<Points<T, D>>::Bvh(std::span<const Point> points, Options options) : Base(points, options) {
  const std::size_t n = set_.entries.size();
  if (n > 0) {
    const auto grow = [&](auto& nodes) {
      nodes.reserve(2 * (n / static_cast<std::size_t>(options.leaf_size)));
      root_ = build(nodes, 0, n, set_.box, 0, options);
      nodes.shrink_to_fit();
    };
    options.bounds == Options::Bounds::ball ? grow(balls_) : grow(boxes_);
  }
  stats_.bytes = sizeof(*this) + set_.bytes() + boxes_.capacity() * sizeof(Node<Box>) +
                 balls_.capacity() * sizeof(Node<Ball<T, D>>);
}

template <class T, int D>
template <class Bound>
auto Bvh<Points<T, D>>::build(Nodes<Bound>& nodes, std::size_t first, std::size_t last, const Box& box,
                              std::size_t depth, const Options& options) -> Child {
  const std::size_t count = last - first;
  const bool coincident = box.low == box.high;
  const double share = std::is_same_v<Bound, Box> ? line_share(box, set_.box) : 0;
  if (coincident || count <= static_cast<std::size_t>(options.leaf_size)) {
    if (coincident) sort_by_id(set_, first, last);
    add_leaf(stats_, count, depth, share);
    return {static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(count), coincident};
  }
  const bool free = depth < static_cast<std::size_t>(free_depth(set_.entries.size()));
  const std::size_t middle = free && options.split == Options::Split::sah
                                 ? sah_cut(first, last, box)
                                 : halve(set_, first, last, box.widest_axis()).middle;
  add_inner(stats_, share);
  const std::size_t index = nodes.size();
  nodes.emplace_back();
  for (int side = 0; side < 2; ++side) {
    const std::size_t from = side ? middle : first, to = side ? last : middle;
    const Box part = box_of(set_, from, to);
    if constexpr (std::is_same_v<Bound, Box>)
      nodes[index].bounds[side] = part;
    else
      nodes[index].bounds[side] = ball_of(set_, from, to, part);
    const Child child = build(nodes, from, to, part, depth + 1, options);
    nodes[index].children[side] = child;
  }
  return {static_cast<std::uint32_t>(index), 0, 0};
}

/// Partitions at the cheapest border between bins, over all axes; both sides get at least one point.
template <class T, int D>
std::size_t Bvh<Points<T, D>>::sah_cut(std::size_t first, std::size_t last, const Box& box) {
  constexpr int bins = 16;
  const auto bin_of = [&](const Point& p, int axis) {
    const T share =
        (p[axis] - box.low[axis]) / (box.high[axis] - box.low[axis]);  // in [0, 1], even for tiny sides
    return std::min(bins - 1, static_cast<int>(share * T(bins)));
  };
  // Flat clouds have areas yet; those on a line along an axis have none, and are measured by length.
  const double unit = longest_side(box);
  const bool by_area = surface(box, unit) > 0;
  const auto measure = [&](const Box& b) { return by_area ? surface(b, unit) : longest_side(b) / unit; };

  double best_cost = std::numeric_limits<double>::infinity();
  int best_axis = -1, best_border = 0;
  for (int axis = 0; axis < D; ++axis) {
    if (!(box.low[axis] < box.high[axis])) continue;
    std::array<Box, bins> boxes{};
    std::array<std::size_t, bins> counts{};
    for (std::size_t i = first; i < last; ++i) {
      const int b = bin_of(set_.entries[i].point, axis);
      boxes[static_cast<std::size_t>(b)].grow(set_.entries[i].point), ++counts[static_cast<std::size_t>(b)];
    }
    // The cost of all bins from a border on, then that of those before it.
    std::array<double, bins> above{};
    Box sum;
    std::size_t count = 0;
    for (std::size_t b = bins; b-- > 1;) {
      sum.grow(boxes[b]), count += counts[b];
      above[b] = count == 0 ? 0 : measure(sum) * static_cast<double>(count);
    }
    sum = {}, count = 0;
    for (std::size_t b = 1; b < bins; ++b) {
      sum.grow(boxes[b - 1]), count += counts[b - 1];
      const double cost = above[b] + measure(sum) * static_cast<double>(count);
      if (cost < best_cost) best_cost = cost, best_axis = axis, best_border = static_cast<int>(b);
    }
  }
  const auto begin = set_.entries.begin();
  const auto middle =
      std::partition(begin + static_cast<std::ptrdiff_t>(first), begin + static_cast<std::ptrdiff_t>(last),
                     [&](const Entry& e) { return bin_of(e.point, best_axis) < best_border; });
  return static_cast<std::size_t>(middle - begin);
}

// ---- queries -------------------------------------------------------------------------------------------

template <class T, int D>
template <class Bound, class Visitor, class W>
void Bvh<Points<T, D>>::visit_near(const Nodes<Bound>& nodes, const Point& q, Visitor& visitor,
                                   W& work) const {
  struct Far {
    T bound;
    Child child;
  };
  Far stack[max_depth];
  int waiting = 0;

  if (this->size() == 0) return;
  Far here{squared_distance(set_.box, q), root_};
  if (here.bound > visitor.limit()) return;
  while (true) {
    work.node();
    while (!here.child.leaf()) {
      const Node<Bound>& node = nodes[here.child.first];
      const T left = squared_distance(node.bounds[0], q), right = squared_distance(node.bounds[1], q);
      const bool swap = second_first(node.bounds, q, left, right);
      stack[waiting] = {swap ? left : right, node.children[swap ? 0 : 1]};
      here = {swap ? right : left, node.children[swap ? 1 : 0]};
      if (stack[waiting].bound <= visitor.limit()) ++waiting;
      if (here.bound > visitor.limit()) break;
      work.node();
    }
    if (here.child.leaf() && here.bound <= visitor.limit()) set_.offer(here.child.points(), q, visitor, work);
    do {
      if (waiting == 0) return;
      here = stack[--waiting];
    } while (here.bound > visitor.limit());
  }
}

template <class T, int D>
template <class Bound, class Leaf, class W>
void Bvh<Points<T, D>>::visit_box(const Nodes<Bound>& nodes, const Box& box, Leaf&& leaf, W& work) const {
  Child stack[max_depth];
  int waiting = 0;
  Child here = root_;
  while (true) {
    work.node();
    if (here.leaf()) {
      leaf(here.points());
    } else {
      const Node<Bound>& node = nodes[here.first];
      const bool left = node.bounds[0].overlaps(box), right = node.bounds[1].overlaps(box);
      if (left && right) stack[waiting++] = node.children[1];
      if (left || right) {
        here = node.children[left ? 0 : 1];
        continue;
      }
    }
    if (waiting == 0) return;
    here = stack[--waiting];
  }
}

// ---- pictures ------------------------------------------------------------------------------------------

template <class T, int D>
std::vector<SliceCell> Bvh<Points<T, D>>::slice(int axis, double offset) const {
  const SlicePlane<D> plane(axis, offset * static_cast<double>(set_.scale));
  std::vector<SliceCell> cells;
  balls() ? add_cells(balls_, plane, cells) : add_cells(boxes_, plane, cells);
  return scaled(std::move(cells), static_cast<double>(set_.inverse_scale));
}

template <class T, int D>
template <class Bound>
void Bvh<Points<T, D>>::add_cells(const Nodes<Bound>& nodes, const SlicePlane<D>& plane,
                                  std::vector<SliceCell>& cells) const {
  const auto visit = [&](const auto& self, const Child& child, const auto& bound, std::size_t depth) -> void {
    if (!plane.cuts(bound)) return;
    if (child.leaf()) {
      cells.push_back({plane.outline(bound), depth, child.count});
      return;
    }
    const Node<Bound>& node = nodes[child.first];
    for (int side = 0; side < 2; ++side) self(self, node.children[side], node.bounds[side], depth + 1);
  };
  visit(visit, root_, set_.box, 0);
}

static_assert(NeighborIndex<Bvh<Points<float, 3>>> && Inspectable<Bvh<Points<float, 3>>>);
static_assert(NeighborIndex<Bvh<Points<double, 2>>> && Inspectable<Bvh<Points<double, 2>>>);

}  // namespace treeline::accel
