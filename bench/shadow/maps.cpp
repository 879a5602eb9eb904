#include "bench/shadow/maps.hpp"

#include "shading/raster/rasterise_depth.hpp"

namespace treeline::bench::shadow {

LightView whole_view(const shading::Scene& scene) {
  const auto box = scene.mesh.box();
  return shading::shadow::fit_view(scene.light,
                                   geometry::Box3d{geometry::Vec3d(box.low), geometry::Vec3d(box.high)});
}

DepthMap depth_map(const Input& input, const LightView& view, int resolution, bool second) {
  return shading::raster::rasterise_depth(input.scene.mesh, view, resolution, resolution,
                                          {.layers = second ? 2 : 1, .threads = input.threads});
}

}  // namespace treeline::bench::shadow
