// How far from its surface a shadow query starts, so that the surface does not shade itself.
//
// Problem: the place of a receiver is rounded, and so is what a ray test knows of a triangle; started on the
// surface, some half of all rays hit it. Method: start above it by more than all of these errors together
// (tolerance::shadow_offset, with its derivation). Known weakness: what is nearer to a receiver than that
// casts no shadow on it; for float and a scene of 10 m that is 0.08 mm.
#pragma once

#include "geometry/tolerances.hpp"
#include "shading/shadow/light_view.hpp"

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

}  // namespace treeline::shading::shadow
