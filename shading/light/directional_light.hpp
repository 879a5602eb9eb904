// A light so far away that it comes from one direction everywhere, with one irradiance.
#pragma once

#include <numbers>

#include "shading/light/light.hpp"

namespace treeline::shading::light {

class DirectionalLight {
 public:
  /// direction: the way the light goes, of any length; irradiance: of surfaces across it, W / m²;
  /// scene_radius: of what it shines on, in metres, for its power alone. Throws InvalidLight for a direction
  /// that is zero or not finite, an irradiance that is negative or not finite, a radius that is not finite
  /// and above 0.
  DirectionalLight(const Vec3d& direction, const Vec3d& irradiance, double scene_radius)
      : towards_(-detail::unit(direction, "directional light", "direction")),
        irradiance_(irradiance),
        scene_radius_(scene_radius) {
    detail::check_colour(irradiance, "directional light", "irradiance");
    detail::check_positive(scene_radius, "directional light", "scene's radius");
  }

  LightSample sample(const Vec3d&, double, double) const {
    return {towards_, std::numeric_limits<double>::infinity(), irradiance_, 1, true};
  }
  double pdf(const Vec3d&, const Vec3d&) const { return 0; }
  /// That passes through the disc which hides the scene.
  Vec3d power() const { return irradiance_ * (std::numbers::pi * scene_radius_ * scene_radius_); }

 private:
  Vec3d towards_, irradiance_;
  double scene_radius_;
};
static_assert(AnyLight<DirectionalLight>);

}  // namespace treeline::shading::light
