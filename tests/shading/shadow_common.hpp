// Depth maps filled in closed form, and what is measured on them.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "geometry/random.hpp"
#include "shading/shadow/method.hpp"

namespace treeline::shading::shadow::test {

using geometry::Pcg32;

/// Light along +z, depth is z; x and y in [-half, half].
inline LightView parallel_view(double half = 1) {
  LightView v;
  v.half_width = v.half_height = half;
  return v;
}

/// Of a light that hangs over what it lights, at depth d_r of its map.
constexpr double d_r = 10;
inline Light square_light(double half_side) {
  Light light;
  light.kind = LightKind::rectangle, light.direction = {0, 0, 1};
  light.u = {half_side, 0, 0}, light.v = {0, half_side, 0};
  return light;
}

/// A light at the origin that looks along +z.
inline LightView perspective_view(double tangent, double near, double far) {
  LightView v;
  v.perspective = true, v.half_width = v.half_height = tangent, v.near = near, v.far = far;
  return v;
}

/// world_depth(x, y): along the light's axis, seen through a texel's centre; over a perspective view x and y
/// are those at distance 1. INFINITY for nothing.
inline DepthMap filled(const LightView& view, int size,
                       const std::function<double(double, double)>& world_depth) {
  DepthMap map{view, size, size, {}, {}};
  for (int j = 0; j < size; ++j)
    for (int i = 0; i < size; ++i) {
      const double x = (2 * (i + 0.5) / size - 1) * view.half_width,
                   y = (2 * (j + 0.5) / size - 1) * view.half_height;
      const double d = (world_depth(x, y) - view.near) / (view.far - view.near);
      map.first.push_back(d <= 1 ? float(d) : 1.0f);
    }
  return map;
}

/// A plane z = base + gx x + gy y with its normal towards a light along +z.
struct Plane {
  double base, gx, gy;
  double z(double x, double y) const { return base + gx * x + gy * y; }
  Vec3d normal() const { return normalized(Vec3d{gx, gy, -1}); }
  Receiver at(double x, double y) const { return {{x, y, z(x, y)}, normal()}; }
};
inline Plane tilted(double theta, double phi, double base = 0.5) {
  return {base, std::tan(theta) * std::cos(phi), std::tan(theta) * std::sin(phi)};
}
inline constexpr double degrees = std::numbers::pi / 180;

/// A receiver that faces a light along +z.
inline Receiver facing(double x, double y, double z) { return {{x, y, z}, {0, 0, -1}}; }

/// Mean of 1 - visibility over receivers on a plane, in the middle of a map of x and y in [-half, half].
template <class Method>
double shadowed_share(const Method& method, const Plane& plane, double half, int n, std::uint64_t seed) {
  Pcg32 random(seed);
  double sum = 0;
  for (int i = 0; i < n; ++i)
    sum +=
        1 - method.visibility(plane.at(random.uniform(-0.8, 0.8) * half, random.uniform(-0.8, 0.8) * half));
  return sum / n;
}

}  // namespace treeline::shading::shadow::test
