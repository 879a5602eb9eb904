// A light of no extent that shines the same in all directions. Its light falls off as 1 / r².
#pragma once

#include <numbers>

#include "shading/light/light.hpp"

namespace treeline::shading::light {

class PointLight {
 public:
  /// intensity: W / sr. Throws InvalidLight for a position that is not finite, or an intensity that is
  /// negative or not finite.
  PointLight(const Vec3d& position, const Vec3d& intensity) : position_(position), intensity_(intensity) {
    detail::check_finite(position, "point light", "position");
    detail::check_colour(intensity, "point light", "intensity");
  }

  /// Nothing where p is at the light.
  LightSample sample(const Vec3d& p, double, double) const {
    const Vec3d to = position_ - p;
    const double r = length(to);
    if (!(r > 0)) return {};
    return {to / r, r, intensity_ / (r * r), 1, true};
  }
  double pdf(const Vec3d&, const Vec3d&) const { return 0; }
  Vec3d power() const { return intensity_ * (4 * std::numbers::pi); }

 private:
  Vec3d position_, intensity_;
};
static_assert(AnyLight<PointLight>);

}  // namespace treeline::shading::light
