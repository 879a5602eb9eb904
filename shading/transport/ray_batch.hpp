// Batches of rays for any index: how they go is said to those that ask for it.
#pragma once

#include <span>

#include "accel/bvh/wide_triangles.hpp"
#include "accel/concepts.hpp"

namespace treeline::shading::transport {

/// In the index's scalar.
template <class Ray>
Ray cast_ray(const geometry::Rayf& r) {
  if constexpr (std::same_as<Ray, geometry::Rayf>) return r;
  using T = decltype(Ray::t_min);
  using Point = geometry::Vec<T, 3>;
  return {Point(r.origin), Point(r.direction), T(r.t_min), T(r.t_max)};
}

template <accel::RayIndex Index>
void closest_hits(const Index& index, std::span<const typename Index::Ray> rays,
                  std::span<accel::Hit<typename Index::Scalar>> hits, accel::RayBatch how) {
  if constexpr (requires { index.closest_hit(rays, hits, 1, how); })
    index.closest_hit(rays, hits, 1, how);
  else
    index.closest_hit(rays, hits, 1);
}

template <accel::RayIndex Index>
void any_hits(const Index& index, std::span<const typename Index::Ray> rays, std::span<std::uint8_t> hidden,
              accel::RayBatch how) {
  if constexpr (requires { index.any_hit(rays, hidden, 1, how); })
    index.any_hit(rays, hidden, 1, how);
  else
    index.any_hit(rays, hidden, 1);
}

}  // namespace treeline::shading::transport
