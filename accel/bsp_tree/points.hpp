// BSP tree over points: an inner node cuts space by one plane of any direction.
//
// Planes lie across the principal axis of the node's points (Sproull 1991), or across the one of a few random
// directions in which they spread most (Dasgupta and Freund 2008), at the median: the tree is balanced.
// Cost: O(n log n) to build, 16 + 24/leaf bytes a point (float, 3-D).
// Known weakness: a cell is bounded by the planes on the way to it, one at a time, since slanted distances do
// not add up: far queries look into many cells (boxes bound better, see bvh/points.hpp). Rounding is allowed
// for by the size of the whole cloud, so that one outlier blurs the planes among all other points.
#pragma once

#include <array>
#include <numbers>

#include "accel/point_build.hpp"
#include "accel/point_queries.hpp"
#include "accel/slice.hpp"
#include "geometry/random.hpp"
#include "geometry/tolerances.hpp"

namespace treeline::accel {

struct BspPointOptions : BuildOptions {
  enum class Split { principal_axis, random_projection } split = Split::principal_axis;
  int projections = 8;     ///< random directions tried per node
  std::uint64_t seed = 1;  ///< of the random directions
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
  using Direction = geometry::Vec<double, D>;

  /// An inner node has its left child right behind it; points on the left have normal · (p - centre) <=
  /// offset as computed by `along`, those on the right >= offset.
  struct Node {
    Point normal;
    T offset;
    std::uint32_t first;       // inner: right child; leaf: first entry
    std::uint32_t count : 31;  // leaf: entries; inner: 0
    std::uint32_t coincident : 1;

    bool leaf() const { return count > 0; }
    PointLeaf points() const { return {first, count, coincident == 1}; }
  };
  struct Keyed {
    T key;
    Entry entry;
  };

  T along(const Point& normal, const Point& p) const { return dot(normal, p - centre_); }
  void build(std::size_t first, std::size_t last, std::size_t depth, const Options& options,
             std::vector<Keyed>& keyed);
  Direction principal_axis(std::size_t first, std::size_t last, const Box& box) const;
  Direction widest_projection(std::size_t first, std::size_t last, const Options& options) const;

  template <class Visitor, class W>
  void visit_near(const Point& q, Visitor& visitor, W& work) const;
  template <class Leaf, class W>
  void visit_box(const Box& box, Leaf&& leaf, W& work) const;

