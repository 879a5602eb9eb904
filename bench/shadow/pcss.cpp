// Filters as wide as the penumbra of the blockers' mean depth; and the same with the width taken for a
// radius.
#include "shading/shadow/pcss.hpp"

#include "bench/shadow/maps.hpp"

namespace treeline::bench::shadow {
namespace {

using namespace shading::shadow;

std::vector<Knobs> taps_of_both() {
  std::vector<Knobs> r;
  for (const auto& [search, filter] :
       {std::pair{16, 32}, {4, 8}, {8, 16}, {16, 16}, {32, 64}, {64, 128}, {128, 256}})
    r.push_back({{"search", search}, {"taps", filter}, {"plane", true}});
  r.push_back({{"search", 32}, {"taps", 64}, {"plane", true}, {"width", "whole"}});
  r.push_back({{"search", 32}, {"taps", 64}, {"bias", 1}});
  return r;
}

[[maybe_unused]] const bool registered = Registry<Method>::instance().add(
    {.info = {.name = "pcss",
              .family = "map",
              .claim = Claim::approximate,
              .build_knobs = resolutions(),
              .query_knobs = taps_of_both(),
              .ladder = 12,
              .quick_builds = 2},
     .build = [](const Input& input, const Knobs& knobs) {
       return map_subject(input, depth_map(input, knobs),
                          [](const DepthMap& map, const shading::Scene& scene, const Knobs& q) {
                            return Pcss(
                                map, scene.light,
                                {.search_taps = q.at("search").get<int>(),
                                 .filter_taps = q.at("taps").get<int>(),
                                 .width = q.value("width", "half") == "whole" ? Width::whole : Width::half,
                                 .bias = bias_of(q)});
                          });
     }});

}  // namespace
}  // namespace treeline::bench::shadow
