// The parts of triangles that lie in a BSP cell: convex polygons, cut as the cell is cut.
//
// A corner within `on_plane` of a plane counts as on it. A fragment with corners clearly on both sides is
// cut; any other goes to one side whole, a fragment in the plane to the positive side. So a sliver beyond the
// plane is never cut off and lost: the point of it that a ray hits is within on_plane of the side that the
// fragment went to. Cuts keep a little more than the side, for their own rounding. A fragment gains at most
// one corner a cut.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "geometry/box.hpp"
#include "geometry/plane.hpp"
#include "geometry/tolerances.hpp"

namespace treeline::accel {

struct Fragment {
  std::uint32_t triangle;
  std::uint32_t first, count;  // corners
  double reach;                // of the whole triangle from the centre, along an axis
};

struct Fragments {
  std::vector<Fragment> items;
  std::vector<geometry::Vec3d> corners;  // relative to the centre, in units of the builder's

  std::size_t size() const { return items.size(); }
  const geometry::Vec3d* polygon(const Fragment& f) const { return corners.data() + f.first; }
  geometry::Box3d box(const Fragment& f) const {
    geometry::Box3d b;
    for (std::uint32_t i = 0; i < f.count; ++i) b.grow(corners[f.first + i]);
    return b;
  }
  void add(const Fragment& f, const geometry::Vec3d* polygon, std::size_t count) {
    items.push_back(
        {f.triangle, static_cast<std::uint32_t>(corners.size()), static_cast<std::uint32_t>(count), f.reach});
    corners.insert(corners.end(), polygon, polygon + count);
  }
};

struct Sides {
  bool negative, positive;
};

/// Where a fragment goes; `on_plane` relative to its reach.
inline Sides sides(const Fragments& all, const Fragment& f, const geometry::Plane3d& plane, double on_plane) {
  const geometry::Vec3d* p = all.polygon(f);
  double low = plane.signed_distance(p[0]), high = low;
  for (std::uint32_t i = 1; i < f.count; ++i) {
    const double d = plane.signed_distance(p[i]);
    low = std::min(low, d), high = std::max(high, d);
  }
  const bool negative = low < -on_plane * f.reach;
  return {negative, !negative || high > on_plane * f.reach};
}

/// Cuts fragments that reach to both sides and puts each where it goes.
inline void part(const Fragments& all, const geometry::Plane3d& plane, double on_plane,
                 Fragments (&parts)[2]) {
  std::vector<geometry::Vec3d> polygon;
  for (const Fragment& f : all.items) {
    const geometry::Vec3d* p = all.polygon(f);
    const Sides to = sides(all, f, plane, on_plane);
    if (!(to.negative && to.positive)) {
      parts[to.positive].add(f, p, f.count);
      continue;
    }
    const double slack = geometry::tolerance::clip_slack * f.reach;
    for (const int side : {0, 1}) {
      const auto beyond = [&](const geometry::Vec3d& x) {
        const double d = plane.signed_distance(x);
        return (side == 0 ? d : -d) - slack;
      };
      polygon.clear();
      double d = beyond(p[0]);
      for (std::uint32_t i = 0; i < f.count; ++i) {
        const geometry::Vec3d& q = p[i + 1 < f.count ? i + 1 : 0];
        const double next = beyond(q);
        if (d <= 0) polygon.push_back(p[i]);
        if ((d < 0 && next > 0) || (d > 0 && next < 0))
          polygon.push_back(p[i] + (q - p[i]) * (d / (d - next)));
        d = next;
      }
      if (!polygon.empty()) parts[side].add(f, polygon.data(), polygon.size());
    }
  }
}

}  // namespace treeline::accel
