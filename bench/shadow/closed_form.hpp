// How much of a light the edge of a half-plane leaves, by formula.
//
// Seen from a receiver the edge is a great circle, and so the border of the shadow on the light is a straight
// line on an area light's plane, or an arc of a great circle on a directional one's cap. A disc: V = ½ +
// (x√(1−x²) + asin x)/π, x the distance of its middle from that line in radii. A rectangle: clipped as a
// polygon. A cap: spherical segments. Exact; nothing is assumed parallel.
#pragma once

#include <array>
#include <numbers>
#include <vector>

#include "bench/shadow/lights.hpp"
#include "datasets_gen/hard/hard_shadows.hpp"

namespace treeline::bench::shadow {

/// The share of a cap of half angle `a` on the lit side of a great circle, whose pole is `height` above the
/// middle: sin of its angular distance, positive where the middle is lit.
inline double cap_share(double a, double height) {
  const double d = std::asin(std::clamp(height, -1.0, 1.0));
  if (d >= a) return 1;
  if (d <= -a) return 0;
  // The smaller side: a sector of the cap less the triangle to its middle (Gauss and Bonnet).
  const double e = std::abs(d);
  const double outer = 2 * (std::acos(std::min(1.0, std::sin(e) / std::sin(a))) -
                            std::cos(a) * std::acos(std::min(1.0, std::tan(e) / std::tan(a))));
  const double share = outer / (2 * std::numbers::pi * (1 - std::cos(a)));
  return d > 0 ? 1 - share : share;
}

/// The share of the unit disc at x above a line, x = 1 … −1 of its middle's distance.
inline double disc_share(double x) {
  if (x >= 1) return 1;
  if (x <= -1) return 0;
  return 0.5 + (x * std::sqrt(1 - x * x) + std::asin(x)) / std::numbers::pi;
}

/// The share of the square [−1, 1]² where a x + b y + c > 0.
inline double square_share(double a, double b, double c) {
  std::vector<std::array<double, 2>> in{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}, out;
  const auto value = [&](const std::array<double, 2>& p) { return a * p[0] + b * p[1] + c; };
  for (std::size_t i = 0; i < in.size(); ++i) {
    const auto p = in[i], q = in[(i + 1) % in.size()];
    const double f = value(p), g = value(q);
    if (f > 0) out.push_back(p);
    if ((f > 0) != (g > 0)) {
      const double t = f / (f - g);
      out.push_back({p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1])});
    }
  }
  double area = 0;
  for (std::size_t i = 0; i < out.size(); ++i) {
    const auto p = out[i], q = out[(i + 1) % out.size()];
    area += 0.5 * (p[0] * q[1] - p[1] * q[0]);
  }
  return std::clamp(area / 4, 0.0, 1.0);
}

/// The share that one half-plane takes; it must end nowhere else in sight of the receiver.
inline double blocked_by(const datasets::HalfPlane& plane, const Light& light, const Vec3d& from) {
  // On the light's side of the blocker, or in its plane, nothing is blocked.
  Vec3d away = cross(plane.along, plane.into);
  const Vec3d middle = light.kind == LightKind::directional ? -light.direction : light.position - plane.point;
  if (dot(away, middle) < 0) away = -away;
  if (dot(away, from - plane.point) > -1e-9 * length(away)) return 0;
  // The plane through receiver and edge; its normal leads away from the blocker.
  Vec3d n = normalized(cross(plane.point - from, plane.along));
  if (dot(n, plane.into) > 0) n = -n;
  const auto above = [&](const Vec3d& p) { return dot(p - from, n); };
  switch (light.kind) {
    case LightKind::directional: {
      const double height = -dot(light.direction, n);
      return light.angle == 0 ? (height > 0 ? 0 : 1) : 1 - cap_share(light.angle, height);
    }
    case LightKind::disc: {
      const double reach = std::hypot(dot(light.u, n), dot(light.v, n)), c = above(light.position);
      if (reach > 0) return 1 - disc_share(c / reach);
      return c > 0 ? 0 : 1;
    }
    case LightKind::rectangle:
      if (is_hard(light)) break;
      return 1 - square_share(dot(light.u, n), dot(light.v, n), above(light.position));
    default:
      break;
  }
  return above(light.position) > 0 ? 0 : 1;
}

/// The share of the light that all of them leave.
inline double visible_past(const datasets::Blockers& blockers, const Light& light, const Vec3d& from) {
  double most = 0, sum = 0;
  for (const auto& plane : blockers.planes) {
    const double blocked = blocked_by(plane, light, from);
    most = std::max(most, blocked), sum += plane.sign * blocked;
  }
  return std::clamp(1 - (blockers.nested ? most : sum), 0.0, 1.0);
}

}  // namespace treeline::bench::shadow
