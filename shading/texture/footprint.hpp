// Footprints: the regions of a texture whose mean is asked for.
//
// Coordinates are in texels from the upper left corner: texel (i, j) covers [i, i + 1) x [j, j + 1), and the
// texture is constant on it. Beyond its borders it goes on as its outermost texels (clamp). Half axes are
// finite and not negative; a footprint without width is a point or a line, and asks for the mean along it.
#pragma once

#include <cmath>
#include <cstdint>

namespace treeline::shading::texture {

enum class Shape : std::uint8_t {
  box,      ///< half axes: half sides, perpendicular to each other
  disc,     ///< half axes: both of one radius
  gaussian  ///< half axes: standard deviations along x and y; cut off at gaussian_reach of them, on a box
};

/// Where Gaussian weights end, in standard deviations along each axis; what is left is scaled to sum to one.
inline constexpr double gaussian_reach = 3;

struct Footprint {
  double x = 0, y = 0;    ///< centre
  double ux = 0, uy = 0;  ///< first half axis
  double vx = 0, vy = 0;  ///< second half axis
  Shape shape = Shape::box;

  /// Sides along x and y.
  bool aligned() const { return uy == 0 && vx == 0; }
};

/// [x0, x1] x [y0, y1].
struct Box {
  double x0, y0, x1, y1;
};

inline Footprint box_footprint(const Box& b) {
  return {.x = 0.5 * (b.x0 + b.x1),
          .y = 0.5 * (b.y0 + b.y1),
          .ux = 0.5 * (b.x1 - b.x0),
          .vy = 0.5 * (b.y1 - b.y0)};
}
/// Half sides a and b, the first turned from x towards y by an angle in radians.
inline Footprint rotated_box(double x, double y, double a, double b, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return {.x = x, .y = y, .ux = a * c, .uy = a * s, .vx = -b * s, .vy = b * c};
}
inline Footprint disc_footprint(double x, double y, double radius) {
  return {.x = x, .y = y, .ux = radius, .vy = radius, .shape = Shape::disc};
}
inline Footprint gaussian_footprint(double x, double y, double sigma_x, double sigma_y) {
  return {.x = x, .y = y, .ux = sigma_x, .vy = sigma_y, .shape = Shape::gaussian};
}

/// The factor by which half axes grow to be those of a box with the same variance along each of them: a box
/// has 1/3 of the square of its half axis, a disc 1/4, a Gaussian cut at three deviations 0.9733.
inline double box_factor(Shape shape) {
  switch (shape) {
    case Shape::box:
      return 1;
    case Shape::disc:
      return 0.8660254037844386;  // sqrt(3/4)
    case Shape::gaussian:
      return 1.708803901560277;  // sqrt(3 (1 - 6 phi(3) / erf(3 / sqrt 2)))
  }
  return 1;
}

/// The box along the axes with the footprint's variances along x and along y: the footprint itself where it
/// is such a box. Of rotated ones it is what a method that knows no other boxes can do.
inline Box fitted_box(const Footprint& f) {
  double a = std::abs(f.ux), b = std::abs(f.vy);
  if (!f.aligned()) a = std::hypot(f.ux, f.vx), b = std::hypot(f.uy, f.vy);
  if (f.shape != Shape::box) a *= box_factor(f.shape), b *= box_factor(f.shape);
  return {f.x - a, f.y - b, f.x + a, f.y + b};
}

/// The box around all texels that have a weight.
inline Box bounding_box(const Footprint& f) {
  if (f.shape == Shape::disc) {
    const double r = std::hypot(f.ux, f.uy);
    return {f.x - r, f.y - r, f.x + r, f.y + r};
  }
  const double k = f.shape == Shape::gaussian ? gaussian_reach : 1;
  const double a = k * (std::abs(f.ux) + std::abs(f.vx)), b = k * (std::abs(f.uy) + std::abs(f.vy));
  return {f.x - a, f.y - b, f.x + a, f.y + b};
}

}  // namespace treeline::shading::texture
