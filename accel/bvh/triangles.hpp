// Bounding volume hierarchy over triangles: an inner node holds the boxes of its two children.
//
// Rays descend into the nearer child first and skip boxes beyond the nearest hit so far; closest-point
// queries do the same with distances. Sources: Kay and Kajiya 1986; Wald 2007 (build, see
// build_triangles.hpp). Cost: O(n log n) to build, O(log n) expected per query, n (40 + 64 / triangles per
// leaf) bytes for float. Known weakness: boxes of long thin triangles that are not axis-parallel overlap, and
// are mostly empty.
#pragma once

#include <ranges>

#include "accel/bvh/build_triangles.hpp"
#include "accel/slice.hpp"
#include "accel/triangle_queries.hpp"

namespace treeline::accel {

template <class T, class RayTest>
class Bvh<Triangles<T, RayTest>> : public TriangleQueries<Bvh<Triangles<T, RayTest>>, Triangles<T, RayTest>> {
  using Primitives = Triangles<T, RayTest>;
  using Base = TriangleQueries<Bvh, Primitives>;
  friend Base;

 public:
  using Options = BvhTriangleOptions;

  explicit Bvh(std::span<const geometry::Triangle<T>> triangles, const Options& options = {})
      : Bvh(TriangleSet<T>(triangles, options), options) {}
  explicit Bvh(const geometry::Mesh<T>& mesh, const Options& options = {})
      : Bvh(TriangleSet<T>(mesh, options), options) {}

  /// The boxes of the leaves.
  std::vector<SliceCell> slice(int axis, double offset) const;

 private:
  using Child = BvhChild<T>;

  Bvh(TriangleSet<T>&& set, const Options& options);
  template <bool any, class W>
  void trace(RayQuery<Primitives>& query, W& work) const;
  template <class W>
  void approach(ClosestQuery<T>& query, W& work) const;

