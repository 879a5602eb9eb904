// One comparison a receiver, under every kind of bias.
#include "shading/shadow/shadow_map.hpp"

#include "bench/shadow/maps.hpp"

namespace treeline::bench::shadow {
namespace {

using shading::shadow::ShadowMap;

[[maybe_unused]] const bool registered = Registry<Method>::instance().add(
    {.info = {.name = "shadow_map",
              .family = "map",
              .claim = Claim::approximate,
              .build_knobs = resolutions(),
              .query_knobs = {{{"bias", 1}},
                              {{"bias", 0}},
                              {{"constant", 0.005}},
                              {{"bias", 0.5}},
                              {{"bias", 2}},
                              {{"bias", 4}},
                              {{"constant", 0.0001}},
                              {{"constant", 0.0005}},
                              {{"constant", 0.05}},
                              {{"plane", true}},
                              {{"offset", 0.71}}},
              .ladder = 1,
              .quick_builds = 2},
     .build = [](const Input& input, const Knobs& knobs) {
       return map_subject(input, depth_map(input, knobs),
                          [](const DepthMap& map, const shading::Scene&, const Knobs& q) {
                            return ShadowMap(map, {bias_of(q)});
                          });
     }});

}  // namespace
}  // namespace treeline::bench::shadow
