// BSP tree over triangles: an inner node cuts its cell by a plane of any direction; leaves reference
// triangles.
//
// A ray visits cells front to back, its interval of t clipped at each plane with a slack in distance
// (oblique_slack) that covers all rounding: both sides are visited where the ray runs within it, which also
// settles planes that are parallel to the ray, nearly or exactly. As every hit lies within hit_slack of its
// triangle (see ray_query.hpp), none is lost. Axis planes are crossed as in a KD tree, without a dot product
// (the fast path of Ize, Wald and Parker). Closest points are bounded by the largest distance to the planes
// that separate a cell from the query. Sources: Fuchs, Kedem and Naylor 1980; Ize, Wald and Parker 2008
// (build, see build_triangles.hpp). Cost: O(n log n) to build, O(log n) expected per ray; a step through an
// oblique plane takes two dot products and a division. Known weakness: plane distances bound closest points
// badly where a cell is narrow: many cells are visited.
#pragma once

#include "accel/bsp_tree/build_triangles.hpp"
#include "accel/slice.hpp"
#include "accel/triangle_queries.hpp"

namespace treeline::accel {

template <class T, class RayTest>
class BspTree<Triangles<T, RayTest>>
    : public TriangleQueries<BspTree<Triangles<T, RayTest>>, Triangles<T, RayTest>> {
  using Primitives = Triangles<T, RayTest>;
  using Base = TriangleQueries<BspTree, Primitives>;
  friend Base;

 public:
  using Options = BspTriangleOptions;

  explicit BspTree(std::span<const geometry::Triangle<T>> triangles, const Options& options = {})
      : BspTree(TriangleSet<T>(triangles, options), options) {}
  explicit BspTree(const geometry::Mesh<T>& mesh, const Options& options = {})
      : BspTree(TriangleSet<T>(mesh, options), options) {}

  /// The cells of the leaves, convex polygons; they tile the box of all triangles.
  std::vector<SliceCell> slice(int axis, double offset) const;

 private:
  using Node = BspTriangleNode<T>;

  BspTree(TriangleSet<T>&& set, const Options& options);
  template <bool any, class W>
  void trace(RayQuery<Primitives>& query, W& work) const;
  template <class W>
  void approach(ClosestQuery<T>& query, W& work) const;
  static T slack(const RayQuery<Primitives>& query);

  std::vector<Node> nodes_;
  TriangleLeaves<T> triangles_;
};

template <class T, class RayTest>
BspTree<Triangles<T, RayTest>>::BspTree(TriangleSet<T>&& set, const Options& options) : Base(set) {
  BspTriangleBuilder<T> built(set, options);
  nodes_ = std::move(built.tree.nodes);
  triangles_ = TriangleLeaves<T>(set.items, nodes_, built.tree.references, options.threads);
  TreeStats& s = this->stats_;
  s.references = triangles_.size();
  s.leaves = built.tree.leaves;
  s.inner_nodes = nodes_.size() - built.tree.leaves;
  s.oblique_nodes = built.tree.oblique_nodes;
  s.depth = built.tree.depth;
  s.largest_leaf = built.tree.largest_leaf;
  s.sah_cost = built.tree.cost;
  s.bytes = sizeof(*this) + nodes_.capacity() * sizeof(Node) + triangles_.bytes();
  this->keep_flat(std::move(set), options);
}

/// The ray's share of the distance from a plane within which it counts as on it. Infinite, so that both sides
/// are always visited, where products of the direction could leave the range of T.
template <class T, class RayTest>
T BspTree<Triangles<T, RayTest>>::slack(const RayQuery<Primitives>& query) {
  const auto& d = query.ray().direction;
  const T speed = std::abs(d[largest_axis(d)]);
  constexpr T small = T(1e-18), large = T(1e18);
  if (!(small < speed && speed < large)) return std::numeric_limits<T>::infinity();
  return geometry::tolerance::oblique_slack<T> * query.reach() + std::numeric_limits<T>::min();
}

template <class T, class RayTest>
template <bool any, class W>
void BspTree<Triangles<T, RayTest>>::trace(RayQuery<Primitives>& query, W& work) const {
  struct Waiting {
    std::uint32_t node;
    T t0, t1;
  };
  Waiting stack[kd_stack_size];
  int height = 0;
  const PaddedRay<T> ray = query.padded();  // a copy: known not to change under calls
  const T slack = BspTree::slack(query);
  const geometry::Vec<T, 3> origin = query.ray().origin - this->centre_, direction = query.ray().direction;
  T t0 = query.ray().t_min, t1 = query.limit();
  if (!ray.clip(widened(this->bounds_, reach_of(this->centre_, this->bounds_)), t0, t1)) return;
  std::uint32_t at = 0;
  for (;;) {
    const Node& node = nodes_[at];
    if (!node.leaf()) {
      work.node();
      T leave, enter;
      std::size_t near;
      if (node.axis_plane()) {
        const int axis = static_cast<int>(node.kind);
        near = ray.backward(axis);
        leave = ray.exit(axis, node.border[near]), enter = ray.enter(axis, node.border[1 - near]);
      } else {
        const T distance = dot(node.normal, origin), speed = dot(node.normal, direction);
        const T inverse = T(1) / speed, widening = std::copysign(slack, speed);
        near = std::signbit(speed);
        leave = ((node.border[near] - distance) + widening) * inverse;
        enter = ((node.border[1 - near] - distance) - widening) * inverse;
      }
      const T near_t1 = leave < t1 ? leave : t1, far_t0 = enter > t0 ? enter : t0;  // NaN: no bound
      const std::uint32_t side[2] = {at + 1, node.link};
      if (t0 <= near_t1) {
        if (far_t0 <= t1) stack[height++] = {side[1 - near], far_t0, t1};
        at = side[near], t1 = near_t1;
        continue;
      }
      if (far_t0 <= t1) {
        at = side[1 - near], t0 = far_t0;
        continue;
      }
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
void BspTree<Triangles<T, RayTest>>::approach(ClosestQuery<T>& query, W& work) const {
  struct Waiting {
    std::uint32_t node;
    geometry::Vec<T, 3> gap;  // from the point to the box of the cell's axis planes, along each axis
    T oblique;                // from the point to the cell beyond its oblique planes

    T bound2() const { return std::max(length2(gap), oblique * oblique); }
  };
  Waiting stack[kd_stack_size];
  int height = 0;
  const T slack = query.slack();
  const geometry::Vec<T, 3>&p = query.point(), from_centre = p - this->centre_;
  Waiting now{0, {}, T(0)};
  const auto box = widened(this->bounds_, reach_of(this->centre_, this->bounds_));
  for (int k = 0; k < 3; ++k)
    now.gap[k] = std::max({box.low[k] - p[k] - slack, p[k] - box.high[k] - slack, T(0)});
  for (;;) {
    while (!query.prunes(now.bound2())) {
      const Node& node = nodes_[now.node];
      if (node.leaf()) {
        work.primitive(node.count);
        query.test(triangles_, node.link, node.count);
        break;
      }
      work.node();
      const int axis = static_cast<int>(node.kind);
      const T at = node.axis_plane() ? p[axis] : dot(node.normal, from_centre);
      const T beyond[2] = {at - node.border[0], node.border[1] - at};  // of either child
      const std::uint32_t side[2] = {now.node + 1, node.link};
      const std::size_t near = beyond[1] < beyond[0];
      Waiting far = now;
      far.node = side[1 - near];
      T& gap = node.axis_plane() ? far.gap[axis] : far.oblique;
      gap = std::max(gap, beyond[1 - near] - slack);
      if (!query.prunes(far.bound2())) stack[height++] = far;
      now.node = side[near];
    }
    if (height == 0) return;
    now = stack[--height];
  }
}

template <class T, class RayTest>
std::vector<SliceCell> BspTree<Triangles<T, RayTest>>::slice(int axis, double offset) const {
  offset = this->place_.kept_offset(axis, offset);
  const SlicePlane<3> plane(axis, offset);
  struct Open {
    std::uint32_t node;
    Outline outline;
    std::size_t depth;
  };
  std::vector<SliceCell> cells;
  std::vector<Open> open;
  if (this->size() > 0 && plane.cuts(this->bounds_)) open.push_back({0, plane.outline(this->bounds_), 0});
  const geometry::Vec3d centre(this->centre_);
  while (!open.empty()) {
    Open now = std::move(open.back());
    open.pop_back();
    if (now.outline.size() < 3) continue;
    const Node& node = nodes_[now.node];
    if (node.leaf()) {
      cells.push_back({std::move(now.outline), now.depth, node.count});
      continue;
    }
    const geometry::Vec3d n(node.normal);
    const double from_origin = node.axis_plane() ? 0 : dot(n, centre);
    const double middle = static_cast<double>(node.border[0]) / 2 + static_cast<double>(node.border[1]) / 2;
    const double level = middle + from_origin - n[axis] * offset;
    const geometry::Vec2d in_slice{n[plane.u], n[plane.v]};
    open.push_back({now.node + 1, clipped(now.outline, in_slice, level), now.depth + 1});
    open.push_back({node.link, clipped(now.outline, -in_slice, -level), now.depth + 1});
  }
  return this->place_.given(std::move(cells), axis);
}

static_assert(TriangleIndex<BspTree<Triangles<float, geometry::Watertight>>>);
static_assert(TriangleIndex<BspTree<Triangles<float, geometry::MollerTrumbore>>>);
static_assert(TriangleIndex<BspTree<Triangles<double, geometry::Watertight>>>);
static_assert(TriangleIndex<BspTree<Triangles<double, geometry::MollerTrumbore>>>);

}  // namespace treeline::accel
