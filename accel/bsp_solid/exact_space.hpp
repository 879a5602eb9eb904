// Planes and corners of polygons without rounding: the arithmetic of exact solids.
//
// A plane has whole coefficients, a corner is a vertex of the mesh or the point where three planes meet;
// cutting a polygon makes new corners from planes that exist, so that nothing ever grows or rounds. Sources:
// Bernstein and Fussell 2009; Trettner, Nehring-Wirxel and Kobbelt 2022 (the bits). Bits: coordinates |x| <=
// 2^25; normals, cross products of differences, 2^53 and so exact in double; offsets 3 · 2^78; the cross
// product of two normals 2^107; their determinant 3 · 2^160; the coordinates of a meeting point times that 9
// · 2^185; its product with a fourth plane 27 · 2^238 + 9 · 2^238 < 2^244.
//
// Filter: a corner keeps its position in double, found from the exact one with an error of 5 u; n · x - d
// then is off by at most (5 + 1 + 3) u |n| |x| + 4 u |d|, and 12 u (|n|_1 2^25 + |d|), found once a plane,
// covers it. Vertices within it are decided in 128 bits; other corners by the planes they are known to lie
// in, else in 256. Planes are kept once: equal ones, whatever their direction, have the same number.
#pragma once

#include <numeric>
#include <unordered_map>
#include <vector>

#include "accel/bsp_solid/grid.hpp"
#include "accel/bsp_solid/wide_integer.hpp"
#include "geometry/exact/dyadic.hpp"

namespace treeline::accel::solid {

using PlaneId = std::uint32_t;
inline constexpr PlaneId no_plane = 0xffffffffu;

class ExactSpace {
 public:
  using Vec3d = geometry::Vec3d;
  static constexpr bool is_exact = true;

  struct Plane {
    std::int64_t normal[3];
    Int128 offset;         // normal · x = offset
    Vec3d rounded_normal;  // exact
    double rounded_offset, doubt;
    bool operator==(const Plane& o) const {
      return normal[0] == o.normal[0] && normal[1] == o.normal[1] && normal[2] == o.normal[2] &&
             offset == o.offset;
    }
  };
  /// A corner of a polygon, and the edge that leaves it.
  struct Corner {
    Vec3d at;                                            // in steps
    PlaneId planes[3] = {no_plane, no_plane, no_plane};  // that meet here; none: a vertex, at is exact
    PlaneId also = no_plane;                             // one more that it is known to lie in
    PlaneId edge =
        no_plane;  // a plane through the edge, other than the polygon's; none yet: both ends are vertices
    PlaneId twin = no_plane;  // one more that the edge is known to lie in
  };
  struct Facing {
    PlaneId plane;
    bool flip;  // the plane's normal points the other way
  };

  explicit ExactSpace(const SolidGrid& grid) : grid(grid) {}

  SolidGrid grid;
  std::vector<Plane> planes;
  mutable std::uint64_t whole = 0, wide = 0;  // signs that double left open, decided in 128 and in 256 bits

  Corner vertex(const Vec3d& p) const {
    const Vec3d s = grid.steps(p);
    Corner c;
    for (int k = 0; k < 3; ++k) c.at[k] = std::rint(s[k]);
    return c;
  }
  static bool is_in_reach(const Corner& c) {
    return std::max({std::abs(c.at[0]), std::abs(c.at[1]), std::abs(c.at[2])}) <= SolidGrid::reach;
  }
  /// The plane through three vertices; no_plane if they are on a line.
  Facing plane_through(const Corner& a, const Corner& b, const Corner& c) {
    std::int64_t p[3], q[3], n[3];
    for (int k = 0; k < 3; ++k)
      p[k] = std::int64_t(b.at[k] - a.at[k]), q[k] = std::int64_t(c.at[k] - a.at[k]);
    for (int k = 0; k < 3; ++k) n[k] = p[(k + 1) % 3] * q[(k + 2) % 3] - p[(k + 2) % 3] * q[(k + 1) % 3];
    return plane_at(n, a);
  }
  Facing axis_plane(int axis, double where) {
    std::int64_t n[3] = {0, 0, 0};
    n[axis] = 1;
    Corner c;
    c.at[axis] = std::rint(where);
    return plane_at(n, c);
  }
  /// Numbers a plane of another space on the same grid.
  Facing add(Plane p) {
    std::int64_t divisor = std::gcd(std::gcd(p.normal[0], p.normal[1]), p.normal[2]);
    if (divisor == 0) return {no_plane, false};
    const bool flip = p.normal[0] != 0   ? p.normal[0] < 0
                      : p.normal[1] != 0 ? p.normal[1] < 0
                                         : p.normal[2] < 0;
    if (flip) divisor = -divisor;
    for (auto& x : p.normal) x /= divisor;
    p.offset /= divisor;
    const auto [first, last] = numbers_.equal_range(hash(p));
    for (auto it = first; it != last; ++it)
      if (planes[it->second] == p) return {it->second, flip};
    double size = 0;
    for (int k = 0; k < 3; ++k)
      p.rounded_normal[k] = double(p.normal[k]), size += std::abs(p.rounded_normal[k]);
    p.rounded_offset = double(p.offset);
    p.doubt = 12 * 0x1p-53 * (size * SolidGrid::reach + std::abs(p.rounded_offset));
    const auto id = static_cast<PlaneId>(planes.size());
    numbers_.emplace(hash(p), id);
    planes.push_back(p);
    return {id, flip};
  }

