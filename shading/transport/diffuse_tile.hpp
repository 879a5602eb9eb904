// Paths at diffuse surfaces, sixteen at a time: what is asked of the emitters, and where they go on.
//
// Problem: traced through a tree in the caches, a path spends as long on what it does at surfaces as on its
// rays, much of it on branches that nobody can foresee (which half of a triangle's square, does the lamp face
// the surface, is the path at its end). Method: paths are gathered by the number of vector lanes, coordinate
// by coordinate, and the arithmetic is loops over them without a branch, as compilers turn into vector
// instructions; what comes to nothing is left out when the rays are written. The formulas are those of
// surfaces.hpp and of the diffuse part of brdf/bsdf.hpp: only the last digits differ. Cost: all but
// the rays takes 170 to 210 ns a path in a room where paths meet 3.4 surfaces, against 300 to 360 one by one.
// Known weakness: of diffuse surfaces only, which most are.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "shading/transport/surfaces.hpp"

namespace treeline::shading::transport {

/// Paths that are worked on together: as many lanes as the widest registers have. All loops go over all of
/// them, so that a path's numbers do not depend on its place; what is left over is not used.
inline constexpr std::size_t tile_size = 16;

/// What decides at a surface: numbers in [0, 1).
struct TileDecisions {
  alignas(64) double emitter[tile_size];
  alignas(64) float light_u[tile_size], light_v[tile_size];  // of the point on it
  alignas(64) float u[tile_size], v[tile_size];              // of the next direction
  alignas(64) float choice[tile_size], roulette[tile_size];
  alignas(64) float x[tile_size], y[tile_size], z[tile_size];  // direction with density cosine / π
};

/// Where paths are, and what they carry once they have been reflected.
struct DiffuseTile {
  alignas(64) float point[3][tile_size] = {}, normal[3][tile_size] = {};  // on the side that they come from
  alignas(64) float throughput[3][tile_size] = {};
  std::uint64_t hash[tile_size] = {};
  std::uint32_t index[tile_size] = {}, slot[tile_size] = {};
  std::size_t size = 0;
};

/// To points of the emitters: their light, all of it zero where nothing can come from, and where the segments
/// are that must be free for it.
struct LampSegments {
  alignas(64) float light[3][tile_size], from[3][tile_size], way[3][tile_size];
};

/// Points that were drawn on emitters; b, c: weights of a triangle's second and third corner.
struct LampPoints {
  alignas(64) float b[tile_size], c[tile_size], point[3][tile_size], normal[3][tile_size];
  alignas(64) float emission[3][tile_size], pdf_area[tile_size];
};

/// `mis`: the light is what counts where directions of density cosine / π may meet the emitter as well. Not
/// to be called where the scene has no emitters.
inline void draw_lamps(const Surfaces& surfaces, const DiffuseTile& at, const TileDecisions& d, bool mis,
                       LampSegments& to) {
  LampPoints x;
#pragma GCC ivdep
  for (std::size_t i = 0; i < tile_size; ++i) {
    const float u = d.light_u[i], v = d.light_v[i], half = 0.5f * std::min(u, v);
    x.b[i] = v > u ? half : u - half, x.c[i] = v > u ? v - half : half;
  }
  for (std::size_t i = 0; i < tile_size; ++i) {
    const light::EmittingFace& f = surfaces.emitters().face_of(d.emitter[i]);
    const float b = x.b[i], c = x.c[i], a = std::max(0.0f, 1 - b - c);
    for (int k = 0; k < 3; ++k) {
      x.point[k][i] = f.corners.a[k] * a + f.corners.b[k] * b + f.corners.c[k] * c;
      x.normal[k][i] = f.normal[k], x.emission[k][i] = f.emission[k];
    }
    x.pdf_area[i] = f.pdf_area;
  }
  const float offset = surfaces.offset(), least = offset * offset;
  const float counted = mis ? 1.0f : 0.0f;
  constexpr float per_pi = 1 / std::numbers::pi_v<float>;
#pragma GCC ivdep
  for (std::size_t i = 0; i < tile_size; ++i) {
    const float wx = x.point[0][i] - at.point[0][i], wy = x.point[1][i] - at.point[1][i],
                wz = x.point[2][i] - at.point[2][i];
    const float nx = at.normal[0][i], ny = at.normal[1][i], nz = at.normal[2][i];
    const float distance2 = wx * wx + wy * wy + wz * wz, up = wx * nx + wy * ny + wz * nz;
    const float facing = -(wx * x.normal[0][i] + wy * x.normal[1][i] + wz * x.normal[2][i]);
    const float inverse = 1 / std::sqrt(distance2), pdf = x.pdf_area[i] * distance2 / (facing * inverse);
    const float reflected = up * inverse * per_pi;  // the cosine's part, and the density of directions
    const float ratio = counted * reflected / pdf;
    const float least_of_three = std::min(std::min(up, facing), distance2 - least);
    const float scale = least_of_three > 0 ? reflected / (pdf * (1 + ratio * ratio)) : 0.0f;
    to.light[0][i] = at.throughput[0][i] * x.emission[0][i] * scale;
    to.light[1][i] = at.throughput[1][i] * x.emission[1][i] * scale;
    to.light[2][i] = at.throughput[2][i] * x.emission[2][i] * scale;
    const float fx = at.point[0][i] + nx * offset, fy = at.point[1][i] + ny * offset,
                fz = at.point[2][i] + nz * offset;
    to.from[0][i] = fx, to.from[1][i] = fy, to.from[2][i] = fz;
    to.way[0][i] = x.point[0][i] + x.normal[0][i] * offset - fx;
    to.way[1][i] = x.point[1][i] + x.normal[1][i] * offset - fy;
    to.way[2][i] = x.point[2][i] + x.normal[2][i] * offset - fz;
  }
}

/// Rays that leave along the decisions' x, y, z.
struct TileRays {
  alignas(64) float origin[3][tile_size], direction[3][tile_size], pdf[tile_size];
};
inline void leave(const Surfaces& surfaces, const DiffuseTile& at, const TileDecisions& d, TileRays& rays) {
  const float offset = surfaces.offset();
#pragma GCC ivdep
  for (std::size_t i = 0; i < tile_size; ++i) {
    const float nx = at.normal[0][i], ny = at.normal[1][i], nz = at.normal[2][i];
    const float sign = std::copysign(1.0f, nz), a = -1 / (sign + nz), b = nx * ny * a;  // geometry::Frame
    const float x = d.x[i], y = d.y[i], z = d.z[i];
    rays.direction[0][i] = (1 + sign * nx * nx * a) * x + b * y + nx * z;
    rays.direction[1][i] = sign * b * x + (sign + ny * ny * a) * y + ny * z;
    rays.direction[2][i] = -sign * nx * x - ny * y + nz * z;
    for (int k = 0; k < 3; ++k) rays.origin[k][i] = at.point[k][i] + at.normal[k][i] * offset;
    rays.pdf[i] = z * (1 / std::numbers::pi_v<float>);
  }
}

}  // namespace treeline::shading::transport
