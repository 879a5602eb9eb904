// BSP tree over points: an inner node cuts space by one plane of any direction.
//
// Planes lie across the principal axis of the node's points (Sproull 1991), or across the one of a few random
// directions in which they spread most (Dasgupta and Freund 2008), at the median: the tree is balanced.
// Bounds: planes, those on the way to a cell, one at a time, since slanted distances do not add up; or box
// and plane, where a node keeps the tight axis-aligned box of its points, too. Cost: O(n log n) to build, 16
// + 48/fill bytes a point (float, 3-D; fill is the mean count of a leaf); boxes add 48/fill. Known weakness:
// planes alone bound badly: far queries look into hundreds of cells where boxes let them look into tens.
// Rounding is allowed for by the size of the whole cloud, so that one outlier blurs the planes among all
// other points.
#pragma once

#include "accel/bsp_tree/directions.hpp"
#include "accel/bsp_tree/plane_node.hpp"
#include "accel/point_build.hpp"
#include "accel/point_queries.hpp"

namespace treeline::accel {

struct BspPointOptions : BuildOptions, PlaneDirections {
  enum class Bounds { planes, box_and_plane } bounds = Bounds::planes;
};

template <class T, int D>
class BspTree<Points<T, D>> : public PointQueries<BspTree<Points<T, D>>, T, D> {
  using Base = PointQueries<BspTree, T, D>;

 public:
  using typename Base::Box;
  using typename Base::Point;
  using Options = BspPointOptions;

  explicit BspTree(std::span<const Point> points, Options options = {});

  /// Cells tile the cloud's box. See SlicePlane for what is cut.
  std::vector<SliceCell> slice(int axis, double offset) const;

 private:
  friend Base;
  using Base::set_;
  using Base::stats_;
  using Entry = PointEntry<T, D>;
  using Node = PlaneNode<T, D>;

  struct Keyed {
    T key;
    Entry entry;
  };

  T along(const Point& normal, const Point& p) const { return dot(normal, p - centre_); }
  void build(std::size_t first, std::size_t last, std::size_t depth, const Options& options,
             std::vector<Keyed>& keyed);

  template <class Visitor, class W>
  void visit_near(const Point& q, Visitor& visitor, W& work) const {
    if (this->size() == 0) return;
    if (boxes_.empty())
      visit_near<false>(q, visitor, work);
    else
      visit_near<true>(q, visitor, work);
  }
  template <bool boxed, class Visitor, class W>
  void visit_near(const Point& q, Visitor& visitor, W& work) const;
  template <class Leaf, class W>
  void visit_box(const Box& box, Leaf&& leaf, W& work) const;

