// How large a light looks from a receiver: which part of the shadow map may hold what hides it.
//
// From a receiver at depth d, the light's outline leads through depth z < d in an area of its own shape,
// which the map sees scaled by 1/z - 1/d (a light at the map's origin) or by d - z (the sun, whose outline is
// an angle). A blocker at z hides as much of the light as it covers of that area. Exact for a flat light
// whose plane is that of the map's, and to first order in the angle for the sun.
#pragma once

#include <cmath>

#include "shading/shadow/method.hpp"

namespace treeline::shading::shadow {

class LightExtent {
 public:
  /// Of the light as the view that was fitted to it sees it. Point and spot lights have no extent.
  LightExtent(const Light& light, const LightView& view) : view_(&view) {
    Vec3d u{}, v{};
    if (light.kind == LightKind::directional) {
      u = view.right * std::tan(light.angle), v = view.down * std::tan(light.angle), sun_ = true;
    } else if (light.kind == LightKind::rectangle || light.kind == LightKind::disc) {
      u = light.u, v = light.v;
    }
    disc_ = light.kind != LightKind::rectangle;
    if (!is_finite(u) || !is_finite(v) || light.angle < 0 || light.angle > 1.5)
      throw InvalidScene("the light's size is not finite, or its angle not in [0, 1.5]");
    if (sun_ == view.perspective) throw InvalidScene("the map's view is not one of such a light");
    ux_ = dot(u, view.right) / (2 * view.half_width), uy_ = dot(u, view.down) / (2 * view.half_height);
    vx_ = dot(v, view.right) / (2 * view.half_width), vy_ = dot(v, view.down) / (2 * view.half_height);
  }
  LightExtent(const Light&, LightView&&) = delete;

  bool disc() const { return disc_; }
  /// Factor of the area at depth z of what the receiver at depth d sees the light through; both as
  /// LightView::Place::depth. 0 where z is not nearer than d.
  double scale(double d, double z) const {
    const double range = view_->far - view_->near;
    if (sun_) return std::max(0.0, d - z) * range;
    const double world_d = view_->near + d * range, world_z = view_->near + z * range;
    constexpr double nearest = 1e-6;  // share of the way; nothing is seen nearer to the light
    return std::max(0.0, 1 / std::max(world_z, nearest * world_d) - 1 / world_d);
  }
  /// A place on the light, in [-1, 1]² or the unit disc, as an offset in the map, in shares of its sides, at
  /// scale 1.
  double offset_x(double a, double b) const { return ux_ * a + vx_ * b; }
  double offset_y(double a, double b) const { return uy_ * a + vy_ * b; }
  /// Half sides of the area's box at scale 1, in shares of the map's sides.
  double half_x() const { return disc_ ? std::hypot(ux_, vx_) : std::abs(ux_) + std::abs(vx_); }
  double half_y() const { return disc_ ? std::hypot(uy_, vy_) : std::abs(uy_) + std::abs(vy_); }
  /// The same of the box whose mean square distance from the middle, along each axis, is the area's: its
  /// penumbra is as steep.
  double box_x() const { return box(ux_, vx_); }
  double box_y() const { return box(uy_, vy_); }

 private:
  /// A side's mean square is 1/3, a disc's half axis' 1/4.
  double box(double a, double b) const { return std::hypot(a, b) * (disc_ ? std::sqrt(0.75) : 1); }

  const LightView* view_;
  bool sun_ = false, disc_ = true;
  double ux_ = 0, uy_ = 0, vx_ = 0, vy_ = 0;
};

}  // namespace treeline::shading::shadow
