// Soft shadows from sums over boxes; under each reading of what a mean behind the receiver says.
#include "shading/shadow/vssm.hpp"

#include "bench/shadow/maps.hpp"

namespace treeline::bench::shadow {
namespace {

using namespace shading::shadow;

struct Tables {
  DepthMap map;
  VarianceSums sums;
  DepthPyramid pyramid;
  explicit Tables(DepthMap m) : map(std::move(m)), sums(map), pyramid(map) {}
};

BelowMean below_mean(const std::string& name) {
  return name == "lit" ? BelowMean::lit : name == "formula" ? BelowMean::formula : BelowMean::cut;
}

[[maybe_unused]] const bool registered = Registry<Method>::instance().add(
    {.info = {.name = "vssm",
              .family = "map",
              .claim = Claim::approximate,
              .build_knobs = resolutions(),
              .query_knobs = {{{"below_mean", "cut"}, {"parts", 4}, {"early", true}},
                              {{"below_mean", "lit"}, {"parts", 1}, {"early", true}},
                              {{"below_mean", "lit"}, {"parts", 1}, {"early", false}},
                              {{"below_mean", "formula"}, {"parts", 1}, {"early", false}, {"clamped", false}},
                              {{"below_mean", "cut"}, {"parts", 2}, {"early", true}},
                              {{"below_mean", "cut"}, {"parts", 8}, {"early", true}}},
              .ladder = 11,
              .quick_builds = 2},
     .build = [](const Input& input, const Knobs& knobs) {
       return map_subject(input, std::make_unique<Tables>(depth_map(input, knobs)),
                          [](const std::unique_ptr<Tables>& t, const shading::Scene& scene, const Knobs& q) {
                            return Vssm(t->map, t->sums, &t->pyramid, scene.light,
                                        {.below_mean = below_mean(q.at("below_mean").get<std::string>()),
                                         .parts = q.at("parts").get<int>(),
                                         .early = q.at("early").get<bool>(),
                                         .clamped = q.value("clamped", true)});
                          });
     }});

}  // namespace
}  // namespace treeline::bench::shadow
