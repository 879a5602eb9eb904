// All triangles of one tile. Small ones are prepared a register of triangles at a time; those of up to 4×4
// texels are also drawn so, one texel of each at once, because what a small triangle costs is not its texels.
// Larger ones are drawn one by one, a register of texels at a time (patch.hpp).
#pragma once

#include "shading/raster/patch.hpp"

namespace treeline::shading::raster {

enum class Facing {
  both,
  toward,  ///< faces that turn counterclockwise as the light sees them
  away     ///< the others: what is second of closed meshes
};

inline constexpr int tiny_side = 4;  ///< texels, of triangles that are drawn side by side
/// Units of 1/256 texel; edge functions of triangles up to this size fit into 32 bits anywhere near them.
inline constexpr int small_extent = 64 * 256;

struct TileBounds {
  int x0, y0, x1, y1;  ///< texels, both ends included
};

/// A triangle too large for 32 bits, in one tile.
template <bool Perspective>
class LargeTriangle {
 public:
  LargeTriangle(const std::array<Vertex, 3>& v, Facing facing);

  /// Its part of the tile; false if there is none.
  bool patch(const TileBounds& tile, Patch& out) const;

 private:
  std::array<std::int64_t, 3> x_, y_, dx_, dy_;  // snapped corners; edges from each to the next
  int low_x_, high_x_, low_y_, high_y_;          // texels
  bool drawn_ = false;
  double at_x_, at_y_;                    // first corner, in texels
  double numerator_[3], denominator_[3];  // there, and steps per texel
  float low_, high_;
};

template <bool Perspective>
LargeTriangle<Perspective>::LargeTriangle(const std::array<Vertex, 3>& vertices, Facing facing) {
  std::array<Vertex, 3> v = vertices;
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
bool LargeTriangle<Perspective>::patch(const TileBounds& tile, Patch& out) const {
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

/// A register of small triangles, prepared; fields as of Patch.
struct Small {
  Ints x0, x1, y0, y1, edge[3], in_x[3], in_y[3];
  Floats numerator[3], denominator[3], low, high;
  std::uint32_t drawn = 0, large = 0;  ///< one bit a lane

  Patch patch(int k) const {
    Patch p;
    p.x0 = x0[k], p.x1 = x1[k], p.y0 = y0[k], p.y1 = y1[k];
    for (int e = 0; e < 3; ++e)
      p.edge[e] = std::uint32_t(edge[e][k]), p.in_x[e] = std::uint32_t(in_x[e][k]),
      p.in_y[e] = std::uint32_t(in_y[e][k]);
    p.numerator = numerator[0][k], p.numerator_x = numerator[1][k], p.numerator_y = numerator[2][k];
    p.denominator = denominator[0][k], p.denominator_x = denominator[1][k],
    p.denominator_y = denominator[2][k];
    p.low = low[k], p.high = high[k];
    return p;
  }
};

inline void swap_where(Ints mask, Ints& a, Ints& b) {
  const Ints t = mask ? b : a;
  b = mask ? a : b, a = t;
}

template <bool Perspective>
Small prepare(const TileBounds& tile, const Corners& corners, const FaceIndices& f, std::uint32_t wanted,
              Facing facing) {
  Small r;
  Ints fx[3], fy[3], n[3], d[3], x[3], y[3];
  for (int k = 0; k < 3; ++k) {
    fx[k] = field(corners, f.v[k], 0), fy[k] = field(corners, f.v[k], 1), n[k] = field(corners, f.v[k], 2);
    if constexpr (Perspective) d[k] = field(corners, f.v[k], 3);
    x[k] = snapped(fx[k]), y[k] = snapped(fy[k]);
  }
  const Ints left = least(x[0], least(x[1], x[2])), right = largest(x[0], largest(x[1], x[2])),
             top = least(y[0], least(y[1], y[2])), bottom = largest(y[0], largest(y[1], y[2]));
  r.large = negative((small_extent - (right - left)) | (small_extent - (bottom - top))) & wanted;

  // What follows wraps in large ones, and is not used.
  const auto edge_x = [&](int k) { return (Words)x[(k + 1) % 3] - (Words)x[k]; };
  const auto edge_y = [&](int k) { return (Words)y[(k + 1) % 3] - (Words)y[k]; };
  const Ints area = (Ints)(edge_x(2) * edge_y(0) - edge_x(0) * edge_y(2));
  const Ints backward = area < 0;
  Ints nothing = area == 0;
  if (facing == Facing::toward) nothing |= area > 0;
  if (facing == Facing::away) nothing |= backward;
  for (auto* v : {x, y, fx, fy, n}) swap_where(backward, v[1], v[2]);
  if constexpr (Perspective) swap_where(backward, d[1], d[2]);

  r.x0 = largest(first_texel(left), ints(tile.x0)), r.x1 = least(last_texel(right), ints(tile.x1));
  r.y0 = largest(first_texel(top), ints(tile.y0)), r.y1 = least(last_texel(bottom), ints(tile.y1));
  r.drawn = ~negative((r.x1 - r.x0) | (r.y1 - r.y0) | nothing) & wanted & ~r.large;
  for (int k = 0; k < 3; ++k) {
    const Words dx = edge_x(k), dy = edge_y(k);
    const Ints owns = ((Ints)dy < 0) | (((Ints)dy == 0) & ((Ints)dx > 0));  // -1 or 0
    const Words e =
        dx * ((Words)(r.y0 * 256 + 128) - (Words)y[k]) - dy * ((Words)(r.x0 * 256 + 128) - (Words)x[k]);
    r.edge[k] = (Ints)(e - (Words)(1 + owns)) >> 8;
    r.in_x[k] = (Ints)(-dy), r.in_y[k] = (Ints)dx;
  }

  // Depth, in double from the positions that are not rounded to 8 bits; differences of small ones are exact.
  const TwoDoubles ex1(fx[1] - fx[0]), ey1(fy[1] - fy[0]), ex2(fx[2] - fx[0]), ey2(fy[2] - fy[0]);
  const TwoDoubles inverse = inverse_or_zero(ex1 * ey2 - ex2 * ey1);
  const TwoDoubles ax(r.x0 * 65536 + 32768 - fx[0]), ay(r.y0 * 65536 + 32768 - fy[0]);
  const Doubles unit = fixed_one - Doubles{};
  const auto plane = [&](const Ints* values, Floats* out) {
    const TwoDoubles v0((Floats)values[0]), b = TwoDoubles((Floats)values[1]) - v0,
                                            c = TwoDoubles((Floats)values[2]) - v0;
    const TwoDoubles gx = (b * ey2 - c * ey1) * inverse, gy = (ex1 * c - ex2 * b) * inverse;
    out[0] = Floats((v0 + gx * ax) + gy * ay);
    out[1] = Floats(gx * TwoDoubles(unit, unit)), out[2] = Floats(gy * TwoDoubles(unit, unit));
  };
  plane(n, r.numerator);
  Floats depth[3];
  for (int k = 0; k < 3; ++k) depth[k] = (Floats)n[k];
  if constexpr (Perspective) {
    plane(d, r.denominator);
    for (int k = 0; k < 3; ++k) depth[k] /= (Floats)d[k];
  } else {
    for (auto& part : r.denominator) part = Floats{};
  }
  r.low = least(depth[0], least(depth[1], depth[2])), r.high = largest(depth[0], largest(depth[1], depth[2]));
  return r;
}

/// Those of `chosen`, of tiny_side² texels at most each.
template <bool Perspective, bool Second>
void draw_tiny(const Target& to, const Small& s, std::uint32_t chosen) {
  int wide = 0, high = 0;
  alignas(64) std::int32_t columns[lanes], rows[lanes];
  std::size_t at[lanes];
  const Ints width = s.x1 - s.x0, height = s.y1 - s.y0;
  std::memcpy(columns, &s.x0, sizeof columns), std::memcpy(rows, &s.y0, sizeof rows);
  for (std::uint32_t left = chosen; left; left &= left - 1) {
    const int k = __builtin_ctz(left);
    wide = std::max(wide, int(width[k])), high = std::max(high, int(height[k]));
    at[k] = std::size_t(rows[k]) * to.stride + std::size_t(columns[k]);
  }
  Ints edge[3] = {s.edge[0], s.edge[1], s.edge[2]};
  for (int j = 0; j <= high; ++j) {
    Ints e[3] = {edge[0], edge[1], edge[2]};
    const Floats dy = floats(float(j));
    const Floats numerator = s.numerator[0] + times(s.numerator[2], dy);
    const Floats denominator = Perspective ? s.denominator[0] + times(s.denominator[2], dy) : dy;
    for (int i = 0; i <= wide; ++i) {
      const std::uint32_t covered = ~negative(e[0] | e[1] | e[2] | (width - i) | (height - j)) & chosen;
      for (int k = 0; k < 3; ++k) e[k] = (Ints)((Words)e[k] + (Words)s.in_x[k]);
      if (covered == 0) continue;
      const Floats dx = floats(float(i));
      Floats depth = numerator + times(s.numerator[1], dx);
      if constexpr (Perspective) depth /= denominator + times(s.denominator[1], dx);
      depth = least(largest(depth, s.low), s.high);
      alignas(64) float depths[lanes];
      std::memcpy(depths, &depth, sizeof depths);
      const std::size_t shift = std::size_t(j) * to.stride + std::size_t(i);
      for (std::uint32_t left = covered; left; left &= left - 1) {
        const int k = __builtin_ctz(left);
        put<Second>(to, at[k] + shift, depths[k]);
      }
    }
    for (int k = 0; k < 3; ++k) edge[k] = (Ints)((Words)edge[k] + (Words)s.in_y[k]);
  }
}

template <bool Perspective, bool Second>
void draw_tile(const Target& to, const TileBounds& tile, const Corners& corners,
               std::span<const std::uint32_t> faces, Facing facing) {
  for (std::size_t i = 0; i < faces.size(); i += lanes) {
    const std::size_t count = std::min<std::size_t>(lanes, faces.size() - i);
    Ints numbers = ints(std::int32_t(faces[i]));
    std::memcpy(&numbers, faces.data() + i, count * sizeof(std::uint32_t));
    const FaceIndices f(corners, numbers);
    const Small s = prepare<Perspective>(tile, corners, f, all_lanes >> (std::size_t(lanes) - count), facing);
    const std::uint32_t wider =
        negative((tiny_side - 1 - (s.x1 - s.x0)) | (tiny_side - 1 - (s.y1 - s.y0))) & s.drawn;
    if (const std::uint32_t tiny = s.drawn & ~wider) draw_tiny<Perspective, Second>(to, s, tiny);
    for (std::uint32_t left = wider; left; left &= left - 1)
      draw<Perspective, Second>(to, s.patch(__builtin_ctz(left)));
    for (std::uint32_t left = s.large; left; left &= left - 1) {
      const auto& face = corners.faces[faces[i + std::size_t(__builtin_ctz(left))]];
      const LargeTriangle<Perspective> large(
          {corners.vertices[face[0]], corners.vertices[face[1]], corners.vertices[face[2]]}, facing);
      Patch patch;
      if (large.patch(tile, patch)) draw<Perspective, Second>(to, patch);
    }
  }
}

}  // namespace treeline::shading::raster
