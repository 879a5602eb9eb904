// KD tree over triangles: an inner node cuts its cell by one axis-aligned plane; leaves reference triangles.
//
// A ray visits cells front to back, carrying the interval of t in which it is in the cell, widened by
// plane_slack. Every hit lies within hit_slack of its triangle (see ray_query.hpp), so the leaf that holds
// the point of the hit has the hit within its interval: none is lost by rounding, and the walk may stop as
// soon as the nearest hit so far precedes the next cell's interval. A hit found early in a cell but lying
// behind it is kept as a bound only. Sources: Fussell and Subramanian 1988; Wald and Havran 2006 (build, see
// build_triangles.hpp). Cost: O(n log n) to build, O(log n) expected per query; bytes, for float: 40 a
// reference and 16 a node, some 50 to 120 a triangle. Known weakness: a triangle in many cells is kept and
// tested in each of them; cells bound closest points worse than boxes.
// Measured on one core in one run over 1e5 triangles, rays per second over the binary hierarchy's with the
// same leaf test: icosphere 0.9 to 1.2, forest 1.2 to 1.5, terrain 1.1 to 1.4, architecture 3.6 to 6.6.
#pragma once

#include "accel/kd_tree/build_triangles.hpp"
#include "accel/slice.hpp"
#include "accel/triangle_queries.hpp"