  /// 1 where the plane's normal points, 0 on it, -1 behind.
  int side(PlaneId plane, const Corner& c) const {
    const Plane& p = planes[plane];
    const double height = dot(p.rounded_normal, c.at) - p.rounded_offset;
    if (std::abs(height) > p.doubt) [[likely]]
      return height > 0 ? 1 : -1;
    return exact_side(plane, c);
  }
  /// Of any point, in steps as rounded and as given.
  int side(PlaneId plane, const Vec3d& steps, const Vec3d& position) const {
    const Plane& p = planes[plane];
    const double height = dot(p.rounded_normal, steps) - p.rounded_offset;
    const double size =
        std::max({std::abs(steps[0]), std::abs(steps[1]), std::abs(steps[2]), SolidGrid::reach});
    if (std::abs(height) > p.doubt * (size / SolidGrid::reach)) [[likely]]
      return height > 0 ? 1 : -1;
    return exact_side(p, position);
  }
  double height(PlaneId plane, const Vec3d& steps) const {
    return dot(planes[plane].rounded_normal, steps) - planes[plane].rounded_offset;
  }

  /// A plane through an edge of a polygon, other than the polygon's.
  PlaneId edge(PlaneId polygon, Corner& from, const Corner& to) {
    if (from.edge == no_plane) from.edge = edge_plane(polygon, from, to);
    return from.edge;
  }
  /// Where an edge of a polygon crosses a plane that its ends lie on either side of.
  Corner cut(PlaneId polygon, Corner& from, const Corner& to, PlaneId plane) {
    edge(polygon, from, to);
    Corner c;
    c.planes[0] = polygon, c.planes[1] = from.edge, c.planes[2] = plane;
    c.also = from.twin;
    c.edge = from.edge, c.twin = from.twin;
    const Meeting m = meeting(c);
    const double below = m.below.rounded();
    for (int k = 0; k < 3; ++k) c.at[k] = m.above[k].rounded() / below;
    return c;
  }

 private:
  struct Meeting {  // of three planes: above / below
    Int256 above[3], below;
  };

  static std::size_t hash(const Plane& p) {
    std::uint64_t h = static_cast<std::uint64_t>(p.offset);
    for (const std::int64_t x : p.normal)
      h = (h ^ static_cast<std::uint64_t>(x) ^ h >> 29) * 0x9e3779b97f4a7c15ull;
    return h ^ h >> 32;
  }
  Facing plane_at(const std::int64_t (&n)[3], const Corner& a) {
    Plane p{};
    for (int k = 0; k < 3; ++k) p.normal[k] = n[k], p.offset += Int128(n[k]) * std::int64_t(a.at[k]);
    return add(p);
  }
  /// Through the edge and along the axis that the polygon faces most.
  PlaneId edge_plane(PlaneId polygon, const Corner& from, const Corner& to) {
    const int axis = largest_axis(planes[polygon].rounded_normal), i = (axis + 1) % 3, j = (axis + 2) % 3;
    std::int64_t n[3] = {0, 0, 0};
    n[i] = std::int64_t(to.at[j] - from.at[j]), n[j] = std::int64_t(from.at[i] - to.at[i]);
    return plane_at(n, from).plane;
  }
  Meeting meeting(const Corner& c) const {
    const Plane* p[3] = {&planes[c.planes[0]], &planes[c.planes[1]], &planes[c.planes[2]]};
    Meeting m;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::int64_t *q = p[(i + 1) % 3]->normal, *r = p[(i + 2) % 3]->normal;
      for (int k = 0; k < 3; ++k) {
        const int u = (k + 1) % 3, v = (k + 2) % 3;
        const Int128 cross = Int128(q[u]) * r[v] - Int128(q[v]) * r[u];
        m.above[k] = m.above[k] + Int256(cross) * p[i]->offset;
        if (i == 0) m.below = m.below + Int256(cross) * p[0]->normal[k];
      }
    }
    return m;
  }
  [[gnu::noinline]] int exact_side(PlaneId plane, const Corner& c) const {
    const Plane& p = planes[plane];
    if (c.planes[0] == no_plane) {
      ++whole;
      Int128 height = -p.offset;
      for (int k = 0; k < 3; ++k) height += Int128(p.normal[k]) * std::int64_t(c.at[k]);
      return height > 0 ? 1 : height < 0 ? -1 : 0;
    }
    if (plane == c.planes[0] || plane == c.planes[1] || plane == c.planes[2] || plane == c.also) return 0;
    ++wide;
    const Meeting m = meeting(c);
    Int256 height = -(m.below * p.offset);
    for (int k = 0; k < 3; ++k) height = height + m.above[k] * p.normal[k];
    return height.sign() * m.below.sign();
  }
  [[gnu::noinline, gnu::cold]] int exact_side(const Plane& p, const Vec3d& position) const {
    using geometry::Dyadic;
    const auto low = static_cast<std::int64_t>(p.offset & ((Int128(1) << 40) - 1));
    Dyadic height = -(Dyadic(double(p.offset >> 40)) * Dyadic(0x1p40) + Dyadic(double(low)));
    for (int k = 0; k < 3; ++k)
      height += Dyadic(p.rounded_normal[k]) *
                (Dyadic(position[k]) * Dyadic(1 / grid.spacing) - Dyadic(grid.centre[k]));
    return height.sign();
  }

  std::unordered_multimap<std::size_t, PlaneId> numbers_;
};

}  // namespace treeline::accel::solid
