// Maps of depths between the first two surfaces, which need no bias, or so it is said.
#include "shading/shadow/second_depth.hpp"

#include "bench/shadow/maps.hpp"
#include "shading/shadow/pcf.hpp"

namespace treeline::bench::shadow {
namespace {

using namespace shading::shadow;

template <SecondDepth kind>
bool add(const char* name) {
  return Registry<Method>::instance().add(
      {.info = {.name = name,
                .family = "map",
                .claim = Claim::approximate,
                .build_knobs = resolutions(),
                .query_knobs = {{{"radius", 0}, {"bias", 0}},
                                {{"radius", 0}, {"bias", 0.5}},
                                {{"radius", 1}, {"bias", 0}},
                                {{"radius", 3}, {"bias", 0}}},
                .ladder = 2,
                .quick_builds = 2},
       .build = [](const Input& input, const Knobs& knobs) {
         return map_subject(input, between_depths(depth_map(input, knobs, true), {kind}),
                            [](const DepthMap& map, const shading::Scene&, const Knobs& q) {
                              return PcfGrid(map, {q.at("radius").get<int>(), false, bias_of(q)});
                            });
       }});
}

[[maybe_unused]] const bool registered[] = {add<SecondDepth::midpoint>("midpoint"),
                                            add<SecondDepth::dual>("dual_depth"),
                                            add<SecondDepth::second>("second_depth")};

}  // namespace
}  // namespace treeline::bench::shadow
