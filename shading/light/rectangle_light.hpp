// A rectangle that emits from one side, sampled evenly over its solid angle: relative variance of what
// arrives is that of the receiver's cosine alone, also where light and receiver all but touch.
#pragma once

#include "shading/light/light.hpp"
#include "shading/light/spherical_rectangle.hpp"

namespace treeline::shading::light {

class RectangleLight {
 public:
  /// middle ± u ± v; light leaves on the side of cross(u, v). radiance: W / (m² sr). Throws InvalidLight for
  /// half sides that are zero, not finite or not perpendicular, and a radiance that is negative or not
  /// finite.
  RectangleLight(const Vec3d& middle, const Vec3d& u, const Vec3d& v, const Vec3d& radiance)
      : middle_(middle), u_(u), v_(v), radiance_(radiance) {
    detail::check_finite(middle, "rectangle light", "middle");
    detail::check_half_sides(u, v, "rectangle light");
    detail::check_colour(radiance, "rectangle light", "radiance");
    normal_ = normalized(cross(u, v));
  }

  /// Nothing from behind it, or from its plane.
  LightSample sample(const Vec3d& p, double u, double v) const {
    const double height = dot(p - middle_, normal_);
    if (!(height > 0)) return {};
    const SphericalRectangle seen(middle_, u_, v_, p);
    if (!(seen.solid_angle() > 0)) return {};
    const Vec3d direction = seen.sample(u, v);
    return {direction, -height / dot(direction, normal_), radiance_, seen.pdf(), false};
  }
  double pdf(const Vec3d& p, const Vec3d& direction) const {
    if (!(dot(p - middle_, normal_) > 0)) return 0;
    const SphericalRectangle seen(middle_, u_, v_, p);
    return seen.contains(direction) ? seen.pdf() : 0;
  }
  Vec3d power() const { return radiance_ * (std::numbers::pi * 4 * length(cross(u_, v_))); }

 private:
  Vec3d middle_, u_, v_, radiance_, normal_;
};
static_assert(AnyLight<RectangleLight>);

}  // namespace treeline::shading::light
