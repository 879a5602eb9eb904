// Triangles whose edge functions take 64 bits, one at a time and tile by tile: within a tile 32 bits are
// enough, for those edges that cross it.
#pragma once

#include "shading/raster/patch.hpp"

namespace treeline::shading::raster {

enum class Facing {
  both,
  toward,  ///< faces that turn counterclockwise as the light sees them
  away     ///< the others: what is second of closed meshes
};

inline constexpr int tile_shift = 6;
inline constexpr int tile_side = 1 << tile_shift;  ///< texels

/// A triangle too large for 32 bits, in one tile.
template <bool Perspective>
class LargeTriangle {
 public:
  LargeTriangle(const Corners& corners, std::size_t face, Facing facing);

  /// The texels of a box that it may cover; none if y1 < y0.
  TexelBox box(const TexelBox& in) const {
    return {std::max(low_x_, in.x0), std::max(low_y_, in.y0), std::min(high_x_, in.x1),
            drawn_ ? std::min(high_y_, in.y1) : -1};
  }
  /// Its part of a tile; false if there is none.
  bool patch(const TexelBox& tile, Patch& out) const;

 private:
  std::array<std::int64_t, 3> x_, y_, dx_, dy_;          // snapped corners; edges from each to the next
  int low_x_ = 0, high_x_ = 0, low_y_ = 0, high_y_ = 0;  // texels
  bool drawn_ = false;
  double at_x_, at_y_;                    // first corner, in texels
  double numerator_[3], denominator_[3];  // there, and steps per texel
  float low_, high_;
};

template <bool Perspective>
LargeTriangle<Perspective>::LargeTriangle(const Corners& corners, std::size_t face, Facing facing) {
  std::array<Vertex, 3> v;
  for (std::size_t k = 0; k < 3; ++k) v[k] = corners.vertices[corners.faces[face][k]];
  const auto twice_area = [&](const auto& at) {
    return (at(v[1].x) - at(v[0].x)) * (at(v[2].y) - at(v[0].y)) -
           (at(v[2].x) - at(v[0].x)) * (at(v[1].y) - at(v[0].y));
  };
  const auto snap = [](std::int32_t a) { return (std::int64_t(a) + 128) >> 8; };
  const std::int64_t area = twice_area(snap);
  if (area == 0 || (facing == Facing::toward && area > 0) || (facing == Facing::away && area < 0)) return;
  if (area < 0) std::swap(v[1], v[2]);
  drawn_ = true;
  for (std::size_t k = 0; k < 3; ++k) x_[k] = snap(v[k].x), y_[k] = snap(v[k].y);
  for (std::size_t k = 0; k < 3; ++k) dx_[k] = x_[(k + 1) % 3] - x_[k], dy_[k] = y_[(k + 1) % 3] - y_[k];
  const auto [left, right] = std::minmax({x_[0], x_[1], x_[2]});
  const auto [top, bottom] = std::minmax({y_[0], y_[1], y_[2]});
  low_x_ = int((left + 127) >> 8), high_x_ = int((right - 128) >> 8);
  low_y_ = int((top + 127) >> 8), high_y_ = int((bottom - 128) >> 8);

  at_x_ = v[0].x / fixed_one, at_y_ = v[0].y / fixed_one;
  double ex[3], ey[3];
  for (std::size_t k = 1; k < 3; ++k)
    ex[k] = (double(v[k].x) - v[0].x) / fixed_one, ey[k] = (double(v[k].y) - v[0].y) / fixed_one;
  const double true_area = times(ex[1], ey[2]) - times(ex[2], ey[1]);
  const double inverse = true_area == 0 ? 0 : 1 / true_area;
  const auto plane = [&](double a, double b, double c, double* out) {
    out[0] = a;
    out[1] = times(times(b - a, ey[2]) - times(c - a, ey[1]), inverse);
    out[2] = times(times(ex[1], c - a) - times(ex[2], b - a), inverse);
  };
  plane(v[0].numerator, v[1].numerator, v[2].numerator, numerator_);
  plane(v[0].denominator, v[1].denominator, v[2].denominator, denominator_);
  low_ = INFINITY, high_ = -INFINITY;
  for (const Vertex& one : v) {
    const float depth = Perspective ? one.numerator / one.denominator : one.numerator;
    low_ = std::min(low_, depth), high_ = std::max(high_, depth);
  }
}

template <bool Perspective>
bool LargeTriangle<Perspective>::patch(const TexelBox& tile, Patch& out) const {
  out.x0 = std::max(low_x_, tile.x0), out.x1 = std::min(high_x_, tile.x1);
  out.y0 = std::max(low_y_, tile.y0), out.y1 = std::min(high_y_, tile.y1);
  if (!drawn_ || out.x0 > out.x1 || out.y0 > out.y1) return false;
  for (std::size_t k = 0; k < 3; ++k) {
    const bool owns = dy_[k] < 0 || (dy_[k] == 0 && dx_[k] > 0);
    const std::int64_t e = (dx_[k] * (std::int64_t(out.y0) * 256 + 128 - y_[k]) -
                            dy_[k] * (std::int64_t(out.x0) * 256 + 128 - x_[k]) - (owns ? 0 : 1)) >>
                           8;
    const std::int64_t far_x = -dy_[k] * (tile.x1 - out.x0), far_y = dx_[k] * (tile.y1 - out.y0),
                       back_x = -dy_[k] * (tile.x0 - out.x0);
    const std::int64_t most =
        e + std::max({std::int64_t(0), far_x, back_x}) + std::max<std::int64_t>(0, far_y);
    const std::int64_t least =
        e + std::min({std::int64_t(0), far_x, back_x}) + std::min<std::int64_t>(0, far_y);
    if (most < 0) return false;
    const bool all = least >= 0;  // then it need not fit
    out.edge[k] = all ? 0 : std::uint32_t(e), out.in_x[k] = all ? 0 : std::uint32_t(-dy_[k]);
    out.in_y[k] = all ? 0 : std::uint32_t(dx_[k]);
  }
  out.start_x = out.x0, out.start_y = out.y0;
  const double dx = out.x0 + 0.5 - at_x_, dy = out.y0 + 0.5 - at_y_;
  const auto at = [&](const double* plane) {
    return float((plane[0] + times(plane[1], dx)) + times(plane[2], dy));
  };
  out.numerator = at(numerator_), out.denominator = at(denominator_);
  out.numerator_x = float(numerator_[1]), out.numerator_y = float(numerator_[2]);
  out.denominator_x = float(denominator_[1]), out.denominator_y = float(denominator_[2]);
  out.low = low_, out.high = high_;
  return true;
}

}  // namespace treeline::shading::raster
