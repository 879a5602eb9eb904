// Bias: how far a receiver is taken to be nearer to the light than it is, so that it does not shadow itself.
//
// A texel holds the depth at its centre. A receiver of the same plane, up to half a texel away along each
// axis, differs from it by the plane's slope. With s the side of a texel, theta the angle between light and
// normal, phi the direction of the slope in the map and r the radius of a filter in texels, no point of the
// plane shadows itself if, and only if, the bias along the light is at least
//   (r + 1/2) s tan(theta) (|cos phi| + |sin phi|),
// which is what `slope` = 1 gives (over a perspective map the bound is enough, if no longer the least: depth
// is then convex along the plane's rise). Moving the receiver by k s sin(theta) along its normal lifts the
// plane by k s tan(theta) along the light. Comparing each texel with the receiver's plane at that texel's own
// centre needs no bias at all, but for rounding.
// Known weakness: bias loses shadow. A wall's shadow starts b sin(theta) away from its foot; under an offset
// along the normal it starts at the foot and its tip is short by the same length.
#pragma once

#include <algorithm>
#include <cmath>

#include "geometry/tolerances.hpp"
#include "shading/shadow/method.hpp"

namespace treeline::shading::shadow {

/// The parts add up; all zero is no bias but the allowance for rounding.
struct Bias {
  double constant = 0;          ///< share of the map's depth range; .005 is the usual default of others
  double slope = 1;             ///< in multiples of the bound above
  double most = 1;              ///< cap of the slope's part, as a share of the depth range
  bool receiver_plane = false;  ///< compare with the receiver's plane at each texel's centre
  double normal_offset = 0;     ///< k, in texels; sqrt(1/2) suffices for a filter of one texel
};

/// A receiver as the map sees it: its texel, where in it, how deep, and the slope of its plane.
struct MapPoint {
  bool inside = false;             ///< of the map; if not, nothing else is set
  int x = 0, y = 0;                ///< the texel
  float fx = 0, fy = 0;            ///< where in it, in [0, 1)
  float depth = 0;                 ///< without bias
  float limit = 0;                 ///< with bias: what is less deep shadows the point
  float slope_x = 0, slope_y = 0;  ///< of the receiver's plane: depth per texel, at the point
  /// Of the comparison with the receiver's plane; zero if it is not wanted. Depth along the plane is linear
  /// over a parallel map, its reciprocal over a perspective one.
  float px = 0, py = 0, scaled = 0, fixed = 1;

  /// Whether a texel that holds depth z leaves the point lit; dx, dy from the point to its centre, in texels.
  bool lit(float z, float dx, float dy) const {
    return z + (scaled * z + fixed) * (px * dx + py * dy) >= limit;
  }
  /// The depth from which on texels leave the point lit, that far from it; infinite where the receiver's
  /// plane does not reach.
  float limit_at(float dx, float dy) const {
    const float p = px * dx + py * dy, share = 1 + scaled * p;
    return share > 0 ? (limit - fixed * p) / share : INFINITY;
  }
};

namespace detail {

inline void check(const Bias& b) {
  check_knob("bias.constant", b.constant, -1, 1);
  check_knob("bias.slope", b.slope, 0, 1e6);
  check_knob("bias.most", b.most, 0, 1e6);
  check_knob("bias.normal_offset", b.normal_offset, 0, 1e6);
}

/// A map's view and a bias, with all divided beforehand that does not depend on the receiver.
class MapFrame {
 public:
  /// Throws InvalidScene for a bias that is none.
  MapFrame(const LightView& view, int width, int height, const Bias& bias)
      : view_(view),
        bias_(bias),
        width_(width),
        height_(height),
        texel_x_(2 * view.half_width / width),
        texel_y_(2 * view.half_height / height),
        range_(view.far - view.near),
        per_range_(1 / range_),
        across_(view.right * (1 / texel_x_)),
        along_(view.down * (1 / texel_y_)) {
    check(bias);
  }
  MapFrame(const DepthMap& map, const Bias& bias) : MapFrame(map.view, map.width, map.height, bias) {}

  /// `reach`: how far, in texels along an axis, the centre of a texel may be that the point is compared with.
  MapPoint locate(const Receiver& receiver, double reach) const {
    MapPoint m;
    Vec3d d = receiver.position - view_.origin;
    if (bias_.normal_offset > 0) d += offset(receiver.normal, d);
    const double z = dot(d, view_.forward), scale = view_.perspective ? z : 1, per_scale = 1 / scale;
    const double x = 0.5 * width_ + dot(d, across_) * per_scale,
                 y = 0.5 * height_ + dot(d, along_) * per_scale;
    const double depth = (z - view_.near) * per_range_;
    // So written that NaN is outside.
    if (!(x >= 0 && x < width_ && y >= 0 && y < height_ && depth >= 0 && depth <= 1)) return m;
    m.inside = true;
    m.x = int(x), m.y = int(y);
    m.fx = float(x - m.x), m.fy = float(y - m.y), m.depth = float(depth);

    // Along the plane, n · d is fixed: what moves sideways must move in depth. Seen in perspective, sideways
    // is along the ray through the point's neighbour, and the normal's part is that along the ray.
    double facing =
        view_.perspective ? dot(receiver.normal, d) * per_scale : dot(receiver.normal, view_.forward);
    constexpr double edge_on = 1e-9;  // the slope is then beyond any depth range
    if (std::abs(facing) < edge_on) facing = facing < 0 ? -edge_on : edge_on;
    const double rise = -scale * per_range_ / facing;
    const double sx = dot(receiver.normal, across_) * (texel_x_ * texel_x_ * rise);
    const double sy = dot(receiver.normal, along_) * (texel_y_ * texel_y_ * rise);
    m.slope_x = float(sx), m.slope_y = float(sy);

    const double steepness = std::abs(sx) + std::abs(sy);
    double sum = bias_.constant;
    if (bias_.receiver_plane) {
      const double unit = view_.perspective ? range_ * per_scale : 1;
      m.px = float(-sx * unit), m.py = float(-sy * unit);
      if (view_.perspective) m.scaled = 1, m.fixed = float(view_.near * per_range_);
    } else {
      sum += std::min(bias_.most, bias_.slope * reach * steepness);
    }
    constexpr double steepest = 1e6;  // depth ranges a texel: beyond, a slack for rounding has no meaning
    sum += geometry::tolerance::shadow_depth_slack * (1 + reach * std::min(steepness, steepest));
    m.limit = float(depth - sum);
    return m;
  }

 private:
  Vec3d offset(const Vec3d& normal, const Vec3d& d) const {
    const Vec3d to_light = view_.perspective ? -d : -view_.forward;
    const double cosine = dot(normal, to_light) / length(to_light);
    const double texel = std::max(texel_x_, texel_y_) * (view_.perspective ? dot(d, view_.forward) : 1);
    return normal * (bias_.normal_offset * texel * std::sqrt(std::max(0.0, 1 - cosine * cosine)));
  }

  LightView view_;
  Bias bias_;
  double width_, height_, texel_x_, texel_y_, range_, per_range_;
  Vec3d across_, along_;  ///< a texel each
};

}  // namespace detail
}  // namespace treeline::shading::shadow
