// How far from its surface a shadow query starts, so that the surface does not shade itself.
//
// Problem: the place of a receiver is rounded, and so is what a ray test knows of a triangle; started on the
// surface, some half of all rays hit it. Method: start above it by more than all of these errors together
// (tolerance::shadow_offset, with its derivation), where the ray itself is that high: one that is lifted
// there runs beside the one that is meant, and edges of shadows move (by 9 mm in a city of 1.2 km, a tenth of
// a penumbra). Only rays along the surface, which rise too slowly, are lifted. Known weakness: what is less
// than that above a receiver casts no shadow on it; for float and a scene of 10 m that is 0.08 mm.
#pragma once

#include "geometry/tolerances.hpp"
#include "shading/shadow/light_view.hpp"
#include "shading/shadow/method.hpp"

namespace treeline::shading::shadow {

/// In world units, for rays whose scalar is T.
template <class T>
double surface_offset(const Scene& scene) {
  geometry::Box3d box;
  for (const auto& p : scene.mesh.vertices)
    if (is_finite(p)) box.grow(Vec3d(p));
  if (box.empty()) throw InvalidScene("there is nothing that casts or receives shadows");
  box.grow(scene.camera.position);
  double reach = 0;
  for (int k = 0; k < 3; ++k)
    reach =
        std::max({reach, box.high[k] - box.low[k], std::abs(box.low[k]) / 16, std::abs(box.high[k]) / 16});
  return double(geometry::tolerance::shadow_offset<T>) * reach;
}

/// Where a ray from a receiver begins.
struct ShadowStart {
  Vec3d origin;
  double t_min;  // in lengths of its way
};

/// `offset` above the surface, on the way; lifted there where the way is less than 1/8 steep, or goes
/// down.
inline ShadowStart shadow_start(const Receiver& receiver, const Vec3d& way, double offset) {
  constexpr double least_sine = 1.0 / 8;
  const double rise = dot(way, receiver.normal);
  if (rise > 0 && rise * rise >= least_sine * least_sine * dot(way, way))
    return {receiver.position, offset / rise};
  return {receiver.position + receiver.normal * offset, 0};
}

}  // namespace treeline::shading::shadow
