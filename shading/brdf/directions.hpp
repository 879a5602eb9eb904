// Directions in a surface's own frame: z is the normal, both the direction towards the light and the one
// towards the viewer point away from the surface.
#pragma once

#include <cmath>
#include <concepts>

#include "geometry/vec.hpp"

namespace treeline::shading::brdf {

/// Of unit length. For float, to a few units in the last place.
template <std::floating_point T>
using Direction = geometry::Vec<T, 3>;

/// A share by channel: red, green, blue.
template <std::floating_point T>
using Colour = geometry::Vec<T, 3>;

/// Normal of the facet that reflects wo to wi. wi = -wo has none: NaN.
template <std::floating_point T>
Direction<T> half_vector(const Direction<T>& wi, const Direction<T>& wo) {
  return geometry::normalized(wi + wo);
}

/// wo mirrored at the normal h.
template <std::floating_point T>
Direction<T> reflected(const Direction<T>& wo, const Direction<T>& h) {
  return T(2) * geometry::dot(wo, h) * h - wo;
}

}  // namespace treeline::shading::brdf
