// Rays to points of the light, through our wide tree.
#include "bench/shadow/area_rays.hpp"

#include "accel/bvh/wide_triangles.hpp"

namespace treeline::bench::shadow {
namespace {

using Tree = accel::Bvh<accel::Triangles<float, geometry::Watertight>, accel::Wide>;

[[maybe_unused]] const bool registered = Registry<Method>::instance().add(
    {.info = {.name = "area_rays",
              .family = "bvh",
              .claim = Claim::stochastic,
              .query_knobs = area_ray_knobs(true),
              .ladder = 50},
     .build = [](const Input& input, const Knobs&) -> std::unique_ptr<ShadowSubject> {
       return std::make_unique<AreaRaySubject<Tree>>(input, [](const geometry::Mesh3f& mesh, int threads) {
         Tree::Options o;
         o.non_finite = accel::NonFinite::drop, o.threads = threads;
         return std::make_unique<Tree>(mesh, o);
       });
     }});

}  // namespace
}  // namespace treeline::bench::shadow
