// Comparisons as a product of exponentials, one factor of which is blurred.
#include "shading/shadow/esm.hpp"

#include "bench/shadow/blurs.hpp"
#include "bench/shadow/maps.hpp"

namespace treeline::bench::shadow {
namespace {

using namespace shading::shadow;

[[maybe_unused]] const bool registered = Registry<Method>::instance().add(
    {.info = {.name = "esm",
              .family = "map",
              .claim = Claim::approximate,
              .build_knobs = product(blurs(), {{{"exponent", 80}}, {{"exponent", 30}}}),
              .query_knobs = {{{"bias", 0}}, {{"bias", 1}}},
              .ladder = 5,
              .quick_builds = 2},
     .build = [](const Input& input, const Knobs& knobs) {
       return map_subject(input,
                          make_exponential_map(depth_map(input, knobs), knobs.at("exponent").get<double>(),
                                               blur_of(input, knobs)),
                          [](const ExponentialMap& map, const shading::Scene&, const Knobs& q) {
                            return Esm(map, {bias_of(q)});
                          });
     }});

}  // namespace
}  // namespace treeline::bench::shadow
