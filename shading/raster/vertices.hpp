// From the world to the texels of a map: positions in fixed point, 16 bits below the texel. Where a corner
// counts for coverage it is rounded further to 8 bits; depth is interpolated between the positions
// themselves.
#pragma once

#include <limits>
#include <span>

#include "geometry/mesh.hpp"
#include "shading/raster/registers.hpp"
#include "shading/shadow/light_view.hpp"

namespace treeline::shading::raster {

using geometry::Vec3d;
using geometry::Vec3f;

inline constexpr int largest_side = 16384;      ///< of a map, in texels
inline constexpr double fixed_one = 65536;      ///< a texel
inline constexpr double guard_low = -0x1p30;    ///< where positions must be, in fixed point
inline constexpr double guard_high = 0x1.fp30;  ///< beyond the end of the largest map by 15360 texels

/// A corner. Perspective: depth is numerator/denominator, both linear across the map; else numerator.
struct Vertex {
  static constexpr std::int32_t outside = std::numeric_limits<std::int32_t>::min();

  std::int32_t x, y;  ///< 1/65536 of a texel from the map's top left; x = outside: must be clipped first
  float numerator, denominator;
};
static_assert(sizeof(Vertex) == 16);

/// A light's view of a map of so many texels.
struct Frame {
  Vec3d origin, x, y, z;      ///< x, y: fixed point for a unit of the world, at distance 1 in perspective
  double centre_x, centre_y;  ///< of the map
  double near, inverse_range;
  bool perspective;
  int width, height;

  Frame(const shadow::LightView& view, int columns, int rows)
      : origin(view.origin),
        x(view.right * (0.5 * columns * fixed_one / view.half_width)),
        y(view.down * (0.5 * rows * fixed_one / view.half_height)),
        z(view.forward),
        centre_x(0.5 * columns * fixed_one),
        centre_y(0.5 * rows * fixed_one),
        near(view.near),
        inverse_range(1 / (view.far - view.near)),
        perspective(view.perspective),
        width(columns),
        height(rows) {}
};

/// A double whose last 32 bits, after it was added to |a| < 2^31, are a rounded to even.
inline constexpr double round_to_fixed = 0x1.8p52;

/// Eight corners at a time, in double.
inline void place_eight(const Frame& frame, const Vec3f* points, Vertex* out) {
  using L = accel::simd::Lanes<double>;
  const auto all = [](double a) { return L::broadcast(a); };
  const L one = all(1), zero = all(0);
  L d[3];
  for (int a = 0; a < 3; ++a) {
    double p[8];
    for (int k = 0; k < 8; ++k) p[k] = double(points[k][a]);
    d[a] = L::load(p) - all(frame.origin[a]);
  }
  const auto along = [&](const Vec3d& axis) {
    return (d[0] * all(axis[0]) + d[1] * all(axis[1])) + d[2] * all(axis[2]);
  };
  const L z = along(frame.z), depth = (z - all(frame.near)) * all(frame.inverse_range);
  L x = along(frame.x), y = along(frame.y), numerator = depth, denominator = one;
  if (frame.perspective) {
    const L inverse = one / z;
    x = x * inverse, y = y * inverse;
    denominator = all(frame.near) * inverse, numerator = depth * denominator;
  }
  x = x + all(frame.centre_x), y = y + all(frame.centre_y);
  const L::Mask good = (all(guard_low) <= x) & (x <= all(guard_high)) & (all(guard_low) <= y) &
                       (y <= all(guard_high)) & (zero <= depth) & (zero < denominator);
  const L round = all(round_to_fixed), outside = all(round_to_fixed + Vertex::outside);
  std::int64_t fixed_x[8], fixed_y[8];
  double numerators[8], denominators[8];
  const L rounded_x = chosen(good, x + round, outside), rounded_y = chosen(good, y + round, outside);
  std::memcpy(fixed_x, &rounded_x, sizeof fixed_x), std::memcpy(fixed_y, &rounded_y, sizeof fixed_y);
  numerator.store(numerators), denominator.store(denominators);
  for (int k = 0; k < 8; ++k)
    out[k] = {std::int32_t(fixed_x[k]), std::int32_t(fixed_y[k]), float(numerators[k]),
              float(denominators[k])};
}

inline void place_vertices(const Frame& frame, std::span<const Vec3f> points, Vertex* out) {
  std::size_t i = 0;
  for (; i + 8 <= points.size(); i += 8) place_eight(frame, points.data() + i, out + i);
  if (i == points.size()) return;
  Vec3f last[8];
  Vertex placed[8];
  for (std::size_t k = 0; k < 8; ++k) last[k] = points[std::min(i + k, points.size() - 1)];
  place_eight(frame, last, placed);
  std::copy_n(placed, points.size() - i, out + i);
}

}  // namespace treeline::shading::raster
