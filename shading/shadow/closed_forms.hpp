// Shadows that are known in closed form: truth for whatever approximates them.
//
// All are shares of a light's area (or of its solid angle, for caps) that are seen. Cost: some sines. Known
// weakness: one blocker each; what is hidden twice is not counted once by adding these up.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

namespace treeline::shading::shadow {

/// A rectangle seen over an edge that is parallel to its sides. x: how far, on the light, the edge's
/// projection is from the light's middle, towards the hidden side, in whole widths.
inline double rectangle_over_edge(double x) { return std::clamp(0.5 + x, 0.0, 1.0); }

/// A disc seen over a straight edge. x: as above, in radii of the disc.
inline double disc_over_edge(double x) {
  x = std::clamp(x, -1.0, 1.0);
  return 0.5 + (x * std::sqrt(1 - x * x) + std::asin(x)) / std::numbers::pi;
}

/// Area that two circles of radii a, b > 0, whose middles are `distance` ≥ 0 apart, have in common.
inline double lens_area(double a, double b, double distance) {
  const double smaller = std::min(a, b);
  if (distance >= a + b) return 0;
  if (distance <= std::abs(a - b)) return std::numbers::pi * smaller * smaller;
  const double x = (distance * distance + a * a - b * b) / (2 * distance), y = distance - x;
  // A circle's segment beyond a chord at distance x from its middle.
  const auto segment = [](double r, double at) {
    const double c = std::clamp(at / r, -1.0, 1.0);
    return r * r * (std::acos(c) - c * std::sqrt(1 - c * c));
  };
  return segment(a, x) + segment(b, y);
}
/// A disc of radius 1 that another disc hides in part; both as projected on one plane.
inline double disc_behind_disc(double blocker, double distance) {
  return 1 - lens_area(1, blocker, distance) / std::numbers::pi;
}

/// Solid angle that two caps of half angles a, b in (0, pi), whose axes are `apart` in [0, pi], have in
/// common; for a + b + apart ≤ 2 pi. By Gauss and Bonnet: twice the angle of the lens' corners, less what
/// its two arcs turn.
inline double cap_overlap(double a, double b, double apart) {
  constexpr double pi = std::numbers::pi;
  if (apart >= a + b) return 0;
  if (apart <= std::abs(a - b)) return 2 * pi * (1 - std::cos(std::min(a, b)));
  // Of a spherical triangle, by half angles: the law of cosines cancels where caps are small.
  const auto angle = [](double opposite, double x, double y) {
    const double s = 0.5 * (opposite + x + y);
    return 2 * std::atan2(std::sqrt(std::max(0.0, std::sin(s - x) * std::sin(s - y))),
                          std::sqrt(std::max(0.0, std::sin(s) * std::sin(s - opposite))));
  };
  return 2 * (pi - angle(apart, a, b) - std::cos(a) * angle(b, apart, a) - std::cos(b) * angle(a, apart, b));
}
/// A spherical light of half angle `light` behind a ball of half angle `blocker`: the share of its solid
/// angle that is seen.
inline double cap_behind_cap(double light, double blocker, double apart) {
  return 1 - cap_overlap(light, blocker, apart) / (2 * std::numbers::pi * (1 - std::cos(light)));
}

}  // namespace treeline::shading::shadow
