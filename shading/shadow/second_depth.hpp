// Depths between the first surface and the next one, so that neither shadows itself: a depth map made of two.
//
// Midpoint (Woo 1992): halfway between the first two surfaces. Dual depth (Weiskopf and Ertl 2003): the same,
// but no more than b_max behind the first. Second depth (Wang and Molnar 1994): the second surface itself,
// which self-shadows on its back, where no light falls. The map that comes out is used as any other, without
// a bias.
// Cost: a second layer to make; queries as before. Known weakness: a solid of thickness T along the light
// still shows acne on a share max(0, 1/2 - T / (2 s tan theta)) of its surface; a sheet of no thickness (an
// open mesh) puts the midpoint halfway to whatever is behind it, and the second depth loses its shadow; under
// the second depth what rests on the ground ties with it.
#pragma once

#include <algorithm>

#include "shading/shadow/method.hpp"

namespace treeline::shading::shadow {

enum class SecondDepth { midpoint, dual, second };

struct SecondDepthOptions {
  SecondDepth kind = SecondDepth::midpoint;
  double most = 0.01;  ///< b_max of dual depth, as a share of the map's depth range
};

/// A map with the depth to compare with as its first, and no second. A texel with one surface alone counts
/// what is behind it as at depth 1. Throws InvalidScene if the map has no second depths.
inline DepthMap between_depths(const DepthMap& map, const SecondDepthOptions& options = {}) {
  detail::check_map(map, true);
  detail::check_knob("most", options.most, 0, 1);
  DepthMap r{map.view, map.width, map.height, {}, {}};
  r.first.resize(map.first.size());
  for (std::size_t i = 0; i < r.first.size(); ++i) {
    const float a = map.first[i], b = std::max(a, map.second[i]);
    switch (options.kind) {
      case SecondDepth::midpoint:
        r.first[i] = a + 0.5f * (b - a);
        break;
      case SecondDepth::dual:
        r.first[i] = a + std::min(0.5f * (b - a), float(options.most));
        break;
      case SecondDepth::second:
        r.first[i] = b;
        break;
    }
  }
  return r;
}

}  // namespace treeline::shading::shadow
