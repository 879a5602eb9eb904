// Rays through the pixels of a pinhole camera.
#pragma once

#include <cmath>
#include <numbers>

#include "geometry/ray.hpp"
#include "shading/scene.hpp"
#include "shading/transport/options.hpp"

namespace treeline::shading::transport {

class CameraRays {
 public:
  /// Throws InvalidScene for a camera without view: its place, axis, angle or size.
  explicit CameraRays(const Camera& c) : width_(static_cast<std::size_t>(c.width)) {
    const geometry::Vec3d forward = c.target - c.position, right = cross(forward, c.up);
    if (c.width < 1 || c.height < 1 || !is_finite(c.position) || !is_finite(right) ||
        !(length(forward) > 0) || !(length(right) > 0) ||
        !(c.height_angle > 0 && c.height_angle < std::numbers::pi))
      throw InvalidScene("the camera has no view: its place, axis, angle or size");
    origin_ = geometry::Vec3f(c.position);
    const geometry::Vec3d axis = normalized(forward), x = normalized(right), y = cross(axis, x);
    const double half = std::tan(c.height_angle / 2), pixel = 2 * half / c.height;
    right_ = geometry::Vec3f(x * pixel), down_ = geometry::Vec3f(y * pixel);
    corner_ = geometry::Vec3f(axis - x * (pixel * c.width / 2) - y * half);
  }

  /// Through the pixel, counted by rows from the top, at u of its width from the left and v of its height
  /// from the top; of unit length.
  geometry::Rayf operator()(std::size_t pixel, float u, float v) const {
    const float x = static_cast<float>(pixel % width_) + u, y = static_cast<float>(pixel / width_) + v;
    return {origin_, normalized(corner_ + right_ * x + down_ * y)};
  }

 private:
  std::size_t width_;
  geometry::Vec3f origin_, corner_, right_, down_;
};

}  // namespace treeline::shading::transport
