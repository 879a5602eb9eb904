// Radiometric quantities that cannot be mistaken for each other, and what leads from one to another.
//
// Problem: flux, intensity, irradiance, radiosity and radiance are all "how much light", and a factor of pi,
// a cosine or r² lies between them. Here units are part of the type: a product of the wrong ones does not
// compile. Irradiance arrives at a surface and radiosity leaves it; both are W / m², and differ by type all
// the same. Source: the definitions of ISO 80000-7. Cost: none, each is one number. Known weakness: one
// number, so colours are three of them; steradians are counted as a unit, which SI leaves open.
#pragma once

#include <cmath>
#include <compare>
#include <numbers>

namespace treeline::shading::light {

enum class Flow { any, arriving, leaving };

/// W^watts · (m²)^areas · sr^angles.
template <int watts, int areas, int angles, Flow flow = Flow::any>
struct Quantity {
  double value = 0;

  constexpr auto operator<=>(const Quantity&) const = default;
  friend constexpr Quantity operator+(Quantity a, Quantity b) { return {a.value + b.value}; }
  friend constexpr Quantity operator-(Quantity a, Quantity b) { return {a.value - b.value}; }
  friend constexpr Quantity operator*(Quantity a, double s) { return {a.value * s}; }
  friend constexpr Quantity operator*(double s, Quantity a) { return {s * a.value}; }
  friend constexpr Quantity operator/(Quantity a, double s) { return {a.value / s}; }
};

template <int w, int a, int s, Flow f, int w2, int a2, int s2, Flow f2>
constexpr Quantity<w + w2, a + a2, s + s2> operator*(Quantity<w, a, s, f> x, Quantity<w2, a2, s2, f2> y) {
  return {x.value * y.value};
}
template <int w, int a, int s, Flow f, int w2, int a2, int s2, Flow f2>
constexpr Quantity<w - w2, a - a2, s - s2> operator/(Quantity<w, a, s, f> x, Quantity<w2, a2, s2, f2> y) {
  return {x.value / y.value};
}

using Area = Quantity<0, 1, 0>;                         ///< m²
using SolidAngle = Quantity<0, 0, 1>;                   ///< sr
using Flux = Quantity<1, 0, 0>;                         ///< W; also called power
using Intensity = Quantity<1, 0, -1>;                   ///< W / sr: flux per solid angle, of a point
using Irradiance = Quantity<1, -1, 0, Flow::arriving>;  ///< W / m²: flux that arrives per area
using Radiosity = Quantity<1, -1, 0, Flow::leaving>;    ///< W / m²: flux that leaves per area
using Radiance = Quantity<1, -1, -1>;  ///< W / (m² sr): per area across the ray and solid angle

inline constexpr SolidAngle whole_sphere{4 * std::numbers::pi}, hemisphere{2 * std::numbers::pi};

constexpr Irradiance arriving(Flux flux, Area area) { return {(flux / area).value}; }
constexpr Radiosity leaving(Flux flux, Area area) { return {(flux / area).value}; }
constexpr Flux flux_of(Irradiance e, Area area) { return e * area; }
constexpr Flux flux_of(Radiosity b, Area area) { return b * area; }

/// Of a point that shines the same in all directions.
constexpr Flux flux_of(Intensity intensity) { return intensity * whole_sphere; }
constexpr Intensity intensity_of(Flux flux) { return flux / whole_sphere; }

/// A surface from which the same radiance leaves in all directions of its hemisphere: the cosine integrates
/// to pi steradians.
constexpr Radiosity radiosity_of(Radiance l) { return {l.value * std::numbers::pi}; }
constexpr Radiance radiance_of(Radiosity b) { return {b.value / std::numbers::pi}; }
constexpr Flux flux_of(Radiance l, Area area) { return flux_of(radiosity_of(l), area); }

/// Under a hemisphere of one radiance.
constexpr Irradiance irradiance_under(Radiance sky) { return {sky.value * std::numbers::pi}; }

/// From a point at a distance in metres; cosine between the surface's normal and the way to the point. 0
/// where that is behind the surface.
constexpr Irradiance irradiance_from(Intensity intensity, double distance, double cosine) {
  return {cosine > 0 ? intensity.value * cosine / (distance * distance) : 0.0};
}

/// That a small solid angle of one radiance brings.
constexpr Irradiance irradiance_from(Radiance l, SolidAngle angle, double cosine) {
  return {cosine > 0 ? l.value * angle.value * cosine : 0.0};
}

/// Of a diffuse surface: the share `albedo` in [0, 1] of what arrives leaves again.
constexpr Radiosity reflected(Irradiance e, double albedo) { return {e.value * albedo}; }

}  // namespace treeline::shading::light
