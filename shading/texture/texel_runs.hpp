// An interval along one axis of a texture as at most three runs of texels: the first texel, cut; whole ones;
// the last one, cut. The product of two such is a box, exactly, with fractional and clamped borders.
#pragma once

#include <array>

namespace treeline::shading::texture {

struct TexelRuns {
  std::array<int, 4> edge;       ///< run k is [edge[k], edge[k + 1]); the first and the last hold one texel
  std::array<double, 3> weight;  ///< of each texel of run k; those of all texels sum to 1
};

/// [low, high] on an axis of n texels, whose outermost go on without end. A run may be empty, or of weight 0.
inline TexelRuns texel_runs(double low, double high, int n) {
  const double last = n - 1;
  // Clamped before they become integers, so that borders far outside are no overflow; what is not negative is
  // cut down to its floor. Written for the machine's minimum and maximum.
  const auto texel = [last](double x) {
    x = x > 0 ? x : 0.0;
    return static_cast<int>(x < last ? x : last);
  };
  const int i = texel(low), k = texel(high);
  if (k <= i || !(high > low)) return {{i, i + 1, i + 1, i + 1}, {1, 0, 0}};
  const double scale = 1 / (high - low);
  return {{i, i + 1, k, k + 1}, {(i + 1 - low) * scale, scale, (high - k) * scale}};
}

}  // namespace treeline::shading::texture
