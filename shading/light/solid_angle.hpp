// Solid angles that shapes subtend at a point, exact for any distance and from any side.
//
// Sources: Van Oosterom and Strackee 1983 (triangle); Archimedes (cap, sphere); spherical_ellipse.hpp (disc).
// None cancels where shapes are small or far: relative errors are some 1e-15, over the sine of the elevation
// above a flat shape's plane. Area / r² is off by the cosine, and by more the nearer one is. Units:
// steradians. Points in a flat shape's plane see nothing of it. Cost: an arc tangent a triangle. Known
// weakness: no horizon: all of the shape counts, also what is below a receiver's surface.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "geometry/triangle.hpp"

namespace treeline::shading::light {

using geometry::Box;
using geometry::Triangle3d;
using geometry::Vec2d;
using geometry::Vec3d;

inline constexpr double sphere_solid_angle = 4 * std::numbers::pi;
inline constexpr double hemisphere_solid_angle = 2 * std::numbers::pi;

/// Of all directions within `angle` of an axis, in [0, pi] radians.
inline double cap_solid_angle(double angle) {
  const double s = std::sin(angle / 2);
  return sphere_solid_angle * s * s;
}

namespace detail {
/// 1 - cos of the half angle that a ball subtends from outside; 2 from within it.
inline double ball_one_minus_cosine(double radius, double distance) {
  if (distance <= radius) return distance < radius ? 2 : 1;
  const double s = radius / distance;
  return s * s / (1 + std::sqrt((1 - s) * (1 + s)));
}
}  // namespace detail

/// Of a ball, from a point at `distance` from its middle: all of the sphere from within, half from its
/// surface.
inline double ball_solid_angle(double radius, double distance) {
  return hemisphere_solid_angle * detail::ball_one_minus_cosine(radius, distance);
}

/// Of a triangle, from either side.
inline double triangle_solid_angle(const Triangle3d& t, const Vec3d& from) {
  const Vec3d a = t.a - from, b = t.b - from, c = t.c - from;
  // a · (b × c), by edges: they are small where the triangle is, and lose no digits to its distance.
  const double volume = std::abs(dot(a, t.area_normal()));
  if (!(volume > 0)) return 0;
  const double la = length(a), lb = length(b), lc = length(c);
  return 2 * std::atan2(volume, la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
}

/// True if a triangle covers the direction, from either side; false for all from a point of its plane.
inline bool triangle_covers(const Triangle3d& t, const Vec3d& from, const Vec3d& direction) {
  const Vec3d a = t.a - from, b = t.b - from, c = t.c - from, ab = cross(a, b);
  const double side = dot(c, ab);
  return side * dot(direction, ab) >= 0 && side * dot(direction, cross(b, c)) >= 0 &&
         side * dot(direction, cross(c, a)) >= 0 && side != 0;
}

/// Of the rectangle middle ± u ± v, with u and v perpendicular and not zero, from either side.
inline double rectangle_solid_angle(const Vec3d& middle, const Vec3d& u, const Vec3d& v, const Vec3d& from) {
  const Vec3d to = middle - from;
  const double lu = length(u), lv = length(v), x = std::abs(dot(to, u)) / lu, y = std::abs(dot(to, v)) / lv;
  if (x <= lu && y <= lv) {
    // Over it: four right-angled parts, each of area atan(x y / (h r)). Triangles would share a diagonal, and
    // from near there neither has an area that is well defined.
    const double h = std::abs(dot(to, cross(u, v))) / (lu * lv);
    if (!(h > 0)) return 0;
    double sum = 0;
    for (const double a : {lu - x, lu + x})
      for (const double b : {lv - y, lv + y}) sum += std::atan2(a * b, h * std::sqrt(a * a + b * b + h * h));
    return sum;
  }
  const Vec3d a = middle - u - v, c = middle + u + v;
  return triangle_solid_angle({a, middle + u - v, c}, from) +
         triangle_solid_angle({a, c, middle - u + v}, from);
}

/// The side of a box on which one looks when looking along an axis, to its lower (0) or upper (1) end.
struct BoxFace {
  Vec3d middle, u, v;  ///< middle ± u ± v; the cross product of u and v points out of the box
};
inline BoxFace box_face(const Box<double, 3>& box, int axis, int end) {
  const Vec3d half = (box.high - box.low) * 0.5;
  BoxFace f{(box.low + box.high) * 0.5, {}, {}};
  f.middle[axis] = end ? box.high[axis] : box.low[axis];
  const int next = (axis + 1) % 3, last = (axis + 2) % 3;
  f.u[next] = half[next], f.v[last] = end ? half[last] : -half[last];
  return f;
}

/// Of a box with axis-parallel sides: all of the sphere from within, half, a quarter or an eighth of it from
/// a side, an edge or a corner.
inline double box_solid_angle(const Box<double, 3>& box, const Vec3d& from) {
  double sum = 0, inside = sphere_solid_angle;
  for (int axis = 0; axis < 3; ++axis) {
    if (from[axis] == box.low[axis] || from[axis] == box.high[axis]) inside /= 2;
    for (const int end : {0, 1})
      if (end ? from[axis] > box.high[axis] : from[axis] < box.low[axis]) {
        const BoxFace f = box_face(box, axis, end);
        sum += rectangle_solid_angle(f.middle, f.u, f.v, from), inside = 0;
      }
  }
  return sum + inside;
}

}  // namespace treeline::shading::light
