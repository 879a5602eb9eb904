// Maps drawn by the rasteriser, and by casting rays through a wide tree.
#include "accel/bvh.hpp"
#include "bench/shadow/redrawn.hpp"
#include "shading/raster/cast_depth.hpp"

namespace treeline::bench::shadow {
namespace {

namespace raster = shading::raster;
using Tree = accel::Bvh<accel::Triangles<float>, accel::Wide>;

std::unique_ptr<ShadowSubject> build(const Input& input, const Knobs& knobs) {
  if (knobs.at("drawn") == "raster")
    return redrawn(input, [&mesh = input.scene.mesh, scratch = raster::DepthScratch()](
                              const LightView& view, int side, int threads, DepthMap& map) mutable {
      raster::rasterise_depth(mesh, view, side, side, map, scratch, {.threads = threads});
    });
  Tree::Options options;
  options.non_finite = accel::NonFinite::drop, options.threads = input.threads;
  return redrawn(input, [tree = std::make_unique<Tree>(input.scene.mesh, options),
                         scratch = raster::CastScratch<float>()](const LightView& view, int side, int threads,
                                                                 DepthMap& map) mutable {
    raster::cast_depth(*tree, view, side, side, map, scratch, {.threads = threads});
  });
}

[[maybe_unused]] const bool registered = Registry<Method>::instance().add(
    {.info = {.name = "redrawn_map",
              .family = "map",
              .claim = Claim::approximate,
              .build_knobs = {Knobs{{"drawn", "raster"}}, Knobs{{"drawn", "rays"}}},
              .query_knobs = redrawn_resolutions(),
              .ladder = 2,
              .quick_builds = 1,
              .scales = false},
     .build = build});

}  // namespace
}  // namespace treeline::bench::shadow
