// Smooth value noise on an integer lattice, and its fractal sum: the roughness of spheres, terrain and tubes.
// Source: Perlin 2002, Improving Noise (its quintic fade); lattice values by hash. Weakness: axis-aligned
// features.
#pragma once

#include "datasets_gen/portable.hpp"

namespace treeline::datasets {

/// Value noise in [-1, 1], twice differentiable; |coordinates| below 2^20.
inline double value_noise(std::uint64_t seed, const Vec3d& p) {
  std::int64_t cell[3];
  double fade[3];
  for (int i = 0; i < 3; ++i) {
    const double f = std::floor(p[i]), t = p[i] - f;
    cell[i] = static_cast<std::int64_t>(f);
    fade[i] = t * t * t * (t * (t * 6 - 15) + 10);
  }
  double corner[8];
  for (int k = 0; k < 8; ++k) {
    std::uint64_t key = 0;
    for (int i = 0; i < 3; ++i)
      key = key << 21 | (static_cast<std::uint64_t>(cell[i] + (k >> i & 1) + (1 << 20)) & 0x1fffff);
    corner[k] = static_cast<double>(geometry::hash_u64(seed, key) >> 11) * 0x1p-52 - 1;
  }
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 4 >> i; ++k)
      corner[k] = corner[2 * k] + (corner[2 * k + 1] - corner[2 * k]) * fade[i];
  return corner[0];
}

/// Sum of octaves, each of twice the frequency and half the height; in (-1, 1).
inline double fractal_noise(std::uint64_t seed, const Vec3d& p, int octaves) {
  double sum = 0, height = 0.5, frequency = 1;
  for (int o = 0; o < octaves; ++o, height *= 0.5, frequency *= 2)
    sum += height * value_noise(seed + static_cast<std::uint64_t>(o), scaled(p, frequency));
  return sum;
}

}  // namespace treeline::datasets
