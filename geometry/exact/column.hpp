// Where a point lies by the faces above it, exactly: the number of crossings of the ray that leads upward.
//
// Conventions: the ray runs along +z from the point moved aside by an infinitely small step along x and one
// infinitely smaller along y, so that it meets no edge and no corner, and no face edge-on (simulation of
// simplicity, Edelsbrunner and Muecke 1990): faces that share an edge agree on whose side of it the ray
// passes, and no case needs a retry. Points on a face, its edges and corners included, are told apart. Any
// finite floats or doubles. Cost: some 20 ns a face whose shadow holds the point.
//
// The oracle for inside and outside. It has nothing in common with the trees' own tests but the arithmetic of
// orientations: they choose their rays freely and try others where one meets an edge.
#pragma once

#include "geometry/exact/orientation.hpp"
#include "geometry/exact/triangle_distance.hpp"

namespace treeline::geometry {

/// Whether p is a point of the closed triangle, which may have no area.
inline bool is_on_triangle(const Vec3d& p, const Triangle3d& t) {
  const auto box = t.box();
  for (int k = 0; k < 3; ++k)
    if (!(box.low[k] <= p[k] && p[k] <= box.high[k])) return false;
  return orientation(t.a, t.b, t.c, p) == 0 && exact_distance2(p, t) == 0;
}
inline bool is_on_triangle(const Vec3f& p, const Triangle3f& t) {
  return is_on_triangle(Vec3d(p), Triangle3d(t));
}

/// Whether the column above p passes the triangle: 1 if that faces up (the column leaves by it), -1 if it
/// faces down, 0 if not. Of no meaning for p on the triangle.
inline int column_crossing(const Vec3d& p, const Triangle3d& t) {
  const Vec2d q{p[0], p[1]};
  const auto turn = [&](const Vec3d& u, const Vec3d& v) {
    const Vec2d from{u[0], u[1]}, to{v[0], v[1]};
    if (const int sign = orientation(from, to, q); sign != 0) return sign;
    // By how the sign changes with q: first along x, then along y.
    if (from[1] != to[1]) return to[1] < from[1] ? 1 : -1;
    return int(to[0] > from[0]) - int(to[0] < from[0]);
  };
  const int side = turn(t.a, t.b);
  if (side == 0 || turn(t.b, t.c) != side || turn(t.c, t.a) != side) return 0;
  return orientation(t.a, t.b, t.c, p) == -side ? side : 0;
}
inline int column_crossing(const Vec3f& p, const Triangle3f& t) {
  return column_crossing(Vec3d(p), Triangle3d(t));
}

}  // namespace treeline::geometry