  Child root_;
  std::vector<BvhNode<T>> nodes_;
  TriangleLeaves<T> triangles_;  // in leaf order
};

template <class T, class RayTest>
Bvh<Triangles<T, RayTest>>::Bvh(TriangleSet<T>&& set, const Options& options) : Base(set) {
  BvhBuilder<T> built(set, options);
  root_ = built.root;
  nodes_ = std::move(built.nodes);
  triangles_ = TriangleLeaves<T>(set.items.size());
  const auto keep = [&](Child& c) {
    if (c.count > 0) triangles_.put(c.first, set.items, std::views::iota(c.first, c.first + c.count));
    const geometry::Box<T, 3> box = c.box(), wide = widened(box, reach_of(this->centre_, box));
    c.corner[0] = wide.low, c.corner[1] = wide.high;
  };
  keep(root_);
  for (BvhNode<T>& node : nodes_) keep(node.child[0]), keep(node.child[1]);
  TreeStats& s = this->stats_;
  s.references = triangles_.size();
  s.inner_nodes = nodes_.size();
  s.leaves = built.leaves;
  s.depth = built.depth;
  s.largest_leaf = built.largest_leaf;
  s.bytes = sizeof(*this) + nodes_.capacity() * sizeof(BvhNode<T>) + triangles_.bytes();
  this->keep_flat(std::move(set), options);
  const auto area = [](const geometry::Box<T, 3>& b) {
    return surface_area(geometry::Box3d{geometry::Vec3d(b.low), geometry::Vec3d(b.high)});
  };
  if (triangles_.size() == 0 || !(area(root_.box()) > 0)) return;
  double cost = 0;
  const auto add = [&](const Child& c) {
    cost += area(c.box()) * (c.count > 0 ? static_cast<double>(c.count) : 1.0);
  };
  add(root_);
  for (const auto& node : nodes_) add(node.child[0]), add(node.child[1]);
  s.sah_cost = cost / area(root_.box());
}

template <class T, class RayTest>
template <bool any, class W>
void Bvh<Triangles<T, RayTest>>::trace(RayQuery<Primitives>& query, W& work) const {
  struct Waiting {
    std::uint32_t first, count;
    T enter;
  };
  Waiting stack[bvh_max_depth];
  int height = 0;
  const PaddedRay<T> ray = query.padded();  // a copy: known not to change under calls
  const T t_min = query.ray().t_min;
  T enter = t_min, exit = query.limit();
  if (!ray.clip(root_.corner, enter, exit)) return;
  std::uint32_t first = root_.first, count = root_.count;
  for (;;) {
    if (count == 0) {
      work.node();
      const BvhNode<T>& node = nodes_[first];
      T enter0 = t_min, enter1 = t_min, exit0 = query.limit(), exit1 = exit0;
      const bool hit0 = ray.clip(node.child[0].corner, enter0, exit0);
      const bool hit1 = ray.clip(node.child[1].corner, enter1, exit1);
      if (hit0 && hit1) {
        const bool swap = enter1 < enter0;
        const Child &near = node.child[swap], &far = node.child[!swap];
        stack[height++] = {far.first, far.count, swap ? enter0 : enter1};
        first = near.first, count = near.count;
        continue;
      }
      if (hit0 || hit1) {
        const Child& only = node.child[hit1];
        first = only.first, count = only.count;
        continue;
      }
    } else {
      work.primitive(count);
      if (query.template test<any>(triangles_, first, count)) return;
    }
    do {
      if (height == 0) return;
      --height;
    } while (stack[height].enter > query.limit());
    first = stack[height].first, count = stack[height].count;
  }
}

template <class T, class RayTest>
template <class W>
void Bvh<Triangles<T, RayTest>>::approach(ClosestQuery<T>& query, W& work) const {
  struct Waiting {
    std::uint32_t first, count;
    T distance2;
  };
  Waiting stack[bvh_max_depth + 1];
  int height = 0;
  stack[height++] = {root_.first, root_.count, distance2(query.point(), root_.box())};
  while (height > 0) {
    const Waiting top = stack[--height];
    if (query.prunes(top.distance2)) continue;
    if (top.count > 0) {
      work.primitive(top.count);
      query.test(triangles_, top.first, top.count);
      continue;
    }
    work.node();
    const BvhNode<T>& node = nodes_[top.first];
    const T d[2] = {distance2(query.point(), node.child[0].box()),
                    distance2(query.point(), node.child[1].box())};
    const int near = d[1] < d[0];
    for (const int i : {1 - near, near})
      if (!query.prunes(d[i])) stack[height++] = {node.child[i].first, node.child[i].count, d[i]};
  }
}

template <class T, class RayTest>
std::vector<SliceCell> Bvh<Triangles<T, RayTest>>::slice(int axis, double offset) const {
  offset = this->place_.kept_offset(axis, offset);
  const SlicePlane<3> plane(axis, offset);
  std::vector<SliceCell> cells;
  std::vector<std::pair<Child, std::size_t>> open;
  if (this->size() > 0) open.push_back({root_, 0});
  while (!open.empty()) {
    const auto [child, depth] = open.back();
    open.pop_back();
    if (!plane.cuts(child.box())) continue;
    if (child.count > 0) {
      cells.push_back({plane.outline(child.box()), depth, child.count});
    } else {
      for (const Child& c : nodes_[child.first].child) open.push_back({c, depth + 1});
    }
  }
  return this->place_.given(std::move(cells), axis);
}

static_assert(TriangleIndex<Bvh<Triangles<float, geometry::Watertight>>>);
static_assert(TriangleIndex<Bvh<Triangles<float, geometry::MollerTrumbore>>>);
static_assert(TriangleIndex<Bvh<Triangles<double, geometry::Watertight>>>);
static_assert(TriangleIndex<Bvh<Triangles<double, geometry::MollerTrumbore>>>);

}  // namespace treeline::accel
