// Exponential shadow maps (Annen et al. 2008; Salvi 2008): a comparison as a product, exp(c z) exp(-c t),
// whose first factor can be filtered.
//
// Cost: 4 bytes a texel, one interpolated read, one exponential. Known weakness: the product is not small
// just behind a blocker (light leaks at contacts, over a depth of 1 / c) and above 1 where the filter holds
// depths behind the receiver (clamped, so a lit share of the filter outweighs any shadowed one). c is held to
// 88 by float's largest number.
#pragma once

#include "shading/shadow/moment_map.hpp"

namespace treeline::shading::shadow {

/// A map of exp(c z), and its c.
struct ExponentialMap {
  double exponent = 80;
  MomentMap<1> map;
};

/// Throws InvalidScene for an exponent outside (0, 88].
inline ExponentialMap make_exponential_map(const DepthMap& map, double exponent = 80,
                                           const MomentMapOptions& options = {}) {
  detail::check_knob("exponent", exponent, 1e-3, 88);
  const float c = float(exponent);
  return {exponent, make_moment_map<1>(map, options, [c](const DepthMap& source, int x, int y) {
            return std::array<float, 1>{std::exp(c * source.first[source.index(x, y)])};
          })};
}

struct EsmOptions {
  Bias bias{.slope = 0};
};

/// Throws InvalidScene for options that are none.
class Esm {
 public:
  explicit Esm(const ExponentialMap& map, const EsmOptions& options = {})
      : map_(&map), options_(options), frame_(map.map.view, map.map.width, map.map.height, options.bias) {}
  Esm(ExponentialMap&&, const EsmOptions& = {}) = delete;

  float visibility(const Receiver& receiver) const {
    const MomentMap<1>& map = map_->map;
    const MapPoint m = frame_.locate(receiver, map.radius + 1);
    if (!m.inside) return 1;
    return std::min(1.0f, map.around(m)[0] * std::exp(-float(map_->exponent) * m.limit));
  }
  std::size_t bytes() const { return map_->map.bytes(); }

 private:
  const ExponentialMap* map_;
  EsmOptions options_;
  detail::MapFrame frame_;
};
static_assert(ShadowMethod<Esm>);

}  // namespace treeline::shading::shadow
