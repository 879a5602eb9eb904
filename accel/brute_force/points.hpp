// Brute force over points: every query looks at every point. The measure of right for the trees, and the
// fastest below a few dozen points.
//
// Cost: nothing to build, O(n) per query, 16 bytes a point (float, 3-D). Known weakness: O(n).
#pragma once

#include "accel/point_build.hpp"
#include "accel/point_queries.hpp"
#include "accel/slice.hpp"

namespace treeline::accel {

template <class T, int D>
class BruteForce<Points<T, D>> : public PointQueries<BruteForce<Points<T, D>>, T, D> {
  using Base = PointQueries<BruteForce, T, D>;

 public:
  using typename Base::Box;
  using typename Base::Point;
  using Options = BuildOptions;

  explicit BruteForce(std::span<const Point> points, Options options = {}) : Base(points, options) {
    if (this->size() > 0) add_leaf(stats_, this->size(), 0, line_share(set_.box, set_.box));
    stats_.bytes = sizeof(*this) + set_.bytes();
  }

  /// One cell: the cloud's box.
  std::vector<SliceCell> slice(int axis, double offset) const {
    const SlicePlane<D> plane(axis, offset * static_cast<double>(set_.scale));
    if (!plane.cuts(set_.box)) return {};
    return scaled({{plane.outline(set_.box), 0, this->size()}}, static_cast<double>(set_.inverse_scale));
  }

 private:
  friend Base;
  using Base::set_;
  using Base::stats_;

  PointLeaf all() const { return {0, static_cast<std::uint32_t>(this->size()), false}; }
  template <class Visitor, class W>
  void visit_near(const Point& q, Visitor& visitor, W& work) const {
    work.node();
    set_.offer(all(), q, visitor, work);
  }
  template <class Leaf, class W>
  void visit_box(const Box&, Leaf&& leaf, W& work) const {
    work.node();
    leaf(all());
  }
};

static_assert(NeighborIndex<BruteForce<Points<float, 3>>> && Inspectable<BruteForce<Points<float, 3>>>);
static_assert(NeighborIndex<BruteForce<Points<double, 2>>> && Inspectable<BruteForce<Points<double, 2>>>);

}  // namespace treeline::accel
