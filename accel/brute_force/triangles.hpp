// Brute force over triangles: every query tests every triangle. The yardstick for all trees.
//
// Cost: nothing to build, O(n) per query. No known weakness but that.
#pragma once

#include <ranges>

#include "accel/slice.hpp"
#include "accel/triangle_queries.hpp"

namespace treeline::accel {

template <class T, class RayTest>
class BruteForce<Triangles<T, RayTest>>
    : public TriangleQueries<BruteForce<Triangles<T, RayTest>>, Triangles<T, RayTest>> {
  using Primitives = Triangles<T, RayTest>;
  using Base = TriangleQueries<BruteForce, Primitives>;
  friend Base;

 public:
  using Options = BuildOptions;

  explicit BruteForce(std::span<const geometry::Triangle<T>> triangles, const Options& options = {})
      : BruteForce(TriangleSet<T>(triangles, options), options) {}
  explicit BruteForce(const geometry::Mesh<T>& mesh, const Options& options = {})
      : BruteForce(TriangleSet<T>(mesh, options), options) {}

  /// One cell: the box of all triangles.
  std::vector<SliceCell> slice(int axis, double offset) const {
    offset = this->place_.kept_offset(axis, offset);
    const SlicePlane<3> plane(axis, offset);
    if (this->size() == 0 || !plane.cuts(this->bounds_)) return {};
    return this->place_.given({{plane.outline(this->bounds_), 0, this->size()}}, axis);
  }

 private:
  BruteForce(TriangleSet<T>&& set, const Options& options) : Base(set), triangles_(set.items.size()) {
    triangles_.put(0, set.items, std::views::iota(std::size_t{0}, set.items.size()));
    TreeStats& s = this->stats_;
    s.references = s.largest_leaf = triangles_.size();
    s.leaves = triangles_.size() == 0 ? 0 : 1;
    s.sah_cost = static_cast<double>(triangles_.size());
    s.bytes = sizeof(*this) + triangles_.bytes();
    this->keep_flat(std::move(set), options);
  }

  template <bool any, class W>
  void trace(RayQuery<Primitives>& query, W& work) const {
    work.primitive(triangles_.size());
    query.template test<any>(triangles_, 0, triangles_.size());
  }
  template <class W>
  void approach(ClosestQuery<T>& query, W& work) const {
    work.primitive(triangles_.size());
    query.test(triangles_, 0, triangles_.size());
  }

  TriangleLeaves<T> triangles_;  // one leaf
};

static_assert(TriangleIndex<BruteForce<Triangles<float, geometry::Watertight>>>);
static_assert(TriangleIndex<BruteForce<Triangles<float, geometry::MollerTrumbore>>>);
static_assert(TriangleIndex<BruteForce<Triangles<double, geometry::Watertight>>>);
static_assert(TriangleIndex<BruteForce<Triangles<double, geometry::MollerTrumbore>>>);

}  // namespace treeline::accel