  std::vector<Node> nodes_;
  std::vector<Box> boxes_;  // of each node's points; empty if planes bound
  Point centre_{};          // local origin: rounding is relative to the cloud's size, not to where it lies
  T radius_ = 0;            // no point is farther from the centre, give or take rounding
};

// ---- build ---------------------------------------------------------------------------------------------

template <class T, int D>
BspTree<Points<T, D>>::BspTree(std::span<const Point> points, Options options) : Base(points, options) {
  check(options);
  const std::size_t n = set_.entries.size();
  if (n > 0) {
    centre_ = set_.box.centre();
    radius_ = std::max(length(set_.box.low - centre_), length(set_.box.high - centre_));
    nodes_.reserve(2 * (n / static_cast<std::size_t>(options.leaf_size)) + 1);
    if (options.bounds == Options::Bounds::box_and_plane) boxes_.reserve(nodes_.capacity());
    std::vector<Keyed> keyed(n);
    build(0, n, 0, options, keyed);
    nodes_.shrink_to_fit(), boxes_.shrink_to_fit();
  }
  stats_.bytes =
      sizeof(*this) + set_.bytes() + nodes_.capacity() * sizeof(Node) + boxes_.capacity() * sizeof(Box);
}

template <class T, int D>
void BspTree<Points<T, D>>::build(std::size_t first, std::size_t last, std::size_t depth,
                                  const Options& options, std::vector<Keyed>& keyed) {
  const std::size_t count = last - first, index = nodes_.size();
  const Box box = box_of(set_, first, last);
  const bool coincident = box.low == box.high;
  nodes_.emplace_back();
  if (options.bounds == Options::Bounds::box_and_plane) boxes_.push_back(box);
  if (coincident || count <= static_cast<std::size_t>(options.leaf_size)) {
    if (coincident) sort_by_id(set_, first, last);
    nodes_[index] = {
        {}, T(0), static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(count), coincident};
    return add_leaf(stats_, count, depth, 0);
  }
  const Point normal = plane_normal(std::span<const Entry>(set_.entries).subspan(first, count), box, centre_,
                                    options, nodes_.size());
  // By rank of the keys as computed, so that even keys which rounding made equal are halved.
  const auto less = [](const Keyed& a, const Keyed& b) { return a.key < b.key; };
  for (std::size_t i = 0; i < count; ++i)
    keyed[i] = {along(normal, set_.entries[first + i].point), set_.entries[first + i]};
  const std::size_t half = count / 2;
  const auto from = keyed.begin(), middle = from + static_cast<std::ptrdiff_t>(half);
  std::nth_element(from, middle, from + static_cast<std::ptrdiff_t>(count), less);
  const T below = std::max_element(from, middle, less)->key, above = middle->key;
  for (std::size_t i = 0; i < count; ++i) set_.entries[first + i] = keyed[i].entry;

  add_inner(stats_, 0);
  build(first, first + half, depth + 1, options, keyed);
  nodes_[index] = {normal, below + (above - below) / T(2), static_cast<std::uint32_t>(nodes_.size()), 0, 0};
  build(first + half, last, depth + 1, options, keyed);
}

// ---- queries -------------------------------------------------------------------------------------------

// Planes say where to go first; with boxes, the nearer box does, and planes only where both are as near.
template <class T, int D>
template <bool boxed, class Visitor, class W>
void BspTree<Points<T, D>>::visit_near(const Point& q, Visitor& visitor, W& work) const {
  struct Far {
    T bound;
    std::uint32_t node;
  };
  Far stack[max_depth];
  int waiting = 0;

  const PlaneBound<T, D> beyond(radius_ + length(q - centre_));
  Far here{squared_distance(set_.box, q), 0};
  if (here.bound > visitor.limit()) return;
  while (true) {
    const Node* node = &nodes_[here.node];
    work.node();
    while (!node->leaf()) {
      const T ahead = along(node->normal, q) - node->offset;
      const std::uint32_t left = here.node + 1, right = node->first;
      Far near{here.bound, ahead > 0 ? right : left};
      Far far{std::max(here.bound, beyond(ahead)), ahead > 0 ? left : right};
      if constexpr (boxed) {
        near.bound = std::max(near.bound, squared_distance(boxes_[near.node], q));
        far.bound = std::max(far.bound, squared_distance(boxes_[far.node], q));
        if (far.bound < near.bound) std::swap(near, far);
      }
      if (far.bound <= visitor.limit()) stack[waiting++] = far;
      here = near;
      if (boxed && here.bound > visitor.limit()) break;
      node = &nodes_[here.node];
      work.node();
    }
    if (!boxed || here.bound <= visitor.limit()) set_.offer(node->points(), q, visitor, work);
    do {
      if (waiting == 0) return;
      here = stack[--waiting];
    } while (here.bound > visitor.limit());
  }
}

template <class T, int D>
template <class Leaf, class W>
void BspTree<Points<T, D>>::visit_box(const Box& box, Leaf&& leaf, W& work) const {
  std::uint32_t stack[max_depth];
  int waiting = 0;
  std::uint32_t index = 0;
  // The box lies within the cloud's, so its projection rounds no worse than two points'.
  const T slack = geometry::tolerance::plane_bound<T>(D) * T(2) * radius_;
  const Point low = box.low - centre_, high = box.high - centre_;
  const Point middle = (low + high) * T(0.5), half = (high - low) * T(0.5);
  while (true) {
    const Node& node = nodes_[index];
    work.node();
    if (!boxes_.empty() && !boxes_[index].overlaps(box)) {
      // Nothing of it is inside, although its cell meets the box.
    } else if (node.leaf()) {
      leaf(node.points());
    } else {
      const T at = dot(node.normal, middle) - node.offset;
      T reach = slack;
      for (int a = 0; a < D; ++a) reach += std::abs(node.normal[a]) * half[a];
      const bool left = at - reach <= 0, right = at + reach >= 0;
      if (left && right) stack[waiting++] = node.first;
      index = left ? index + 1 : node.first;
      continue;
    }
    if (waiting == 0) return;
    index = stack[--waiting];
  }
}

// ---- pictures ------------------------------------------------------------------------------------------

template <class T, int D>
std::vector<SliceCell> BspTree<Points<T, D>>::slice(int axis, double offset) const {
  return slice_of_planes(std::span<const Node>(nodes_), set_, centre_, axis, offset);
}

static_assert(NeighborIndex<BspTree<Points<float, 3>>> && Inspectable<BspTree<Points<float, 3>>>);
static_assert(NeighborIndex<BspTree<Points<double, 2>>> && Inspectable<BspTree<Points<double, 2>>>);

}  // namespace treeline::accel
