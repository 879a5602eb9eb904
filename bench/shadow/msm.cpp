// Four moments of depth, in float and in 16 bits.
#include "shading/shadow/msm.hpp"

#include "bench/shadow/blurs.hpp"
#include "bench/shadow/maps.hpp"

namespace treeline::bench::shadow {
namespace {

using namespace shading::shadow;

template <class Map>
std::unique_ptr<ShadowSubject> build(const Input& input, const Knobs& knobs) {
  MomentMap<4> moments = make_four_moment_map(depth_map(input, knobs), blur_of(input, knobs));
  const auto method_of = [](const Map& map, const shading::Scene&, const Knobs& q) {
    return Msm<Map>(
        map, {.alpha = q.at("alpha").get<double>(), .leak_cut = q.value("cut", 0.0), .bias = bias_of(q)});
  };
  if constexpr (std::same_as<Map, QuantisedMoments>)
    return map_subject(input, quantised(moments), method_of);
  else
    return map_subject(input, std::move(moments), method_of);
}

[[maybe_unused]] const bool in_float =
    Registry<Method>::instance().add({.info = {.name = "msm",
                                               .family = "map",
                                               .claim = Claim::approximate,
                                               .build_knobs = blurs(),
                                               .query_knobs = {{{"alpha", 3e-7}},
                                                               {{"alpha", 3e-6}},
                                                               {{"alpha", 6e-5}},
                                                               {{"alpha", 1e-3}},
                                                               {{"alpha", 3e-7}, {"cut", 0.1}},
                                                               {{"alpha", 3e-7}, {"bias", 1}}},
                                               .ladder = 10,
                                               .quick_builds = 2},
                                      .build = build<MomentMap<4>>});

[[maybe_unused]] const bool in_16_bits =
    Registry<Method>::instance().add({.info = {.name = "msm16",
                                               .family = "map",
                                               .claim = Claim::approximate,
                                               .build_knobs = blurs(),
                                               .query_knobs = {{{"alpha", 6e-5}},
                                                               {{"alpha", 1e-5}},
                                                               {{"alpha", 1e-3}},
                                                               {{"alpha", 6e-5}, {"cut", 0.1}},
                                                               {{"alpha", 6e-5}, {"bias", 1}}},
                                               .ladder = 8,
                                               .quick_builds = 2},
                                      .build = build<QuantisedMoments>});

}  // namespace
}  // namespace treeline::bench::shadow
