// Scenes and views for the tests of the rasteriser.
#pragma once

#include <string>

#include "datasets_gen/scenes/scene.hpp"
#include "shading/raster/rasterise_depth.hpp"

namespace treeline::shading::raster::test {

using geometry::Mesh3f;
using shadow::DepthMap;
using shadow::LightView;

inline geometry::Box3d box_of(const Mesh3f& mesh) {
  geometry::Box3d box;
  for (const auto& p : mesh.vertices)
    if (is_finite(p)) box.grow(Vec3d(p));
  return box;
}

/// The mesh from above at an angle: as the sun sees it, or from a point two diameters away.
inline LightView view_of(const Mesh3f& mesh, bool perspective) {
  const geometry::Box3d box = box_of(mesh);
  Light light;
  light.direction = normalized(Vec3d{-0.41, -0.8, 0.27});
  if (perspective)
    light.kind = LightKind::point,
    light.position = box.centre() - light.direction * (2 * length(box.extent()));
  return shadow::fit_view(light, box);
}

inline DepthMap draw(const Mesh3f& mesh, const LightView& view, int side, const DepthOptions& options = {}) {
  return rasterise_depth(mesh, view, side, side, options);
}

}  // namespace treeline::shading::raster::test
