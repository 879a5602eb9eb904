// Variance soft shadow maps (Yang et al. 2010): percentage-closer soft shadows, both of whose sets of taps
// are replaced by a mean and a variance over a box, at a cost that does not grow with the box.
//
// Over the search's box, with P the share that Chebyshev's inequality says is not nearer than the receiver t,
// the mean mu is that of blockers and of the rest; if the rest is taken to be at depth t, the blockers' is
// (mu - P t) / (1 - P). The filter's box follows as in pcss.hpp, and its visibility from the same inequality.
// Where t <= mu the inequality says nothing: then the box is cut into smaller ones, each of which is asked in
// turn, against the receiver's plane at its own middle; those that still say nothing are sampled.
// Cost: two boxes of 16 reads; where it cuts, up to its square of parts as many. Known weakness: a light's
// disc is a box of the same variance; all of Chebyshev's leaks; a background far behind the receiver makes
// the blockers seem nearer than they are, down to in front of the light, and hides them altogether where the
// inequality is taken to mean "lit" for t <= mu (`BelowMean::lit`).
#pragma once

#include <optional>

#include "shading/shadow/light_extent.hpp"
#include "shading/shadow/pcf.hpp"
#include "shading/shadow/variance_sums.hpp"

namespace treeline::shading::shadow {

enum class BelowMean {
  lit,      ///< nothing nearer is taken to be there
  formula,  ///< the inequality's right side all the same, which is then no bound
  cut       ///< into parts
};

struct VssmOptions {
  BelowMean below_mean = BelowMean::cut;
  int parts = 4;                  ///< along each axis, of a box that is cut; 1 to 16
  bool early = true;              ///< where least and largest depth decide, ask no further; takes a pyramid
  double least_radius = 0.5;      ///< of the filter, in texels
  double least_variance = 1e-10;  ///< of depth as a share of its range
  bool clamped = true;            ///< blockers' mean depth to between the map's near plane and the receiver
  Bias bias{.slope = 0, .receiver_plane = true};
};

/// What the tables say about a box: the share nearer than the receiver, and its mean depth if there is one.
struct Occlusion {
  double share = 0, mean = 0;
};

/// Chebyshev's share and mean of blockers, for statistics over a box and a receiver at depth t; the rest is
/// taken to be at t. Unclamped: statistics for which that is wrong give means that are none.
inline Occlusion occlusion(const DepthStatistics& s, double t) {
  const double d = t - s.mean;
  const double p = s.variance + d * d > 0 ? s.variance / (s.variance + d * d) : 1;
  return {1 - p, p < 1 ? (s.mean - p * t) / (1 - p) : t};
}

/// Throws InvalidScene for a map, light or options that are none. The sums and the pyramid are of the same
/// map.
class Vssm {
 public:
  Vssm(const DepthMap& map, const VarianceSums& sums, const DepthPyramid* pyramid, const Light& light,
       const VssmOptions& options = {})
      : map_(&map),
        sums_(&sums),
        pyramid_(pyramid),
        options_(options),
        frame_(map, options.bias),
        extent_(light, map.view) {
    detail::check_map(map);
    detail::check_knob("parts", options.parts, 1, 16);
    detail::check_knob("least_radius", options.least_radius, 0, 1024);
    detail::check_knob("least_variance", options.least_variance, 0, 1);
    if (options.early && !pyramid) throw InvalidScene("asking no further early on takes a pyramid of depths");
  }

  float visibility(const Receiver& receiver) const {
    const MapPoint m = frame_.locate(receiver, 0.5);
    if (!m.inside) return 1;
    const TexelBox around = box(m, extent_.scale(m.depth, 0));
    if (const auto sure = decided(m, around)) return *sure;
    Occlusion found = occluded(m, around);
    if (!(found.share > 0)) return 1;
    if (options_.clamped) found.mean = std::clamp(found.mean, 0.0, double(m.limit));
    const TexelBox penumbra = box(m, extent_.scale(m.depth, found.mean));
    if (const auto sure = decided(m, penumbra)) return *sure;
    return float(std::clamp(1 - occluded(m, penumbra).share, 0.0, 1.0));
  }
  std::size_t bytes() const {
    return map_->first.size() * sizeof(float) + sums_->bytes() + (pyramid_ ? pyramid_->bytes() : 0);
  }

