// Variance shadow maps (Donnelly and Lauritzen 2006): mean and mean square of depth can be filtered like a
// texture, and bound the share that lies behind the receiver.
//
// A texel is taken for a patch of its surface's plane, whose depths vary by 1/4 of its slopes' squares; that
// is added to the square. Cost: 8 bytes a texel, one interpolated read. Known weakness: the bound is met by
// one blocker and one background alone. Two blockers, the receiver behind both, leak light; with r the ratio
// of its distance behind the farther to the distance between them, up to 1 / (1 + 2 r)². Cutting low
// visibilities off
// (`leak_cut`) hides leaks and narrows penumbrae. Differences of squares lose half of float's digits, which
// `least_variance` covers.
#pragma once

#include "shading/shadow/chebyshev.hpp"
#include "shading/shadow/moment_map.hpp"

namespace treeline::shading::shadow {

struct VarianceMapOptions {
  MomentMapOptions map;
  bool slopes = true;  ///< texels are patches of planes; if not, points
};

/// Depth's first two moments, in float.
inline MomentMap<2> make_variance_map(const DepthMap& map, const VarianceMapOptions& options = {}) {
  return make_moment_map<2>(map, options.map, [&](const DepthMap& source, int x, int y) {
    const float z = source.first[source.index(x, y)];
    float sx = 0, sy = 0;
    if (options.slopes) detail::texel_slopes(source, x, y, sx, sy);
    return std::array<float, 2>{z, z * z + 0.25f * (sx * sx + sy * sy)};
  });
}

struct VsmOptions {
  double least_variance = 1e-6;  ///< of depth as a share of its range: float's own error is up to 1e-7
  double leak_cut = 0;           ///< visibility up to this is taken for none
  Bias bias{.slope = 0};
};

/// Throws InvalidScene for options that are none.
class Vsm {
 public:
  explicit Vsm(const MomentMap<2>& map, const VsmOptions& options = {})
      : map_(&map), options_(options), frame_(map.view, map.width, map.height, options.bias) {
    detail::check_knob("least_variance", options.least_variance, 0, 1);
    detail::check_knob("leak_cut", options.leak_cut, 0, 0.999);
  }
  Vsm(MomentMap<2>&&, const VsmOptions& = {}) = delete;

  float visibility(const Receiver& receiver) const {
    const MapPoint m = frame_.locate(receiver, map_->radius + 1);
    if (!m.inside) return 1;
    const auto [mean, square] = map_->around(m);
    const float variance = std::max(square - mean * mean, float(options_.least_variance));
    return cut_leak(chebyshev(mean, variance, m.limit), float(options_.leak_cut));
  }
  std::size_t bytes() const { return map_->bytes(); }

 private:
  const MomentMap<2>* map_;
  VsmOptions options_;
  detail::MapFrame frame_;
};
static_assert(ShadowMethod<Vsm>);

}  // namespace treeline::shading::shadow
