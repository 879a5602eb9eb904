// The shadow map (Williams 1978): a point is lit unless the light sees something nearer in its texel.
//
// Cost: one read a receiver. Known weakness: what a texel holds is true at its centre alone, so that surfaces
// shadow themselves without a bias (see bias.hpp) and borders of shadows are those of texels; light is a
// point.
#pragma once

#include "shading/shadow/bias.hpp"

namespace treeline::shading::shadow {

struct ShadowMapOptions {
  Bias bias;
};

/// Throws InvalidScene for a map or options that are none.
class ShadowMap {
 public:
  explicit ShadowMap(const DepthMap& map, const ShadowMapOptions& options = {})
      : map_(&map), frame_(map, options.bias) {
    detail::check_map(map);
  }
  ShadowMap(DepthMap&&, const ShadowMapOptions& = {}) = delete;

  float visibility(const Receiver& receiver) const {
    const MapPoint m = frame_.locate(receiver, 0.5);
    if (!m.inside) return 1;
    return m.lit(map_->first[map_->index(m.x, m.y)], 0.5f - m.fx, 0.5f - m.fy);
  }
  std::size_t bytes() const { return map_->first.size() * sizeof(float); }

 private:
  const DepthMap* map_;
  detail::MapFrame frame_;
};
static_assert(ShadowMethod<ShadowMap>);

}  // namespace treeline::shading::shadow
