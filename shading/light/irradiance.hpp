// Irradiance from shapes of one radiance, in closed form: the cosine-weighted solid angle above a receiver's
// horizon, in steradians; times a radiance in W / (m² sr) it is an irradiance in W / m².
//
// Sources: Lambert 1760 (polygons: half the sum over edges of the angle that each subtends times the cosine
// to its plane's normal); Snyder 1996 for balls cut by the horizon, after Lambert's theorem. Cost: an arc
// tangent an edge. Known weakness: no occlusion; Lambert's sum cancels for small polygons, where relative
// errors are some 1e-15 over their solid angle.
#pragma once

#include <span>

#include "shading/light/solid_angle.hpp"

namespace treeline::shading::light {

namespace detail {
/// The angle between two vectors times the unit normal of their plane, dotted with n.
inline double lambert_edge(const Vec3d& a, const Vec3d& b, const Vec3d& n) {
  const Vec3d normal = cross(a, b);
  const double sine = length(normal);
  return sine > 0 ? std::atan2(sine, dot(a, b)) * dot(normal, n) / sine : 0;
}
}  // namespace detail

/// Of a flat convex polygon, from either side, for a receiver at a point with unit normal n. In [0, pi].
inline double polygon_cosine_angle(std::span<const Vec3d> corners, const Vec3d& from, const Vec3d& n) {
  double sum = 0;
  Vec3d entry{}, exit{};
  bool cut = false;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    Vec3d a = corners[i] - from, b = corners[i + 1 < corners.size() ? i + 1 : 0] - from;
    const double ha = dot(a, n), hb = dot(b, n);
    if (ha <= 0 && hb <= 0) continue;
    const auto at_horizon = [&] { return (a * hb - b * ha) / (hb - ha); };
    if (ha < 0) entry = at_horizon(), a = entry, cut = true;
    if (hb < 0) exit = at_horizon(), b = exit, cut = true;
    sum += detail::lambert_edge(a, b, n);
  }
  // What closes a convex polygon along the horizon lies across n, and its plane's normal is n or -n.
  if (cut) sum += detail::lambert_edge(exit, entry, n);
  return 0.5 * std::abs(sum);
}

/// Of a ball, for a receiver outside of it; `cosine` between the receiver's normal and the way to the ball's
/// middle. In [0, pi].
inline double ball_cosine_angle(double radius, double distance, double cosine) {
  constexpr double pi = std::numbers::pi;
  const double s = std::min(1.0, radius / distance), s2 = s * s;  // sine of its half angle
  if (cosine >= s) return pi * s2 * cosine;
  if (cosine <= -s) return 0;
  // Cut by the horizon: the ball's cap, projected along its axis, less the part of an ellipse below.
  const double sine = std::sqrt((1 - cosine) * (1 + cosine)), x = std::sqrt(std::max(0.0, 1 / s2 - 1)),
               y = -x * (cosine / sine), root = sine * std::sqrt(std::max(0.0, 1 - y * y));
  return s2 * (cosine * std::acos(std::clamp(y, -1.0, 1.0)) - x * root) + std::atan2(root, x);
}

}  // namespace treeline::shading::light
