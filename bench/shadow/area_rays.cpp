// Rays to points of the light, through our wide tree.
#include "bench/shadow/area_rays.hpp"

#include "accel/bvh/wide_triangles.hpp"

namespace treeline::bench::shadow {
namespace {

using Tree = accel::Bvh<accel::Triangles<float, geometry::Watertight>, accel::Wide>;

template <accel::RayBatch how>
std::unique_ptr<ShadowSubject> subject(const Input& input) {
  return std::make_unique<AreaRaySubject<Tree, how>>(input, [](const geometry::Mesh3f& mesh, int threads) {
    Tree::Options o;
    o.non_finite = accel::NonFinite::drop, o.threads = threads;
    return std::make_unique<Tree>(mesh, o);
  });
}

[[maybe_unused]] const bool registered = Registry<Method>::instance().add(
    {.info = {.name = "area_rays",
              .family = "bvh",
              .claim = Claim::stochastic,
              .build_knobs = {{{"batch", "packets"}}, {{"batch", "streams"}}, {{"batch", "singly"}}},
              .query_knobs = area_ray_knobs(true),
              .ladder = 50,
              .quick_builds = 1},
     .build = [](const Input& input, const Knobs& knobs) -> std::unique_ptr<ShadowSubject> {
       const auto batch = knobs.at("batch").get<std::string>();
       return batch == "packets"   ? subject<accel::RayBatch::packets>(input)
              : batch == "streams" ? subject<accel::RayBatch::streams>(input)
                                   : subject<accel::RayBatch::singly>(input);
     }});

}  // namespace
}  // namespace treeline::bench::shadow