  std::vector<Node> nodes_;
  Point centre_{};  // local origin: rounding is relative to the cloud's size, not to where it lies
  T radius_ = 0;    // no point is farther from the centre, give or take rounding
};

// ---- build ---------------------------------------------------------------------------------------------

template <class T, int D>
BspTree<Points<T, D>>::BspTree(std::span<const Point> points, Options options) : Base(points, options) {
  if (options.projections < 1)
    throw InvalidInput("projections is " + std::to_string(options.projections) + "; it must be at least 1");
  const std::size_t n = set_.entries.size();
  if (n > 0) {
    centre_ = set_.box.centre();
    radius_ = std::max(length(set_.box.low - centre_), length(set_.box.high - centre_));
    nodes_.reserve(2 * (n / static_cast<std::size_t>(options.leaf_size)) + 1);
    std::vector<Keyed> keyed(n);
    build(0, n, 0, options, keyed);
    nodes_.shrink_to_fit();
  }
  stats_.bytes = sizeof(*this) + set_.bytes() + nodes_.capacity() * sizeof(Node);
}

template <class T, int D>
void BspTree<Points<T, D>>::build(std::size_t first, std::size_t last, std::size_t depth,
                                  const Options& options, std::vector<Keyed>& keyed) {
  const std::size_t count = last - first, index = nodes_.size();
  const Box box = box_of(set_, first, last);
  const bool coincident = box.low == box.high;
  nodes_.emplace_back();
  if (coincident || count <= static_cast<std::size_t>(options.leaf_size)) {
    if (coincident) sort_by_id(set_, first, last);
    nodes_[index] = {
        {}, T(0), static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(count), coincident};
    return add_leaf(stats_, count, depth, 0);
  }
  const Point normal(options.split == Options::Split::principal_axis
                         ? principal_axis(first, last, box)
                         : widest_projection(first, last, options));
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

/// Every so many entries of a run, so that about a thousand are looked at: enough for a direction.
inline std::size_t sample_stride(std::size_t count) { return std::max<std::size_t>(1, count / 1024); }

/// Power iteration on the covariance. Any unit vector makes a correct tree; a few steps make a good one.
template <class T, int D>
auto BspTree<Points<T, D>>::principal_axis(std::size_t first, std::size_t last, const Box& box) const
    -> Direction {
  // Relative to the box, so that covariances neither overflow nor vanish.
  const int widest = box.widest_axis();
  const double unit = static_cast<double>(box.high[widest]) - static_cast<double>(box.low[widest]);
  const std::size_t stride = sample_stride(last - first);
  const auto relative = [&](std::size_t i) {
    return (Direction(set_.entries[i].point) - Direction(box.low)) / unit;
  };
  Direction mean{};
  std::size_t samples = 0;
  for (std::size_t i = first; i < last; i += stride, ++samples) mean += relative(i);
  mean = mean / static_cast<double>(samples);
  std::array<Direction, D> covariance{};
  for (std::size_t i = first; i < last; i += stride) {
    const Direction d = relative(i) - mean;
    for (int a = 0; a < D; ++a) covariance[static_cast<std::size_t>(a)] += d * d[a];
  }
  Direction axis{};
  axis[widest] = 1;
  for (int step = 0; step < 12; ++step) {
    Direction next;
    for (int a = 0; a < D; ++a) next[a] = dot(covariance[static_cast<std::size_t>(a)], axis);
    if (!(length2(next) > 0)) break;  // the sample missed what makes the points differ
    axis = normalized(next);
  }
  return axis;
}

template <class T, int D>
auto BspTree<Points<T, D>>::widest_projection(std::size_t first, std::size_t last,
                                              const Options& options) const -> Direction {
  const auto stream = geometry::hash_u64(options.seed, nodes_.size());
  const auto uniform = [&](int i) {  // in (0, 1]
    return 1 - geometry::unit_interval<double>(geometry::hash_u64(stream, static_cast<std::uint64_t>(i)));
  };
  const std::size_t stride = sample_stride(last - first);
  Direction best{};
  double best_spread = -1;
  for (int j = 0, drawn = 0; j < options.projections; ++j) {
    // Normal deviates (Box and Muller 1958) point in all directions alike.
    Direction d;
    for (int a = 0; a < D; ++a, drawn += 2)
      d[a] = std::sqrt(-2 * std::log(uniform(drawn))) * std::cos(2 * std::numbers::pi * uniform(drawn + 1));
    if (!(length2(d) > 0)) d[0] = 1;
    d = normalized(d);
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (std::size_t i = first; i < last; i += stride) {
      const double s = dot(d, Direction(set_.entries[i].point - centre_));
      low = std::min(low, s), high = std::max(high, s);
    }
    if (high - low > best_spread) best_spread = high - low, best = d;
  }
  return best;
}

// ---- queries -------------------------------------------------------------------------------------------

// A point beyond a plane is at least |along(q) - offset| away, but for the rounding of both projections,
// which is at most plane_bound times the distances from the centre, and that of the squared distance
// compared, which is relative unless it underflows.
template <class T, int D>
template <class Visitor, class W>
void BspTree<Points<T, D>>::visit_near(const Point& q, Visitor& visitor, W& work) const {
  struct Far {
    T bound;
    std::uint32_t node;
  };
  Far stack[max_depth];
  int waiting = 0;

  if (this->size() == 0) return;
  constexpr T relative = geometry::tolerance::plane_bound<T>(D);
  const T slack = relative * (radius_ + length(q - centre_));
  Far here{squared_distance(set_.box, q), 0};
  if (here.bound > visitor.limit()) return;
  while (true) {
    const Node* node = &nodes_[here.node];
    work.node();
    while (!node->leaf()) {
      const T ahead = along(node->normal, q) - node->offset;
      const std::uint32_t left = static_cast<std::uint32_t>(node - nodes_.data()) + 1;
      const T distance = std::max((std::abs(ahead) - slack) * (T(1) - relative), T(0));
      const T square = distance * distance;
      const T bound = square < std::numeric_limits<T>::min() ? here.bound : std::max(here.bound, square);
      if (bound <= visitor.limit()) stack[waiting++] = {bound, ahead > 0 ? left : node->first};
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
    if (node.leaf()) {
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
  const SlicePlane<D> plane(axis, offset * static_cast<double>(set_.scale));
  std::vector<SliceCell> cells;
  if (!plane.cuts(set_.box)) return cells;
  const auto visit = [&](const auto& self, std::size_t index, Outline outline, std::size_t depth) -> void {
    if (outline.size() < 3) return;
    const Node& node = nodes_[index];
    if (node.leaf()) {
      cells.push_back({std::move(outline), depth, node.count});
      return;
    }
    // The node's plane within the cutting plane, relative to the outline's first corner to keep digits.
    const Direction normal(node.normal), centre(centre_);
    Direction corner = centre;
    corner[plane.u] = outline[0][0], corner[plane.v] = outline[0][1];
    if (D == 3) corner[plane.axis] = plane.offset;
    const geometry::Vec2d line{normal[plane.u], normal[plane.v]};
    const double line_offset =
        static_cast<double>(node.offset) - dot(normal, corner - centre) + dot(line, outline[0]);
    if (line == geometry::Vec2d{}) {  // parallel: all on one side
      self(self, line_offset > 0 ? index + 1 : node.first, std::move(outline), depth + 1);
      return;
    }
    self(self, index + 1, clipped(outline, line, line_offset), depth + 1);
    self(self, node.first, clipped(outline, -line, -line_offset), depth + 1);
  };
  visit(visit, 0, plane.outline(set_.box), 0);
  return scaled(std::move(cells), static_cast<double>(set_.inverse_scale));
}

static_assert(NeighborIndex<BspTree<Points<float, 3>>> && Inspectable<BspTree<Points<float, 3>>>);
static_assert(NeighborIndex<BspTree<Points<double, 2>>> && Inspectable<BspTree<Points<double, 2>>>);

}  // namespace treeline::accel
