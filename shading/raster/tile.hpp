// All triangles of a tile, or of the map. Small ones are prepared a register of triangles at a time; those of
// up to 4×4 texels are also drawn so, one texel of each at once, because what a small triangle costs is not
// its texels. Wider ones are drawn one by one, a register of texels at a time (patch.hpp).
#pragma once

#include "shading/raster/large.hpp"

namespace treeline::shading::raster {

inline constexpr int tiny_side = 4;  ///< texels, of triangles that are drawn side by side
/// Units of 1/256 texel; edge functions of triangles up to this size fit into 32 bits wherever they are.
inline constexpr int small_extent = 64 * 256;

/// A register of small triangles, prepared; fields as of Patch.
struct Small {
  Ints x0, x1, y0, y1, start_x, start_y, edge[3], in_x[3], in_y[3];
  Floats numerator[3], denominator[3], low, high;
  std::uint32_t drawn = 0, large = 0;  ///< one bit a lane

  Patch patch(int k) const {
    Patch p;
    p.x0 = x0[k], p.x1 = x1[k], p.y0 = y0[k], p.y1 = y1[k];
    p.start_x = start_x[k], p.start_y = start_y[k];
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

/// Those of a register's triangles that lie in the box, as far as they do.
template <bool Perspective>
Small prepare(const TexelBox& box, CornerRegisters c, std::uint32_t wanted, Facing facing) {
  Small r;
  const Covered covered(c, box);
  const std::uint32_t seen = wanted & ~covered.nothing();
  r.large = negative((small_extent - covered.width) | (small_extent - covered.height)) & seen;
  if (seen == r.large) return r;
  r.x0 = covered.x0, r.x1 = covered.x1, r.y0 = covered.y0, r.y1 = covered.y1;
  r.start_x = covered.start_x, r.start_y = covered.start_y;

  // What follows wraps in large ones, and is not used.
  const Ints *x = c.snapped_x, *y = c.snapped_y;
  const auto edge_x = [&](int k) { return (Words)x[(k + 1) % 3] - (Words)x[k]; };
  const auto edge_y = [&](int k) { return (Words)y[(k + 1) % 3] - (Words)y[k]; };
  const Ints area = (Ints)(edge_x(2) * edge_y(0) - edge_x(0) * edge_y(2));
  const Ints backward = area < 0;
  Ints nothing = area == 0;
  if (facing == Facing::toward) nothing |= area > 0;
  if (facing == Facing::away) nothing |= backward;
  r.drawn = seen & ~r.large & ~negative(nothing);
  if (r.drawn == 0) return r;
  c.swap_where(backward, 1, 2);
  for (int k = 0; k < 3; ++k) {
    const Words dx = edge_x(k), dy = edge_y(k);
    const Ints owns = ((Ints)dy < 0) | (((Ints)dy == 0) & ((Ints)dx > 0));  // -1 or 0
    const Words e =
        dx * ((Words)(r.y0 * 256 + 128) - (Words)y[k]) - dy * ((Words)(r.x0 * 256 + 128) - (Words)x[k]);
    r.edge[k] = (Ints)(e - (Words)(1 + owns)) >> 8;
    r.in_x[k] = (Ints)(-dy), r.in_y[k] = (Ints)dx;
  }

  // Depth, in double from the positions that are not rounded to 8 bits; their differences are exact.
  const auto apart = [](Ints a, Ints b) { return TwoDoubles((Ints)((Words)a - (Words)b)); };
  const TwoDoubles ex1 = apart(c.x[1], c.x[0]), ey1 = apart(c.y[1], c.y[0]), ex2 = apart(c.x[2], c.x[0]),
                   ey2 = apart(c.y[2], c.y[0]);
  const TwoDoubles inverse = inverse_or_zero(ex1 * ey2 - ex2 * ey1);
  const TwoDoubles ax = apart(r.start_x * 65536 + 32768, c.x[0]),
                   ay = apart(r.start_y * 65536 + 32768, c.y[0]);
  const Doubles one = fixed_one - Doubles{};
  const TwoDoubles texel(one, one);
  const auto plane = [&](const Ints* values, Floats* out) {
    const TwoDoubles v0((Floats)values[0]), v1 = TwoDoubles((Floats)values[1]) - v0,
                                            v2 = TwoDoubles((Floats)values[2]) - v0;
    const TwoDoubles gx = (v1 * ey2 - v2 * ey1) * inverse, gy = (ex1 * v2 - ex2 * v1) * inverse;
    out[0] = Floats((v0 + gx * ax) + gy * ay), out[1] = Floats(gx * texel), out[2] = Floats(gy * texel);
  };
  plane(c.numerator, r.numerator);
  Floats depth[3];
  for (int k = 0; k < 3; ++k) depth[k] = (Floats)c.numerator[k];
  if constexpr (Perspective) {
    plane(c.denominator, r.denominator);
    for (int k = 0; k < 3; ++k) depth[k] /= (Floats)c.denominator[k];
  } else {
    for (auto& part : r.denominator) part = Floats{};
  }
  r.low = least(depth[0], least(depth[1], depth[2])), r.high = largest(depth[0], largest(depth[1], depth[2]));
  return r;
}

/// Those of `chosen`, of tiny_side² texels at most each.
template <bool Perspective, bool Second>
void draw_tiny(const Target& to, const Small& s, std::uint32_t chosen) {
  const Ints width = s.x1 - s.x0, height = s.y1 - s.y0;
  alignas(64) std::int32_t at[lanes], sides[lanes];
  const Ints places = s.y0 * std::int32_t(to.stride) + s.x0, side = width | height << 8;
  std::memcpy(at, &places, sizeof at), std::memcpy(sides, &side, sizeof sides);
  int wide = 0, high = 0;
  for (std::uint32_t left = chosen; left; left &= left - 1) {
    const int one = sides[__builtin_ctz(left)];
    wide = std::max(wide, one & 255), high = std::max(high, one >> 8);
  }
  Ints edge[3] = {s.edge[0], s.edge[1], s.edge[2]};
  for (int j = 0; j <= high; ++j) {
    Ints e[3] = {edge[0], edge[1], edge[2]};
    const Floats dy = __builtin_convertvector(s.y0 - s.start_y + j, Floats);
    const Floats numerator = s.numerator[0] + times(s.numerator[2], dy);
    const Floats denominator = Perspective ? s.denominator[0] + times(s.denominator[2], dy) : dy;
    for (int i = 0; i <= wide; ++i) {
      const std::uint32_t covered = ~negative(e[0] | e[1] | e[2] | (width - i) | (height - j)) & chosen;
      for (int k = 0; k < 3; ++k) e[k] = (Ints)((Words)e[k] + (Words)s.in_x[k]);
      if (covered == 0) continue;
      const Floats dx = __builtin_convertvector(s.x0 - s.start_x + i, Floats);
      Floats depth = numerator + times(s.numerator[1], dx);
      if constexpr (Perspective) depth /= denominator + times(s.denominator[1], dx);
      depth = least(largest(depth, s.low), s.high);
      alignas(64) float depths[lanes];
      std::memcpy(depths, &depth, sizeof depths);
      const std::size_t shift = std::size_t(j) * to.stride + std::size_t(i);
      for (std::uint32_t left = covered; left; left &= left - 1) {
        const int k = __builtin_ctz(left);
        put<Second>(to, std::size_t(at[k]) + shift, depths[k]);
      }
    }
    for (int k = 0; k < 3; ++k) edge[k] = (Ints)((Words)edge[k] + (Words)s.in_y[k]);
  }
}

/// A register of triangles but for large ones, of which it returns one bit each.
template <bool Perspective, bool Second>
std::uint32_t draw_small(const Target& to, const TexelBox& box, const CornerRegisters& c,
                         std::uint32_t wanted, Facing facing) {
  const Small s = prepare<Perspective>(box, c, wanted, facing);
  if (s.drawn == 0) return s.large;
  const std::uint32_t wider =
      negative((tiny_side - 1 - (s.x1 - s.x0)) | (tiny_side - 1 - (s.y1 - s.y0))) & s.drawn;
  if (const std::uint32_t tiny = s.drawn & ~wider) draw_tiny<Perspective, Second>(to, s, tiny);
  for (std::uint32_t left = wider; left; left &= left - 1)
    draw<Perspective, Second>(to, s.patch(__builtin_ctz(left)));
  return s.large;
}

/// What lies in one tile of the faces given.
template <bool Perspective, bool Second>
void draw_tile(const Target& to, const TexelBox& tile, const Corners& corners,
               std::span<const std::uint32_t> faces, Facing facing) {
  for (std::size_t i = 0; i < faces.size(); i += lanes) {
    const std::size_t count = std::min<std::size_t>(lanes, faces.size() - i);
    const CornerRegisters c(corners,
                            [&](int lane) { return faces[i + std::min(std::size_t(lane), count - 1)]; });
    std::uint32_t left =
        draw_small<Perspective, Second>(to, tile, c, all_lanes >> (std::size_t(lanes) - count), facing);
    for (; left; left &= left - 1) {
      const LargeTriangle<Perspective> large(corners, faces[i + std::size_t(__builtin_ctz(left))], facing);
      Patch patch;
      if (large.patch(tile, patch)) draw<Perspective, Second>(to, patch);
    }
  }
}

/// All faces, in their order; adds the numbers of those that need clipping to `hard`.
template <bool Perspective, bool Second>
void draw_map(const Target& to, const TexelBox& map, const Corners& corners, Facing facing,
              std::vector<std::uint32_t>& hard) {
  const std::size_t n = corners.faces.size();
  for (std::size_t i = 0; i < n; i += lanes) {
    const std::size_t count = std::min<std::size_t>(lanes, n - i);
    check_indices(corners, i, count);
    const CornerRegisters c(corners, [&](int lane) { return i + std::min(std::size_t(lane), count - 1); });
    const std::uint32_t wanted = all_lanes >> (std::size_t(lanes) - count), clipped = c.outside() & wanted;
    for (std::uint32_t left = clipped; left; left &= left - 1)
      hard.push_back(std::uint32_t(i) + std::uint32_t(__builtin_ctz(left)));
    std::uint32_t left = draw_small<Perspective, Second>(to, map, c, wanted & ~clipped, facing);
    for (; left; left &= left - 1) {
      const LargeTriangle<Perspective> large(corners, i + std::size_t(__builtin_ctz(left)), facing);
      const TexelBox box = large.box(map);
      for (int y = box.y0 & -tile_side; y <= box.y1; y += tile_side)
        for (int x = box.x0 & -tile_side; x <= box.x1; x += tile_side) {
          const TexelBox tile{x, y, std::min(x + tile_side - 1, map.x1), std::min(y + tile_side - 1, map.y1)};
          Patch patch;
          if (large.patch(tile, patch)) draw<Perspective, Second>(to, patch);
        }
    }
  }
}

}  // namespace treeline::shading::raster