namespace treeline::accel {

template <class T, class RayTest>
class KdTree<Triangles<T, RayTest>>
    : public TriangleQueries<KdTree<Triangles<T, RayTest>>, Triangles<T, RayTest>> {
  using Primitives = Triangles<T, RayTest>;
  using Base = TriangleQueries<KdTree, Primitives>;
  friend Base;

 public:
  using Options = KdTriangleOptions;

  explicit KdTree(std::span<const geometry::Triangle<T>> triangles, const Options& options = {})
      : KdTree(TriangleSet<T>(triangles, options), options) {}
  explicit KdTree(const geometry::Mesh<T>& mesh, const Options& options = {})
      : KdTree(TriangleSet<T>(mesh, options), options) {}

  /// The cells of the leaves; they tile the box of all triangles.
  std::vector<SliceCell> slice(int axis, double offset) const;

 private:
  using Node = KdTriangleNode<T>;

  KdTree(TriangleSet<T>&& set, const Options& options);
  template <bool any, class W>
  void trace(RayQuery<Primitives>& query, W& work) const;
  template <class W>
  void approach(ClosestQuery<T>& query, W& work) const;

  std::vector<Node> nodes_;
  TriangleLeaves<T> triangles_;
};

template <class T, class RayTest>
KdTree<Triangles<T, RayTest>>::KdTree(TriangleSet<T>&& set, const Options& options) : Base(set) {
  KdTriangleBuilder<T> built(set, options);
  nodes_ = std::move(built.tree.nodes);
  triangles_ = TriangleLeaves<T>(set.items, nodes_, built.tree.references, options.threads);
  TreeStats& s = this->stats_;
  s.references = triangles_.size();
  s.leaves = built.tree.leaves;
  s.inner_nodes = nodes_.size() - built.tree.leaves;
  s.depth = built.tree.depth;
  s.largest_leaf = built.tree.largest_leaf;
  s.sah_cost = built.tree.cost;
  s.bytes = sizeof(*this) + nodes_.capacity() * sizeof(Node) + triangles_.bytes();
  this->keep_flat(std::move(set), options);
}

template <class T, class RayTest>
template <bool any, class W>
void KdTree<Triangles<T, RayTest>>::trace(RayQuery<Primitives>& query, W& work) const {
  struct Waiting {
    std::uint32_t node;
    T t0, t1;
  };
  Waiting stack[kd_stack_size];
  int height = 0;
  const PaddedRay<T> ray = query.padded();  // a copy: known not to change under calls
  T t0 = query.ray().t_min, t1 = query.limit();
  if (!ray.clip(widened(this->bounds_, reach_of(this->centre_, this->bounds_)), t0, t1)) return;
  std::uint32_t at = 0;
  for (;;) {
    const Node& node = nodes_[at];
    if (!node.leaf()) {
      work.node();
      const int axis = static_cast<int>(node.axis);
      const std::size_t near = ray.backward(axis);
      const T leave = ray.exit(axis, node.border[near]), enter = ray.enter(axis, node.border[1 - near]);
      const T near_t1 = leave < t1 ? leave : t1, far_t0 = enter > t0 ? enter : t0;  // NaN: no bound
      const std::uint32_t side[2] = {at + 1, node.link};
      // Without branches: which of the two a ray visits is as good as random.
      const bool visits_near = t0 <= near_t1, visits_far = far_t0 <= t1;
      stack[height] = {side[1 - near], far_t0, t1};
      height += visits_near && visits_far;
      at = side[visits_near ? near : 1 - near];
      t1 = visits_near ? near_t1 : t1, t0 = visits_near ? t0 : far_t0;
      if (visits_near || visits_far) continue;
    } else if (node.count > 0) {
      work.primitive(node.count);
      if (query.template test<any>(triangles_, node.link, node.count)) return;
    }
    do {
      if (height == 0) return;
      --height;
    } while (stack[height].t0 > query.limit());
    at = stack[height].node, t0 = stack[height].t0, t1 = stack[height].t1;
  }
}

template <class T, class RayTest>
template <class W>
void KdTree<Triangles<T, RayTest>>::approach(ClosestQuery<T>& query, W& work) const {
  struct Waiting {
    std::uint32_t node;
    geometry::Vec<T, 3> gap;  // from the point to the cell, along each axis
  };
  Waiting stack[kd_stack_size];
  int height = 0;
  const geometry::Vec<T, 3>& p = query.point();
  const T slack = query.slack();
  Waiting now{0, {}};
  const auto box = widened(this->bounds_, reach_of(this->centre_, this->bounds_));
  for (int k = 0; k < 3; ++k)
    now.gap[k] = std::max({box.low[k] - p[k] - slack, p[k] - box.high[k] - slack, T(0)});
  for (;;) {
    while (!query.prunes(length2(now.gap))) {
      const Node& node = nodes_[now.node];
      if (node.leaf()) {
        work.primitive(node.count);
        query.test(triangles_, node.link, node.count);
        break;
      }
      work.node();
      const int axis = static_cast<int>(node.axis);
      const T beyond[2] = {p[axis] - node.border[0], node.border[1] - p[axis]};  // of either child
      const std::uint32_t side[2] = {now.node + 1, node.link};
      const std::size_t near = beyond[1] < beyond[0];
      Waiting far = now;
      far.node = side[1 - near];
      far.gap[axis] = std::max(far.gap[axis], beyond[1 - near] - slack);
      if (!query.prunes(length2(far.gap))) stack[height++] = far;
      now.node = side[near];
    }
    if (height == 0) return;
    now = stack[--height];
  }
}

template <class T, class RayTest>
std::vector<SliceCell> KdTree<Triangles<T, RayTest>>::slice(int axis, double offset) const {
  offset = this->place_.kept_offset(axis, offset);
  const SlicePlane<3> plane(axis, offset);
  struct Open {
    std::uint32_t node;
    geometry::Box<T, 3> cell;
    std::size_t depth;
  };
  std::vector<SliceCell> cells;
  std::vector<Open> open;
  if (this->size() > 0) open.push_back({0, this->bounds_, 0});
  while (!open.empty()) {
    const Open now = open.back();
    open.pop_back();
    if (!plane.cuts(now.cell)) continue;
    const Node& node = nodes_[now.node];
    if (node.leaf()) {
      cells.push_back({plane.outline(now.cell), now.depth, node.count});
      continue;
    }
    Open below{now.node + 1, now.cell, now.depth + 1}, above{node.link, now.cell, now.depth + 1};
    const int k = static_cast<int>(node.axis);
    below.cell.high[k] = above.cell.low[k] = node.border[0] / 2 + node.border[1] / 2;
    open.push_back(below), open.push_back(above);
  }
  return this->place_.given(std::move(cells), axis);
}

static_assert(TriangleIndex<KdTree<Triangles<float, geometry::Watertight>>>);
static_assert(TriangleIndex<KdTree<Triangles<float, geometry::MollerTrumbore>>>);
static_assert(TriangleIndex<KdTree<Triangles<double, geometry::Watertight>>>);
static_assert(TriangleIndex<KdTree<Triangles<double, geometry::MollerTrumbore>>>);

}  // namespace treeline::accel
