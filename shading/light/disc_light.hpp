// A disc that emits from one side, sampled evenly over its solid angle.
#pragma once

#include "shading/light/light.hpp"
#include "shading/light/spherical_ellipse.hpp"

namespace treeline::shading::light {

class DiscLight {
 public:
  /// Light leaves on the side of the normal, which may be of any length. radiance: W / (m² sr). Throws
  /// InvalidLight for a middle that is not finite, a normal that is zero or not finite, a radius that is not
  /// finite and above 0, and a radiance that is negative or not finite.
  DiscLight(const Vec3d& middle, const Vec3d& normal, double radius, const Vec3d& radiance)
      : middle_(middle),
        normal_(detail::unit(normal, "disc light", "normal")),
        radiance_(radiance),
        radius_(radius) {
    detail::check_finite(middle, "disc light", "middle");
    detail::check_positive(radius, "disc light", "radius");
    detail::check_colour(radiance, "disc light", "radiance");
  }

  /// Nothing from behind it, or from its plane.
  LightSample sample(const Vec3d& p, double u, double v) const {
    const double height = dot(p - middle_, normal_);
    if (!(height > 0)) return {};
    const SphericalEllipse seen(middle_, normal_, radius_, p);
    if (!(seen.solid_angle() > 0)) return {};
    const Vec3d direction = seen.sample(u, v);
    return {direction, -height / dot(direction, normal_), radiance_, seen.pdf(), false};
  }
  double pdf(const Vec3d& p, const Vec3d& direction) const {
    if (!(dot(p - middle_, normal_) > 0)) return 0;
    const SphericalEllipse seen(middle_, normal_, radius_, p);
    return seen.contains(direction) ? seen.pdf() : 0;
  }
  Vec3d power() const { return radiance_ * (std::numbers::pi * std::numbers::pi * radius_ * radius_); }

 private:
  Vec3d middle_, normal_, radiance_;
  double radius_;
};
static_assert(AnyLight<DiscLight>);

}  // namespace treeline::shading::light
