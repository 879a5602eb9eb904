// A ball that emits from its outside, sampled evenly over the cap that it subtends.
#pragma once

#include "shading/light/light.hpp"
#include "shading/light/spherical_cap.hpp"

namespace treeline::shading::light {

class SphereLight {
 public:
  /// radiance: W / (m² sr). Throws InvalidLight for a middle that is not finite, a radius that is not finite
  /// and above 0, and a radiance that is negative or not finite.
  SphereLight(const Vec3d& middle, double radius, const Vec3d& radiance)
      : middle_(middle), radiance_(radiance), radius_(radius) {
    detail::check_finite(middle, "sphere light", "middle");
    detail::check_positive(radius, "sphere light", "radius");
    detail::check_colour(radiance, "sphere light", "radiance");
  }

  /// Nothing from within it, or from its surface.
  LightSample sample(const Vec3d& p, double u, double v) const {
    const Vec3d to = middle_ - p;
    const double d = length(to), beyond = (d - radius_) * (d + radius_);
    if (!(d > radius_ && beyond > 0)) return {};
    const SphericalCap seen(middle_, radius_, p);
    const Vec3d direction = seen.sample(u, v);
    // The nearer root, as the product of both over the farther one; the ray's distance from the middle.
    const double along = dot(direction, to), off = length2(to - direction * along);
    const double farther = along + std::sqrt(std::max(0.0, radius_ * radius_ - off));
    return {direction, beyond / farther, radiance_, seen.pdf(), false};
  }
  double pdf(const Vec3d& p, const Vec3d& direction) const {
    if (!(distance(p, middle_) > radius_)) return 0;
    const SphericalCap seen(middle_, radius_, p);
    return seen.contains(direction) ? seen.pdf() : 0;
  }
  Vec3d power() const { return radiance_ * (4 * std::numbers::pi * std::numbers::pi * radius_ * radius_); }

 private:
  Vec3d middle_, radiance_;
  double radius_;
};
static_assert(AnyLight<SphereLight>);

}  // namespace treeline::shading::light
