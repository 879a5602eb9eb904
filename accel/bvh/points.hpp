// Bounding volume hierarchy over points: an inner node holds the tight boxes of its two children.
//
// Split rules: rank, the median along the widest side of the box (balanced, full leaves); or the binned
// surface area heuristic (Wald 2007), which follows the shape of uneven clouds. In a plane perimeters take
// the place of areas, and beyond three dimensions the sum of the sides. Cost: O(n log n) to build, O(log n +
// k) expected per query in low dimension, 16 + 64/leaf bytes a point (float, 3-D). Known weakness: a scalar
// traversal measures two boxes a step, where a KD tree subtracts one number: slower where points fill space
// evenly.
#pragma once

#include <array>
#include <optional>

#include "accel/point_build.hpp"
#include "accel/point_queries.hpp"
#include "accel/slice.hpp"

namespace treeline::accel {

struct BvhPointOptions : BuildOptions {
  enum class Split { rank, sah } split = Split::rank;
};

template <class T, int D>
class Bvh<Points<T, D>> : public PointQueries<Bvh<Points<T, D>>, T, D> {
  using Base = PointQueries<Bvh, T, D>;

 public:
  using typename Base::Box;
  using typename Base::Point;
  using Options = BvhPointOptions;

  explicit Bvh(std::span<const Point> points, Options options = {});

  /// The leaves' boxes; they do not overlap inside, nor do they cover the gaps between.
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
  struct Node {  // one cache line for float in 3-D
    Box boxes[2];
    Child children[2];
  };

  Child build(std::size_t first, std::size_t last, const Box& box, std::size_t depth, const Options& options);
  std::size_t sah_cut(std::size_t first, std::size_t last, const Box& box);

  template <class Visitor, class W>
  void visit_near(const Point& q, Visitor& visitor, W& work) const;
  template <class Leaf, class W>
  void visit_box(const Box& box, Leaf&& leaf, W& work) const;

  std::vector<Node> nodes_;
  Child root_{};
};

// ---- build ---------------------------------------------------------------------------------------------

template <class T, int D>
Bvh<Points<T, D>>::Bvh(std::span<const Point> points, Options options) : Base(points, options) {
  const std::size_t n = set_.entries.size();
  if (n > 0) {
    nodes_.reserve(2 * (n / static_cast<std::size_t>(options.leaf_size)));
    root_ = build(0, n, set_.box, 0, options);
    nodes_.shrink_to_fit();
  }
  stats_.bytes = sizeof(*this) + set_.bytes() + nodes_.capacity() * sizeof(Node);
}

template <class T, int D>
auto Bvh<Points<T, D>>::build(std::size_t first, std::size_t last, const Box& box, std::size_t depth,
                              const Options& options) -> Child {
  const std::size_t count = last - first;
  const bool coincident = box.low == box.high;
  const double share = line_share(box, set_.box);
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
  const std::size_t index = nodes_.size();
  nodes_.push_back({{box_of(set_, first, middle), box_of(set_, middle, last)}, {}});
  for (int side = 0; side < 2; ++side) {
    const Box part = nodes_[index].boxes[side];
    const Child child = build(side ? middle : first, side ? last : middle, part, depth + 1, options);
    nodes_[index].children[side] = child;
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
template <class Visitor, class W>
void Bvh<Points<T, D>>::visit_near(const Point& q, Visitor& visitor, W& work) const {
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
      const Node& node = nodes_[here.child.first];
      const T left = squared_distance(node.boxes[0], q), right = squared_distance(node.boxes[1], q);
      const bool swap = right < left;
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
template <class Leaf, class W>
void Bvh<Points<T, D>>::visit_box(const Box& box, Leaf&& leaf, W& work) const {
  Child stack[max_depth];
  int waiting = 0;
  Child here = root_;
  while (true) {
    work.node();
    if (here.leaf()) {
      leaf(here.points());
    } else {
      const Node& node = nodes_[here.first];
      const bool left = node.boxes[0].overlaps(box), right = node.boxes[1].overlaps(box);
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
  const auto visit = [&](const auto& self, const Child& child, const Box& box, std::size_t depth) -> void {
    if (!plane.cuts(box)) return;
    if (child.leaf()) {
      cells.push_back({plane.outline(box), depth, child.count});
      return;
    }
    const Node& node = nodes_[child.first];
    for (int side = 0; side < 2; ++side) self(self, node.children[side], node.boxes[side], depth + 1);
  };
  visit(visit, root_, set_.box, 0);
  return scaled(std::move(cells), static_cast<double>(set_.inverse_scale));
}

static_assert(NeighborIndex<Bvh<Points<float, 3>>> && Inspectable<Bvh<Points<float, 3>>>);
static_assert(NeighborIndex<Bvh<Points<double, 2>>> && Inspectable<Bvh<Points<double, 2>>>);

}  // namespace treeline::accel
