// Planes and corners of polygons in floating point with an epsilon: what most BSP code does, kept to show how
// it fails.
//
// A corner is a position, found by interpolation and rounded; it counts as on a plane within epsilon
// (relative to the solid's reach). Known weakness: all of it. Pieces shrink to slivers, corners drift off
// their planes, and points near the surface end on the wrong side; no epsilon avoids both (measured figures:
// bsp_solid.hpp).
#pragma once

#include <vector>

#include "accel/bsp_solid/exact_space.hpp"

namespace treeline::accel::solid {

template <class T>
class RoundedSpace {
 public:
  using Vec3d = geometry::Vec3d;
  using V = geometry::Vec<T, 3>;
  static constexpr bool is_exact = false;

  struct Plane {
    V rounded_normal;  // of unit length
    T rounded_offset;
  };
  struct Corner {
    V at;
  };
  using Facing = ExactSpace::Facing;

  explicit RoundedSpace(const SolidGrid& grid) : grid(grid) {}

  SolidGrid grid;
  std::vector<Plane> planes;
  T epsilon = 0;  // in steps

  Corner vertex(const Vec3d& p) const {
    const Vec3d s = grid.steps(p);
    return {V(Vec3d{std::rint(s[0]), std::rint(s[1]), std::rint(s[2])})};
  }
  static bool is_in_reach(const Corner& c) { return is_finite(c.at); }
  Facing plane_through(const Corner& a, const Corner& b, const Corner& c) {
    const V n = cross(b.at - a.at, c.at - a.at);
    const T l = length(n);
    if (!(l > T(0))) return {no_plane, false};
    planes.push_back({n / l, dot(n / l, a.at)});
    return {static_cast<PlaneId>(planes.size() - 1), false};
  }
  Facing axis_plane(int axis, double where) {
    V n{};
    n[axis] = 1;
    planes.push_back({n, static_cast<T>(std::rint(where))});
    return {static_cast<PlaneId>(planes.size() - 1), false};
  }
  int side(PlaneId plane, const Corner& c) const { return side_of(plane, c.at); }
  int side(PlaneId plane, const Vec3d& steps, const Vec3d&) const { return side_of(plane, V(steps)); }
  double height(PlaneId plane, const Vec3d& steps) const {
    return double(dot(planes[plane].rounded_normal, V(steps)) - planes[plane].rounded_offset);
  }
  Corner cut(PlaneId, const Corner& from, const Corner& to, PlaneId plane) const {
    const Plane& p = planes[plane];
    const T x = dot(p.rounded_normal, from.at) - p.rounded_offset,
            y = dot(p.rounded_normal, to.at) - p.rounded_offset;
    return {from.at + (to.at - from.at) * (x / (x - y))};
  }

 private:
  int side_of(PlaneId plane, const V& at) const {
    const T height = dot(planes[plane].rounded_normal, at) - planes[plane].rounded_offset;
    return height > epsilon ? 1 : height < -epsilon ? -1 : 0;
  }
};

}  // namespace treeline::accel::solid
