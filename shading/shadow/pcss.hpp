// Percentage-closer soft shadows (Fernando 2005): a filter as wide as the penumbra of the blockers' mean
// depth.
//
// A search over the area of the map through which the receiver may see the light, at the near plane, finds
// the mean depth d_b of what is nearer than the receiver at d_r. For parallel planes and a light of width w_l
// the penumbra is then (d_r - d_b) w_l / d_b wide, all distances from the light's plane; the sun's is 2
// tan(alpha) (d_r - d_b). The filter has half that to each side of its middle: samples over [-1, 1] that are
// scaled by the whole width, as in much published code, make penumbrae twice too wide (`Width`).
// Cost: two sets of taps. Known weakness: blockers at several depths have one mean, which is right for none
// of them; a narrow blocker between the search's taps is missed.
#pragma once

#include "shading/shadow/light_extent.hpp"
#include "shading/shadow/pcf.hpp"

namespace treeline::shading::shadow {

enum class Width {
  half,  ///< the filter's radius is half the penumbra's width
  whole  ///< the common mistake: twice that
};

struct PcssOptions {
  int search_taps = 16;
  int filter_taps = 32;
  Width width = Width::half;
  double least_radius = 0.5;  ///< of the filter, in texels: at a contact it covers a texel
  bool turned = true;         ///< patterns by an angle or shift of each receiver's own
  Bias bias{.slope = 0, .receiver_plane = true};
};

/// What the search finds.
struct Blockers {
  int found = 0;
  float mean = 0;  ///< depth
};

/// Throws InvalidScene for a map, light or options that are none.
class Pcss {
 public:
  Pcss(const DepthMap& map, const Light& light, const PcssOptions& options = {})
      : map_(&map), options_(options), frame_(map, options.bias), extent_(light, map.view) {
    detail::check_map(map);
    detail::check_knob("least_radius", options.least_radius, 0, 1024);
    const auto pattern = extent_.disc() ? TapPattern::spiral : TapPattern::square;
    search_ = taps(pattern, options.search_taps), filter_ = taps(pattern, options.filter_taps);
    u_ = {float(extent_.offset_x(1, 0) * map.width), float(extent_.offset_y(1, 0) * map.height)};
    v_ = {float(extent_.offset_x(0, 1) * map.width), float(extent_.offset_y(0, 1) * map.height)};
    unit_ = std::max({extent_.half_x() * map.width, extent_.half_y() * map.height, 1e-12});
  }
  Pcss(DepthMap&&, const Light&, const PcssOptions& = {}) = delete;

  float visibility(const Receiver& receiver) const {
    const MapPoint m = locate(receiver);
    if (!m.inside) return 1;
    const Blockers blockers = search(m);
    if (blockers.found == 0) return 1;
    double scale = extent_.scale(m.depth, blockers.mean) * (options_.width == Width::whole ? 2 : 1);
    scale = std::max(scale, options_.least_radius / unit_);
    return 1 - float(compared(m, filter_, scale).blockers) / float(filter_.size());
  }
  std::size_t bytes() const { return map_->first.size() * sizeof(float); }

  /// The first step alone, at a receiver's place in the map.
  Blockers search(const MapPoint& m) const {
    const double scale = std::max(extent_.scale(m.depth, 0), options_.least_radius / unit_);
    const detail::Found found = compared(m, search_, scale);
    return {found.blockers, found.blockers ? found.depths / float(found.blockers) : 0};
  }
  MapPoint locate(const Receiver& receiver) const {
    const double far_texels = options_.bias.slope > 0 ? reach(receiver) : 0.5;
    return frame_.locate(receiver, far_texels);
  }

 private:
  /// In texels, of the widest filter there can be.
  double reach(const Receiver& receiver) const {
    const double depth = map_->view.place(receiver.position).depth;
    return 0.5 + std::max(options_.least_radius, extent_.scale(depth, 0) * unit_);
  }
  detail::Found compared(const MapPoint& m, const std::vector<Tap>& set, double scale) const {
    const float f = float(scale);
    const detail::TapFrame frame(extent_.disc(), options_.turned, detail::receiver_hash(m.fx, m.fy),
                                 {u_.x * f, u_.y * f}, {v_.x * f, v_.y * f});
    return detail::compare_taps(*map_, m, set, frame);
  }

  const DepthMap* map_;
  PcssOptions options_;
  detail::MapFrame frame_;
  LightExtent extent_;
  std::vector<Tap> search_, filter_;
  Tap u_{}, v_{};  ///< half axes of the light, in texels at scale 1
  double unit_;    ///< the longer of them
};
static_assert(ShadowMethod<Pcss>);

}  // namespace treeline::shading::shadow
