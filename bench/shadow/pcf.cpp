// Comparisons averaged over a square of texels, and over a disc of few taps. The radius of the square is in
// texels; a square of 2 radius + 1 has as many taps squared.
#include "shading/shadow/pcf.hpp"

#include "bench/shadow/maps.hpp"

namespace treeline::bench::shadow {
namespace {

using namespace shading::shadow;

std::vector<Knobs> squares() {
  std::vector<Knobs> r;
  for (const int radius : {1, 2, 4, 8, 16})
    r.push_back({{"radius", radius}, {"smooth", true}, {"plane", true}});
  for (const int radius : {1, 4}) r.push_back({{"radius", radius}, {"smooth", false}, {"plane", true}});
  for (const int radius : {1, 4}) r.push_back({{"radius", radius}, {"smooth", true}, {"bias", 1}});
  return r;
}
std::vector<Knobs> discs() {
  std::vector<Knobs> r;
  for (const int taps : {4, 16, 64})
    for (const int radius : {2, 8}) r.push_back({{"taps", taps}, {"radius", radius}, {"plane", true}});
  r.push_back({{"taps", 16}, {"radius", 8}, {"plane", true}, {"turned", false}});
  return r;
}

[[maybe_unused]] const bool square = Registry<Method>::instance().add(
    {.info = {.name = "pcf",
              .family = "map",
              .claim = Claim::approximate,
              .build_knobs = resolutions(),
              .query_knobs = squares(),
              .ladder = 4,
              .quick_builds = 2},
     .build = [](const Input& input, const Knobs& knobs) {
       return map_subject(
           input, depth_map(input, knobs), [](const DepthMap& map, const shading::Scene&, const Knobs& q) {
             return PcfGrid(map, {q.at("radius").get<int>(), q.at("smooth").get<bool>(), bias_of(q)});
           });
     }});

[[maybe_unused]] const bool disc = Registry<Method>::instance().add(
    {.info = {.name = "pcf_disc",
              .family = "map",
              .claim = Claim::approximate,
              .build_knobs = resolutions(),
              .query_knobs = discs(),
              .ladder = 3,
              .quick_builds = 2},
     .build = [](const Input& input, const Knobs& knobs) {
       return map_subject(input, depth_map(input, knobs),
                          [](const DepthMap& map, const shading::Scene&, const Knobs& q) {
                            return PcfDisc(map, {.taps = q.at("taps").get<int>(),
                                                 .radius = q.at("radius").get<double>(),
                                                 .turned = q.value("turned", true),
                                                 .bias = bias_of(q)});
                          });
     }});

}  // namespace
}  // namespace treeline::bench::shadow
