// Rays in the scalar of the index that they are cast into.
#pragma once

#include <concepts>

#include "accel/concepts.hpp"
#include "geometry/ray.hpp"

namespace treeline::shading::transport {

template <class Ray>
Ray cast_ray(const geometry::Rayf& r) {
  if constexpr (std::same_as<Ray, geometry::Rayf>) return r;
  using T = decltype(Ray::t_min);
  using Point = geometry::Vec<T, 3>;
  return {Point(r.origin), Point(r.direction), T(r.t_min), T(r.t_max)};
}

}  // namespace treeline::shading::transport
