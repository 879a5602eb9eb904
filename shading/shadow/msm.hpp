// Moment shadow maps (Peters and Klein 2015): four moments of depth, filtered like a texture, and the least
// shadow that agrees with them (hamburger.hpp).
//
// Depths are stored in [-1, 1], which leaves ten bits more of the moments' information than [0, 1] does
// (Peters et al. 2017). In 16 bits the four numbers of a texel are mixed so that each fills its range: odd
// moments with odd, even with even. Cost: 16 or 8 bytes a texel, one interpolated read, some 40 operations.
// Known weakness: three layers in one filter leak light, more the nearer the receiver is behind the last
// (1/49 where all gaps are equal, .22 where the last is a quarter of the others); `alpha`, which rounding
// makes necessary, adds to it and hides acne.
#pragma once

#include <cstdint>

#include "shading/shadow/chebyshev.hpp"
#include "shading/shadow/hamburger.hpp"
#include "shading/shadow/moment_map.hpp"

namespace treeline::shading::shadow {

/// The first four moments of 2 z - 1.
inline MomentMap<4> make_four_moment_map(const DepthMap& map, const MomentMapOptions& options = {}) {
  return make_moment_map<4>(map, options, [](const DepthMap& source, int x, int y) {
    const float z = 2 * source.first[source.index(x, y)] - 1, square = z * z;
    return std::array<float, 4>{z, square, square * z, square * square};
  });
}

/// Moments as 16 bits each.
struct QuantisedMoments {
  LightView view;
  int width = 0, height = 0, radius = 0;
  std::vector<std::array<std::uint16_t, 4>> values;
  std::size_t bytes() const { return values.size() * sizeof(values[0]); }
};

namespace detail {

inline constexpr double root3 = 1.7320508075688772;

/// To [0, 1]⁴ from the moments of any depths in [-1, 1]; for one depth z, in this order:
/// ½ + 3/2 z - 2 z³, 4 z² (1 - z²), ½ + √3/2 z - 2√3/9 z³, ½ z² (1 + z²). Each of these fills [0, 1].
inline std::array<float, 4> mixed(const std::array<float, 4>& m) {
  return {1.5f * m[0] - 2 * m[2] + 0.5f, 4 * (m[1] - m[3]),
          float(root3 / 2) * m[0] - float(2 * root3 / 9) * m[2] + 0.5f, 0.5f * (m[1] + m[3])};
}
inline std::array<float, 4> unmixed(const std::array<float, 4>& q) {
  const float a = q[0] - 0.5f, b = q[2] - 0.5f;
  return {float(root3) * b - a / 3, q[3] + q[1] / 8, 0.75f * (float(root3) * b - a), q[3] - q[1] / 8};
}

}  // namespace detail

inline QuantisedMoments quantised(const MomentMap<4>& map) {
  QuantisedMoments r{map.view, map.width, map.height, map.radius, {}};
  r.values.resize(map.values.size() / 4);
  for (std::size_t i = 0; i < r.values.size(); ++i) {
    const float* m = map.values.data() + 4 * i;
    const std::array<float, 4> q = detail::mixed({m[0], m[1], m[2], m[3]});
    for (std::size_t k = 0; k < 4; ++k)
      r.values[i][k] = std::uint16_t(std::clamp(q[k], 0.0f, 1.0f) * 65535 + 0.5f);
  }
  return r;
}

struct MsmOptions {
  /// Share of the moments that is given up for their rounding's sake; 6e-5 for 16 bits.
  double alpha = 3e-7;
  double leak_cut = 0;  ///< visibility up to this is taken for none
  Bias bias{.slope = 0};
};

/// Over floats or 16 bits. Throws InvalidScene for options that are none.
template <class Map>
requires(std::same_as<Map, MomentMap<4>> || std::same_as<Map, QuantisedMoments>) class Msm {
 public:
  explicit Msm(const Map& map, const MsmOptions& options = {})
      : map_(&map), options_(options), frame_(map.view, map.width, map.height, options.bias) {
    detail::check_knob("alpha", options.alpha, 0, 1);
    detail::check_knob("leak_cut", options.leak_cut, 0, 0.999);
  }
  Msm(Map&&, const MsmOptions& = {}) = delete;

  float visibility(const Receiver& receiver) const {
    const MapPoint m = frame_.locate(receiver, map_->radius + 1);
    if (!m.inside) return 1;
    const auto moments = moved_moments(moments_around(m), float(options_.alpha));
    const float shadow = hamburger(moments, 2 * m.limit - 1).before;
    return cut_leak(1 - shadow, float(options_.leak_cut));
  }
  std::size_t bytes() const { return map_->bytes(); }

 private:
  std::array<float, 4> moments_around(const MapPoint& m) const {
    if constexpr (std::same_as<Map, MomentMap<4>>)
      return map_->around(m);
    else
      return between(*map_, m);
  }
  /// Interpolates before it unmixes, which is linear.
  static std::array<float, 4> between(const QuantisedMoments& map, const MapPoint& m) {
    const TexelSquare s(m, map.width, map.height);
    std::array<float, 4> q{};
    for (int i = 0; i < 4; ++i) {
      const auto& value = map.values[s.index[i]];
      for (std::size_t k = 0; k < 4; ++k) q[k] += s.weight[i] / 65535 * float(value[k]);
    }
    return detail::unmixed(q);
  }
  const Map* map_;
  MsmOptions options_;
  detail::MapFrame frame_;
};
static_assert(ShadowMethod<Msm<MomentMap<4>>> && ShadowMethod<Msm<QuantisedMoments>>);

}  // namespace treeline::shading::shadow
