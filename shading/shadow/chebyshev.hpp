// What a mean and a variance say about the share that lies behind: the one-sided Chebyshev inequality, with
// the guards that it needs in practice.
#pragma once

#include <algorithm>
#include <cmath>

#include "shading/shadow/depth_map.hpp"

namespace treeline::shading::shadow {

/// At most this share of a distribution with this mean and variance is at t or beyond, for t > mean
/// (Cantelli); for t <= mean nothing is known and this is 1.
template <class T>
T chebyshev(T mean, T variance, T t) {
  const T d = t - mean;
  return d <= 0 ? T(1) : variance / (variance + d * d);
}

/// What is left of a visibility if all up to `cut` is taken to be leaked light and the rest stretched.
template <class T>
T cut_leak(T visibility, T cut) {
  return std::clamp((visibility - cut) / (1 - cut), T(0), T(1));
}

namespace detail {

/// Slopes of the surface in a texel, depth per texel: of the differences to both sides the smaller, which is
/// not that across an edge.
inline void texel_slopes(const DepthMap& map, int x, int y, float& sx, float& sy) {
  const float z = map.first[map.index(x, y)];
  const auto smaller = [](float a, float b) { return std::abs(a) < std::abs(b) ? a : b; };
  const float l = x > 0 ? z - map.first[map.index(x - 1, y)] : INFINITY;
  const float r = x + 1 < map.width ? map.first[map.index(x + 1, y)] - z : INFINITY;
  const float u = y > 0 ? z - map.first[map.index(x, y - 1)] : INFINITY;
  const float d = y + 1 < map.height ? map.first[map.index(x, y + 1)] - z : INFINITY;
  sx = smaller(l, r), sy = smaller(u, d);
  if (!std::isfinite(sx)) sx = 0;
  if (!std::isfinite(sy)) sy = 0;
}

}  // namespace detail
}  // namespace treeline::shading::shadow
