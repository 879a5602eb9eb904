// Mean and variance of depths that exponentials have warped: one warp, and both.
#include "shading/shadow/evsm.hpp"

#include "bench/shadow/blurs.hpp"
#include "bench/shadow/maps.hpp"

namespace treeline::bench::shadow {
namespace {

using namespace shading::shadow;

template <int K>
bool add(const char* name, int ladder) {
  // 40 and 5 are the usual exponents in float, 5.54 the most that half precision can hold.
  return Registry<Method>::instance().add(
      {.info = {.name = name,
                .family = "map",
                .claim = Claim::approximate,
                .build_knobs = product(
                    blurs(), {{{"positive", 40}, {"negative", 5}}, {{"positive", 5.54}, {"negative", 3}}}),
                .query_knobs = {{{"cut", 0}}, {{"cut", 0.1}}, {{"cut", 0}, {"bias", 1}}},
                .ladder = ladder,
                .quick_builds = 2},
       .build = [](const Input& input, const Knobs& knobs) {
         const Exponents c{knobs.at("positive").get<double>(), knobs.at("negative").get<double>()};
         return map_subject(input, make_warped_map<K>(depth_map(input, knobs), c, blur_of(input, knobs)),
                            [](const WarpedMap<K>& map, const shading::Scene&, const Knobs& q) {
                              return Evsm<K>(map,
                                             {.leak_cut = q.at("cut").get<double>(), .bias = bias_of(q)});
                            });
       }});
}

[[maybe_unused]] const bool registered[] = {add<2>("evsm2", 7), add<4>("evsm4", 9)};

}  // namespace
}  // namespace treeline::bench::shadow
