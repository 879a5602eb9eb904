// What trees that cut space by planes of any direction share: their node, the bound that a plane gives, the
// picture of their cells.
#pragma once

#include <span>
#include <vector>

#include "accel/point_set.hpp"
#include "accel/slice.hpp"
#include "geometry/tolerances.hpp"

namespace treeline::accel {

/// An inner node has its left child right behind it; points on the left have normal · (p - centre) <= offset
/// as computed in T, those on the right >= offset. The centre is the tree's: rounding is then relative to the
/// cloud's size, not to where it lies.
template <class T, int D>
struct PlaneNode {
  geometry::Vec<T, D> normal;
  T offset;
  std::uint32_t first;       // inner: right child; leaf: first entry
  std::uint32_t count : 31;  // leaf: entries; inner: 0
  std::uint32_t coincident : 1;

  bool leaf() const { return count > 0; }
  PointLeaf points() const { return {first, count, coincident == 1}; }
};

/// Bounds the squared distance of a query to what lies beyond a plane, from how far it is ahead of the plane.
/// Such a point is at least |ahead| away, but for the rounding of both projections, which is at most
/// plane_bound times the distances from the centre, and that of the squared distance compared, which is
/// relative unless it underflows.
template <class T, int D>
class PlaneBound {
 public:
  /// `reach`: the query's distance from the centre, and the largest of a point.
  explicit PlaneBound(T reach) : slack_(relative * reach) {}
  T operator()(T ahead) const {
    const T distance = std::max((std::abs(ahead) - slack_) * (T(1) - relative), T(0));
    const T square = distance * distance;
    return square < std::numeric_limits<T>::min() ? T(0) : square;
  }

 private:
  static constexpr T relative = geometry::tolerance::plane_bound<T>(D);
  T slack_;
};

/// Cells tile the cloud's box.
template <class Node, class T, int D>
std::vector<SliceCell> slice_of_planes(std::span<const Node> nodes, const PointSet<T, D>& set,
                                       const geometry::Vec<T, D>& centre, int axis, double offset) {
  using Direction = geometry::Vec<double, D>;
  const SlicePlane<D> plane(axis, offset * static_cast<double>(set.scale));
  std::vector<SliceCell> cells;
  if (!plane.cuts(set.box)) return cells;
  const auto visit = [&](const auto& self, std::size_t index, Outline outline, std::size_t depth) -> void {
    if (outline.size() < 3) return;
    const Node& node = nodes[index];
    if (node.leaf()) {
      cells.push_back({std::move(outline), depth, node.count});
      return;
    }
    // The node's plane within the cutting plane, relative to the outline's first corner to keep digits.
    const Direction normal(node.normal);
    Direction corner(centre);
    corner[plane.u] = outline[0][0], corner[plane.v] = outline[0][1];
    if (D == 3) corner[plane.axis] = plane.offset;
    const geometry::Vec2d line{normal[plane.u], normal[plane.v]};
    const double line_offset =
        static_cast<double>(node.offset) - dot(normal, corner - Direction(centre)) + dot(line, outline[0]);
    if (line == geometry::Vec2d{}) {  // parallel: all on one side
      self(self, line_offset > 0 ? index + 1 : node.first, std::move(outline), depth + 1);
      return;
    }
    self(self, index + 1, clipped(outline, line, line_offset), depth + 1);
    self(self, node.first, clipped(outline, -line, -line_offset), depth + 1);
  };
  visit(visit, 0, plane.outline(set.box), 0);
  return scaled(std::move(cells), static_cast<double>(set.inverse_scale));
}

}  // namespace treeline::accel
