// Exponential variance shadow maps (Lauritzen and McCool 2008): variance shadow maps of depths that an
// exponential has warped, so that what leaks lies close together; and of depths warped the other way, whose
// leaks are others. The smaller of the two bounds counts.
//
// Cost: 8 bytes a texel for one warp, 16 for both; one interpolated read, two exponentials. Known weakness:
// the square of the warp must fit its number, so c+ is at most 42 in float (5.54 in half); leaks remain where
// blockers are closer together than the range over c.
#pragma once

#include "shading/shadow/chebyshev.hpp"
#include "shading/shadow/moment_map.hpp"

namespace treeline::shading::shadow {

struct Exponents {
  double positive = 40, negative = 5;
};

/// K = 2: the positive warp's two moments; 4: the negative's behind them.
template <int K>
requires(K == 2 || K == 4) struct WarpedMap {
  Exponents exponents;
  MomentMap<K> map;
};

namespace detail {
inline float warp(float c, float z) { return std::exp(c * (2 * z - 1)); }
}  // namespace detail

/// Throws InvalidScene for exponents outside (0, 42].
template <int K>
WarpedMap<K> make_warped_map(const DepthMap& map, const Exponents& exponents = {},
                             const MomentMapOptions& options = {}) {
  detail::check_knob("exponents.positive", exponents.positive, 1e-3, 42);
  detail::check_knob("exponents.negative", exponents.negative, 1e-3, 42);
  const float p = float(exponents.positive), n = float(exponents.negative);
  return {exponents, make_moment_map<K>(map, options, [p, n](const DepthMap& source, int x, int y) {
            const float z = source.first[source.index(x, y)], a = detail::warp(p, z);
            std::array<float, K> m{a, a * a};
            if constexpr (K == 4) {
              const float b = -detail::warp(-n, z);
              m[2] = b, m[3] = b * b;
            }
            return m;
          })};
}

struct EvsmOptions {
  /// Deviation of depth that is taken to be there at least, as a share of its range; each warp scales it by
  /// its slope at the receiver.
  double least_deviation = 1e-4;
  double leak_cut = 0;  ///< visibility up to this is taken for none
  Bias bias{.slope = 0};
};

/// Throws InvalidScene for options that are none.
template <int K>
class Evsm {
 public:
  explicit Evsm(const WarpedMap<K>& map, const EvsmOptions& options = {})
      : map_(&map), options_(options), frame_(map.map.view, map.map.width, map.map.height, options.bias) {
    detail::check_knob("least_deviation", options.least_deviation, 0, 1);
    detail::check_knob("leak_cut", options.leak_cut, 0, 0.999);
  }
  Evsm(WarpedMap<K>&&, const EvsmOptions& = {}) = delete;

  float visibility(const Receiver& receiver) const {
    const MomentMap<K>& map = map_->map;
    const MapPoint m = frame_.locate(receiver, map.radius + 1);
    if (!m.inside) return 1;
    const std::array<float, K> moments = map.around(m);
    const float c = float(map_->exponents.positive);
    float v = bound(moments[0], moments[1], detail::warp(c, m.limit), c);
    if constexpr (K == 4) {
      const float n = float(map_->exponents.negative);
      v = std::min(v, bound(moments[2], moments[3], -detail::warp(-n, m.limit), n));
    }
    return cut_leak(v, float(options_.leak_cut));
  }
  std::size_t bytes() const { return map_->map.bytes(); }

 private:
  float bound(float mean, float square, float t, float c) const {
    const float least = 2 * c * t * float(options_.least_deviation);
    return chebyshev(mean, std::max(square - mean * mean, least * least), t);
  }
  const WarpedMap<K>* map_;
  EvsmOptions options_;
  detail::MapFrame frame_;
};
static_assert(ShadowMethod<Evsm<2>> && ShadowMethod<Evsm<4>>);

}  // namespace treeline::shading::shadow
