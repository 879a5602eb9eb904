// What a closest-point query of the wide tree is asked in, what it asks, and what it has found.
#pragma once

#include <limits>
#include <optional>

#include "accel/bvh/triangle_input.hpp"
#include "accel/bvh/wide_closest.hpp"
#include "accel/bvh/wide_closest_exact.hpp"
#include "accel/bvh/wide_collapse.hpp"

namespace treeline::accel::wide {

/// A tree and its space.
struct ClosestSpace {
  const RayTree& tree;
  const TriangleInput::Place& place;
  bool has_vanished = false;  // triangles that a refit left without an area, in the tree at (0, 0, 0)
  bool gives_hints = true;

  /// A query, moved and scaled into the space.
  geometry::Vec3d placed(const geometry::Vec3f& query) const {
    return (geometry::Vec3d(query) - geometry::Vec3d(place.centre)) *
           static_cast<double>(place.scale.factor());
  }
  ClosestPlace in_float(const geometry::Vec3d& placed) const {
    return {geometry::Vec3f(placed), place.centre != geometry::Vec3f{}};
  }
  /// A point of the space, in the user's.
  geometry::Vec3d in_users(const geometry::Vec3d& point) const {
    return point * inverse() + geometry::Vec3d(place.centre);
  }
  /// Of lengths of the space, in the user's; and of their squares.
  double inverse() const { return static_cast<double>(place.scale.inverse()); }
  double inverse2() const { return inverse() * inverse(); }
};

/// What is asked.
struct ClosestQuestion {
  geometry::Vec<float, 3> point;
  double limit;  // distances beyond are of no interest
};

/// The nearest triangle so far; what is measured is in the user's units.
struct ClosestSoFar {
  double distance2 = std::numeric_limits<double>::infinity();
  double low = distance2, high = distance2;  // bounds on the true squared distance; where certified
  Id id = no_id;
  Feature feature = Feature::face;
  geometry::Vec3d point{};
  Ref leaf = no_ref;                 // where it, or one before it, is, for a hint
  std::optional<ExactlyNear> exact;  // where certified, and found out
};

}  // namespace treeline::accel::wide
