// Light from all around a surface, in its own frame: what its reflection is integrated under.
#pragma once

#include <cmath>
#include <numbers>

#include "geometry/vec.hpp"

namespace treeline::bench::brdf_integral {

/// constant: 1 everywhere. cosine: that of the angle to the normal. both: their sum. cap: `radiance` within a
/// cone, else dark.
enum class SkyKind { constant, cosine, both, cap };

struct Sky {
  SkyKind kind = SkyKind::constant;
  geometry::Vec3d axis{0, 0, 1};  ///< of the cone, a unit vector
  double cosine = 1;              ///< of half its angle
  double radiance = 1;

  double solid_angle() const { return 2 * std::numbers::pi * (1 - cosine); }
  /// Towards w, above the surface.
  double operator()(const geometry::Vec3d& w) const {
    switch (kind) {
      case SkyKind::constant:
        return 1;
      case SkyKind::cosine:
        return w[2];
      case SkyKind::both:
        return 1 + w[2];
      case SkyKind::cap:
        break;
    }
    return dot(w, axis) >= cosine ? radiance : 0;
  }
};

}  // namespace treeline::bench::brdf_integral
