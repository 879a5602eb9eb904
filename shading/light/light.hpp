// What all lights have in common: how they are sampled, and what a sample is worth.
//
// Problem: an integral over the light that arrives at a point is estimated from few directions; each light
// knows directions that matter, and the density it draws them with. A light is a value with sample(p, u, v),
// pdf(p, direction) and power(). Nothing here casts rays: a sample says how far its light is, and whoever
// uses it finds out what lies between. Lights are in double: solid angles of far and grazing ones leave no
// digits in float. Colours: red, green, blue. Known weakness: radiance is the same all over a light and in
// all directions that it emits to.
#pragma once

#include <concepts>
#include <limits>
#include <string>

#include "geometry/vec.hpp"
#include "shading/light/invalid_light.hpp"

namespace treeline::shading::light {

using geometry::Vec3d;

struct LightSample {
  Vec3d direction{};    ///< unit, from the point to the light
  double distance = 0;  ///< metres; infinite for a directional light
  /// Radiance that arrives from there if nothing is between; W / (m² sr). Of a light without extent: the
  /// irradiance that it brings a surface across the direction; W / m².
  Vec3d value{};
  double pdf = 0;      ///< of the direction, per steradian; 0 where nothing was sampled
  bool delta = false;  ///< of a light without extent: nothing else finds it, and its pdf counts 1

  /// The irradiance, across the direction, that this sample stands for: f · cosine · weight() has the
  /// reflected radiance as its mean; W / m². Zero where nothing was sampled.
  Vec3d weight() const { return pdf > 0 ? value / pdf : Vec3d{}; }
};

template <class L>
concept AnyLight = requires(const L& light, const Vec3d& p, const Vec3d& direction, double u, double v) {
  { light.sample(p, u, v) } -> std::same_as<LightSample>;  // u, v in [0, 1)
  { light.pdf(p, direction) } -> std::same_as<double>;     // of a unit direction; 0 for lights without extent
  { light.power() } -> std::same_as<Vec3d>;                // W
};

namespace detail {
inline void check_finite(const Vec3d& v, const char* light, const char* what) {
  if (!is_finite(v)) throw InvalidLight(std::string(light) + ": its " + what + " is not finite");
}
inline void check_positive(double x, const char* light, const char* what) {
  if (!(x > 0 && std::isfinite(x)))
    throw InvalidLight(std::string(light) + ": its " + what + " is " + std::to_string(x) +
                       "; it must be finite and above 0");
}
/// Radiance, intensity or irradiance.
inline void check_colour(const Vec3d& colour, const char* light, const char* what) {
  for (int k = 0; k < 3; ++k)
    if (!(colour[k] >= 0 && std::isfinite(colour[k])))
      throw InvalidLight(std::string(light) + ": its " + what + " is " + std::to_string(colour[k]) +
                         " in channel " + std::to_string(k) + "; it must be finite and not negative");
}
inline Vec3d unit(const Vec3d& v, const char* light, const char* what) {
  check_finite(v, light, what);
  const double scale = std::abs(v[largest_axis(v)]);
  if (!(scale > 0)) throw InvalidLight(std::string(light) + ": its " + what + " is zero");
  return normalized(v / scale);
}
/// Throws unless both are finite, not zero, and perpendicular to each other within 1e-6.
inline void check_half_sides(const Vec3d& u, const Vec3d& v, const char* light) {
  const Vec3d x = unit(u, light, "half side u"), y = unit(v, light, "half side v");
  if (std::abs(dot(x, y)) > 1e-6)
    throw InvalidLight(std::string(light) +
                       ": its half sides are not perpendicular; the cosine between them is " +
                       std::to_string(dot(x, y)));
}
}  // namespace detail

}  // namespace treeline::shading::light
