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

/// A double whose last 32 bits are its argument, |a| < 2^31, rounded to even.
inline constexpr double round_to_fixed = 0x1.8p52;

/// Eight corners at a time, in double.
inline void place_vertices(const Frame& frame, std::span<const Vec3f> points, Vertex* out) {
  using L = accel::simd::Lanes<double>;
  const auto all = [](double a) { return L::broadcast(a); };
  const L one = all(1), zero = all(0), round = all(round_to_fixed);
  for (std::size_t i = 0; i < points.size(); i += 8) {
    const std::size_t count = std::min<std::size_t>(8, points.size() - i);
    double p[3][8];
    for (std::size_t k = 0; k < 8; ++k) {
      const Vec3f& point = points[i + std::min(k, count - 1)];
      for (int a = 0; a < 3; ++a) p[a][k] = double(point[a]);
    }
    L d[3];
    for (int a = 0; a < 3; ++a) d[a] = L::load(p[a]) - all(frame.origin[a]);
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
    const std::uint32_t good = ((all(guard_low) <= x) & (x <= all(guard_high)) & (all(guard_low) <= y) &
                                (y <= all(guard_high)) & (zero <= depth) & (zero < denominator))
                                   .bits();
    double fixed[2][8], share[2][8];
    (x + round).store(fixed[0]), (y + round).store(fixed[1]);
    numerator.store(share[0]), denominator.store(share[1]);
    for (std::size_t k = 0; k < count; ++k) {
      std::int64_t bits[2];
      std::memcpy(&bits[0], &fixed[0][k], 8), std::memcpy(&bits[1], &fixed[1][k], 8);
      const bool inside = good >> k & 1;
      out[i + k] = {inside ? std::int32_t(bits[0]) : Vertex::outside, inside ? std::int32_t(bits[1]) : 0,
                    float(share[0][k]), float(share[1][k])};
    }
  }
}

}  // namespace treeline::shading::raster
