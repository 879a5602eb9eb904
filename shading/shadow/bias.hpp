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

/// `reach`: how far, in texels along an axis, the centre of a texel may be that the point is compared with.
inline MapPoint locate(const LightView& view, int width, int height, const Receiver& receiver,
                       const Bias& bias, double reach) {
  MapPoint m;
  Vec3d p = receiver.position;
  if (bias.normal_offset > 0) {
    const Vec3d to_light = view.perspective ? view.origin - p : -view.forward;
    const double cosine = dot(receiver.normal, to_light) / length(to_light);
    const double z = dot(p - view.origin, view.forward);
    const double s = std::max(view.texel_width(width, z), view.texel_height(height, z));
    p += receiver.normal * (bias.normal_offset * s * std::sqrt(std::max(0.0, 1 - cosine * cosine)));
  }
  const LightView::Place q = view.place(p);
  // So written that NaN is outside.
  if (!(q.x >= 0 && q.x < 1 && q.y >= 0 && q.y < 1 && q.depth >= 0 && q.depth <= 1)) return m;
  m.inside = true;
  const double x = q.x * width, y = q.y * height;
  m.x = std::min(int(x), width - 1), m.y = std::min(int(y), height - 1);
  m.fx = float(x - m.x), m.fy = float(y - m.y), m.depth = float(q.depth);

  const double range = view.far - view.near, z = view.near + q.depth * range;
  const double across = dot(receiver.normal, view.right), along = dot(receiver.normal, view.down);
  // Along the plane, n · p is fixed: what moves sideways must move in depth. Seen in perspective, sideways
  // is along the ray through the point's neighbour, and the normal's part is that along the ray.
  double facing = dot(receiver.normal, view.forward);
  if (view.perspective) facing = dot(receiver.normal, p - view.origin) / z;
  constexpr double edge_on = 1e-9;  // the slope is then beyond any depth range
  if (std::abs(facing) < edge_on) facing = facing < 0 ? -edge_on : edge_on;
  const double sx = -across / facing * view.texel_width(width, z) / range;
  const double sy = -along / facing * view.texel_height(height, z) / range;
  m.slope_x = float(sx), m.slope_y = float(sy);

  const double steepness = std::abs(sx) + std::abs(sy);
  double sum = bias.constant;
  if (bias.receiver_plane) {
    const double unit = view.perspective ? z / range : 1;
    m.px = float(-sx / unit), m.py = float(-sy / unit);
    if (view.perspective) m.scaled = 1, m.fixed = float(view.near / range);
  } else {
    sum += std::min(bias.most, bias.slope * reach * steepness);
  }
  sum += geometry::tolerance::shadow_depth_slack * (1 + reach * std::min(steepness, 1e6));
  m.limit = float(q.depth - sum);
  return m;
}

inline MapPoint locate(const DepthMap& map, const Receiver& receiver, const Bias& bias, double reach) {
  return locate(map.view, map.width, map.height, receiver, bias, reach);
}

}  // namespace detail
}  // namespace treeline::shading::shadow
