// Percentage-closer filtering (Reeves, Salesin and Cook 1987): the share of comparisons, over a fixed area of
// the map, that leave the receiver lit. Comparisons are averaged, not depths.
//
// Cost: one read a tap. Known weakness: n taps tell n + 1 levels apart, which band a wide penumbra (an error
// of 1 / (sqrt(12) n) across a straight edge); the blur is as wide at a contact as far from it; bias grows
// with the filter, unless each texel is compared with the receiver's plane.
#pragma once

#include "shading/shadow/bias.hpp"
#include "shading/shadow/taps.hpp"

namespace treeline::shading::shadow {

struct PcfGridOptions {
  int radius = 1;  ///< texels to each side: 2 radius + 1 squared taps
  /// The filter is a square of side 2 radius + 1 around the receiver itself and not around its texel's
  /// centre: texels at its border count by the area within. One more row and column of reads.
  bool smooth = false;
  Bias bias;
};

struct PcfDiscOptions {
  int taps = 16;
  double radius = 2;  ///< texels
  TapPattern pattern = TapPattern::spiral;
  bool turned = true;  ///< each receiver by an angle or shift of its own: noise for banding
  Bias bias;
};

namespace detail {

/// How many texels of [x0, x1) × [y0, y1), all within the map, leave the point lit.
inline int count_lit(const DepthMap& map, const MapPoint& m, int x0, int x1, int y0, int y1) {
  int lit = 0;
  for (int y = y0; y < y1; ++y) {
    const float* row = map.first.data() + map.index(0, y);
    const float up = m.py * (float(y - m.y) + 0.5f - m.fy), left = 0.5f - m.fx;
    for (int x = x0; x < x1; ++x) {
      const float z = row[x];
      lit += z + (m.scaled * z + m.fixed) * (m.px * (float(x - m.x) + left) + up) >= m.limit;
    }
  }
  return lit;
}

}  // namespace detail

/// A square of texels. Throws InvalidScene for a map or options that are none.
class PcfGrid {
 public:
  explicit PcfGrid(const DepthMap& map, const PcfGridOptions& options = {})
      : map_(&map), options_(options), frame_(map, options.bias) {
    detail::check_map(map);
    detail::check_knob("radius", options.radius, 0, 1024);
  }
  PcfGrid(DepthMap&&, const PcfGridOptions& = {}) = delete;

  float visibility(const Receiver& receiver) const {
    const int r = options_.radius;
    const double reach = r + (options_.smooth ? 1 : 0.5);
    const MapPoint m = frame_.locate(receiver, reach);
    if (!m.inside) return 1;
    return options_.smooth ? smooth(m, r) : square(m, r);
  }
  std::size_t bytes() const { return map_->first.size() * sizeof(float); }

 private:
  float square(const MapPoint& m, int r) const {
    const int x0 = std::max(m.x - r, 0), x1 = std::min(m.x + r + 1, map_->width);
    const int y0 = std::max(m.y - r, 0), y1 = std::min(m.y + r + 1, map_->height);
    const int all = (2 * r + 1) * (2 * r + 1), held = (x1 - x0) * (y1 - y0);
    return float(all - held + detail::count_lit(*map_, m, x0, x1, y0, y1)) / float(all);
  }
  /// The square overlaps one column more, unless the receiver is in the middle of its texel; the first
  /// counts as much as the last is short of.
  float smooth(const MapPoint& m, int r) const {
    const int shift_x = m.fx < 0.5f ? -1 : 0, shift_y = m.fy < 0.5f ? -1 : 0, n = 2 * r + 1;
    const float last_x = m.fx - 0.5f - float(shift_x), last_y = m.fy - 0.5f - float(shift_y);
    const int x0 = m.x - r + shift_x, y0 = m.y - r + shift_y;
    float shadowed = 0;
    for (int j = 0; j <= n; ++j) {
      const int y = y0 + j;
      if (y < 0 || y >= map_->height) continue;
      const int a = std::clamp(x0 + 1, 0, map_->width), b = std::clamp(x0 + n, 0, map_->width);
      float row = float(b - a - detail::count_lit(*map_, m, a, b, y, y + 1));
      row += lit(m, x0, y) ? 0 : 1 - last_x;
      row += lit(m, x0 + n, y) ? 0 : last_x;
      shadowed += row * (j == 0 ? 1 - last_y : j == n ? last_y : 1);
    }
    return std::max(0.0f, 1 - shadowed / float(n * n));
  }
  bool lit(const MapPoint& m, int x, int y) const {
    if (x < 0 || x >= map_->width) return true;
    return m.lit(map_->first[map_->index(x, y)], float(x - m.x) + 0.5f - m.fx, float(y - m.y) + 0.5f - m.fy);
  }

  const DepthMap* map_;
  PcfGridOptions options_;
  detail::MapFrame frame_;
};
static_assert(ShadowMethod<PcfGrid>);

/// Taps over a disc (or the square of side 2 radius). Throws InvalidScene for a map or options that are none.
class PcfDisc {
 public:
  explicit PcfDisc(const DepthMap& map, const PcfDiscOptions& options = {})
      : map_(&map), options_(options), frame_(map, options.bias), taps_(taps(options.pattern, options.taps)) {
    detail::check_map(map);
    detail::check_knob("radius", options.radius, 0, 4096);
  }
  PcfDisc(DepthMap&&, const PcfDiscOptions& = {}) = delete;

  float visibility(const Receiver& receiver) const {
    const MapPoint m = frame_.locate(receiver, options_.radius + 0.5);
    if (!m.inside) return 1;
    const float radius = float(options_.radius);
    const detail::TapFrame frame(options_.pattern != TapPattern::square, options_.turned,
                                 detail::receiver_hash(m.fx, m.fy), {radius, 0}, {0, radius});
    const int shadowed = detail::compare_taps(*map_, m, taps_, frame).blockers;
    return 1 - float(shadowed) / float(taps_.size());
  }
  std::size_t bytes() const { return map_->first.size() * sizeof(float); }

 private:
  const DepthMap* map_;
  PcfDiscOptions options_;
  detail::MapFrame frame_;
  std::vector<Tap> taps_;
};
static_assert(ShadowMethod<PcfDisc>);

}  // namespace treeline::shading::shadow
