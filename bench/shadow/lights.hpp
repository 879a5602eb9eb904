// The light as a receiver sees it: its middle, any point of it, and whether all of it is above the surface.
//
// Shares of a light are shares of its area as its own plane has it, and of the solid angle for a directional
// one: what filters over shadow maps estimate. Not weighted by the cosine at the receiver. Kept apart from
// the techniques in shading/, so that their truth does not rest on the same lines.
#pragma once

#include <cmath>
#include <limits>
#include <numbers>

#include "geometry/sampling.hpp"
#include "shading/scene.hpp"

namespace treeline::bench::shadow {

using geometry::Vec3d;
using shading::Light;
using shading::LightKind;

inline constexpr double far_away = std::numeric_limits<double>::infinity();

/// From a receiver towards a point of the light.
struct ToLight {
  Vec3d direction;  ///< unit
  double distance = far_away;
};

/// Whether the light is a point or a single direction: its shadows are hard then.
inline bool is_hard(const Light& light) {
  switch (light.kind) {
    case LightKind::directional:
      return light.angle == 0;
    case LightKind::point:
    case LightKind::spot:
      return true;
    case LightKind::rectangle:
    case LightKind::disc:
      return length(light.u) == 0 && length(light.v) == 0;
  }
  return true;
}

/// The point of the light that (u, v) in [0, 1)² names; areas are kept.
inline ToLight to_light(const Light& light, const Vec3d& from, double u, double v) {
  if (light.kind == LightKind::directional) {
    if (light.angle == 0) return {-light.direction};
    const auto disc = geometry::sample_disc(u, v);  // of equal area on the cap around the middle
    const double r = std::min(1.0, length(disc)), height = 1 - std::cos(light.angle);
    const double z = 1 - r * r * height, s = std::sqrt(std::max(0.0, (2 - r * r * height) * height));
    const geometry::Frame<double> frame(-light.direction);
    return {frame(Vec3d{s * disc[0], s * disc[1], z})};
  }
  Vec3d at = light.position;
  if (light.kind == LightKind::rectangle) at += light.u * (2 * u - 1) + light.v * (2 * v - 1);
  if (light.kind == LightKind::disc) {
    const auto disc = geometry::sample_disc(u, v);
    at += light.u * disc[0] + light.v * disc[1];
  }
  const Vec3d d = at - from;
  const double far = length(d);
  return {d / far, far};
}

/// Its middle.
inline ToLight to_light(const Light& light, const Vec3d& from) {
  return light.kind == LightKind::directional ? ToLight{-light.direction} : to_light(light, from, 0.5, 0.5);
}

/// Whether the whole light is above the surface, by its sine's least share, and shines to this side. A spot
/// shines within its angle, a rectangle and a disc to where their direction goes.
inline bool lights(const Light& light, const Vec3d& at, const Vec3d& normal, double least_sine) {
  switch (light.kind) {
    case LightKind::directional: {
      const double sine = -dot(light.direction, normal);
      return std::asin(std::clamp(sine, -1.0, 1.0)) - light.angle > std::asin(least_sine);
    }
    case LightKind::point:
    case LightKind::spot: {
      const ToLight to = to_light(light, at);
      if (!(dot(to.direction, normal) > least_sine)) return false;
      return light.kind == LightKind::point || -dot(to.direction, light.direction) > std::cos(light.angle);
    }
    case LightKind::rectangle:
    case LightKind::disc:
      break;
  }
  if (!(dot(at - light.position, light.direction) > 0)) return false;
  // The lowest point of a rectangle is a corner, that of a disc at the end of the half axes' own projection.
  const double a = dot(light.u, normal), b = dot(light.v, normal);
  const double reach = light.kind == LightKind::disc ? std::hypot(a, b) : std::abs(a) + std::abs(b);
  const double low = dot(light.position - at, normal) - reach;
  return low > least_sine * (distance(light.position, at) + length(light.u) + length(light.v));
}

/// Half the angle that the light subtends, about, from a place: 0 for hard ones.
inline double half_angle(const Light& light, const Vec3d& from) {
  if (is_hard(light)) return 0;
  if (light.kind == LightKind::directional) return light.angle;
  return std::atan(std::max(length(light.u), length(light.v)) / distance(light.position, from));
}

}  // namespace treeline::bench::shadow
