// Mean and variance of depth, blurred when the map is made.
#include "shading/shadow/vsm.hpp"

#include "bench/shadow/blurs.hpp"
#include "bench/shadow/maps.hpp"

namespace treeline::bench::shadow {
namespace {

using namespace shading::shadow;

[[maybe_unused]] const bool registered = Registry<Method>::instance().add(
    {.info = {.name = "vsm",
              .family = "map",
              .claim = Claim::approximate,
              .build_knobs = blurs(),
              .query_knobs =
                  {{{"cut", 0}}, {{"cut", 0.1}}, {{"cut", 0.25}}, {{"cut", 0.5}}, {{"cut", 0}, {"bias", 1}}},
              .ladder = 6,
              .quick_builds = 2},
     .build = [](const Input& input, const Knobs& knobs) {
       return map_subject(input, make_variance_map(depth_map(input, knobs), {blur_of(input, knobs)}),
                          [](const MomentMap<2>& map, const shading::Scene&, const Knobs& q) {
                            return Vsm(map, {.leak_cut = q.at("cut").get<double>(), .bias = bias_of(q)});
                          });
     }});

}  // namespace
}  // namespace treeline::bench::shadow
