// The part of one triangle that lies in one tile, or in the map if it is small, and how it is drawn. Source:
// Pineda 1988, A Parallel Algorithm for Polygon Rasterization (edge functions); the fill rule is that of
// Direct3D and OpenGL: a centre on an edge belongs to the triangle below or to the right of it, so that of
// two triangles that share an edge exactly one covers it.
#pragma once

#include "shading/raster/corners.hpp"

namespace treeline::shading::raster {

/// The map that is drawn into; rows are `stride` apart, a multiple of 16.
struct Target {
  float* first;
  float* second;  ///< null: not kept
  std::size_t stride;
};

/// Edge functions are negative outside, exactly; they are in units of 1/65536 texel² rounded down to 1/256,
/// which no centre can tell from exact ones, as these steps are whole.
struct Patch {
  int x0, x1, y0, y1;                               ///< texels, both ends included
  std::uint32_t edge[3], in_x[3], in_y[3];          ///< at the centre of (x0, y0), and their steps
  int start_x, start_y;                             ///< texel where depth is reckoned from
  float numerator, numerator_x, numerator_y;        ///< at its centre, and per texel
  float denominator, denominator_x, denominator_y;  ///< of perspective
  float low, high;                                  ///< the depths of the corners; no texel is beyond
};

/// Keeps the two least, if they differ.
template <bool Second>
void put(const Target& to, std::size_t at, float depth) {
  float& first = to.first[at];
  if constexpr (Second) {
    float& second = to.second[at];
    if (depth < first) {
      second = first, first = depth;
    } else if (depth > first && depth < second) {
      second = depth;
    }
  } else {
    first = depth < first ? depth : first;
  }
}

/// Row by row, a register of texels at a time, at columns that are multiples of it.
template <bool Perspective, bool Second>
void draw(const Target& to, const Patch& p) {
  const Ints count = counting();
  Words across[3];
  for (int k = 0; k < 3; ++k) across[k] = (Words)count * p.in_x[k];
  const Floats low = floats(p.low), high = floats(p.high);
  const int begin = p.x0 & -lanes;
  for (int y = p.y0; y <= p.y1; ++y) {
    const auto down = std::uint32_t(y - p.y0);
    const auto dy = float(y - p.start_y);
    std::uint32_t edge[3];
    for (int k = 0; k < 3; ++k)
      edge[k] = p.edge[k] + p.in_y[k] * down + p.in_x[k] * std::uint32_t(begin - p.x0);
    const float numerator = p.numerator + times(p.numerator_y, dy);
    const float denominator = Perspective ? p.denominator + times(p.denominator_y, dy) : 1;
    float* const row = to.first + std::size_t(y) * to.stride;
    float* const second_row = Second ? to.second + std::size_t(y) * to.stride : nullptr;
    for (int x = begin; x <= p.x1; x += lanes) {
      const Ints out = (Ints)((across[0] + edge[0]) | (across[1] + edge[1]) | (across[2] + edge[2]));
      for (int k = 0; k < 3; ++k) edge[k] += p.in_x[k] * std::uint32_t(lanes);
      if (negative(out) == all_lanes) continue;
      const Floats dx = __builtin_convertvector(count + (x - p.start_x), Floats);
      Floats depth = numerator + times(floats(p.numerator_x), dx);
      if constexpr (Perspective) depth /= denominator + times(floats(p.denominator_x), dx);
      depth = least(largest(depth, low), high);
      Floats old;
      std::memcpy(&old, row + x, sizeof old);
      const Ints better = (depth < old) & (out >= 0);
      const Floats kept = better ? depth : old;
      std::memcpy(row + x, &kept, sizeof kept);
      if constexpr (Second) {
        Floats behind;
        std::memcpy(&behind, second_row + x, sizeof behind);
        const Ints between = (depth > old) & (depth < behind) & (out >= 0);
        behind = better ? old : between ? depth : behind;
        std::memcpy(second_row + x, &behind, sizeof behind);
      }
    }
  }
}

}  // namespace treeline::shading::raster