 private:
  TexelBox box(const MapPoint& m, double scale) const {
    const double x = m.x + double(m.fx), y = m.y + double(m.fy);
    const double hx = std::max(options_.least_radius, extent_.box_x() * scale * map_->width);
    const double hy = std::max(options_.least_radius, extent_.box_y() * scale * map_->height);
    return {x - hx, x + hx, y - hy, y + hy};
  }
  /// 1 or 0 where all depths in the box are behind, or nearer than, the receiver's plane.
  std::optional<float> decided(const MapPoint& m, const TexelBox& b) const {
    if (!options_.early) return std::nullopt;
    const DepthPyramid::Range r = pyramid_->over(b);
    float low = INFINITY, high = -INFINITY;
    for (const double x : {b.x0, b.x1})
      for (const double y : {b.y0, b.y1}) {
        const float limit = m.limit_at(float(x - m.x) - m.fx, float(y - m.y) - m.fy);
        low = std::min(low, limit), high = std::max(high, limit);
      }
    if (r.low >= high) return 1.0f;
    if (r.high < low) return 0.0f;
    return std::nullopt;
  }
  Occlusion occluded(const MapPoint& m, const TexelBox& b) const {
    const DepthStatistics s = statistics(b);
    if (m.limit > s.mean || options_.below_mean == BelowMean::formula) return occlusion(s, m.limit);
    return options_.below_mean == BelowMean::lit ? Occlusion{} : cut(m, b);
  }
  DepthStatistics statistics(const TexelBox& b) const {
    DepthStatistics s = sums_->over(b);
    s.variance = std::max(s.variance, options_.least_variance);
    return s;
  }
  Occlusion cut(const MapPoint& m, const TexelBox& b) const {
    const int n = options_.parts;
    const double w = (b.x1 - b.x0) / n, h = (b.y1 - b.y0) / n;
    // A small part holds the plane in steps of texels: by up to half a one it may seem nearer than it is.
    const double steps = 0.5 * (std::abs(m.slope_x) + std::abs(m.slope_y));
    double share = 0, depths = 0;
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        const TexelBox part{b.x0 + i * w, b.x0 + (i + 1) * w, b.y0 + j * h, b.y0 + (j + 1) * h};
        const float dx = float(0.5 * (part.x0 + part.x1) - m.x) - m.fx;
        const float dy = float(0.5 * (part.y0 + part.y1) - m.y) - m.fy;
        const double t = m.limit_at(dx, dy);
        const DepthStatistics s = statistics(part);
        const Occlusion o = t - steps > s.mean && t < 2 ? occlusion(s, t) : sampled(m, dx, dy, w, h);
        share += o.share, depths += o.share * o.mean;
      }
    return {share / (n * n), share > 0 ? depths / share : 0};
  }
  /// Four taps in a part of sides w, h around (dx, dy).
  Occlusion sampled(const MapPoint& m, float dx, float dy, double w, double h) const {
    int found = 0;
    double depths = 0;
    for (const float a : {-0.25f, 0.25f})
      for (const float b : {-0.25f, 0.25f}) {
        const float fx = std::floor(m.fx + dx + a * float(w)), fy = std::floor(m.fy + dy + b * float(h));
        const float x = float(m.x) + fx, y = float(m.y) + fy;
        if (!(x >= 0 && y >= 0 && x < float(map_->width) && y < float(map_->height))) continue;
        const float z = map_->first[map_->index(int(x), int(y))];
        if (m.lit(z, fx + 0.5f - m.fx, fy + 0.5f - m.fy)) continue;
        ++found, depths += z;
      }
    return {found / 4.0, found ? depths / found : 0};
  }

  const DepthMap* map_;
  const VarianceSums* sums_;
  const DepthPyramid* pyramid_;
  VssmOptions options_;
  detail::MapFrame frame_;
  LightExtent extent_;
};
static_assert(ShadowMethod<Vssm>);

}  // namespace treeline::shading::shadow
