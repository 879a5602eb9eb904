// Our sparse fields by other rules for the sign than their own (accel/signed_distance.hpp): what each rule
// makes of a mesh with holes, or of shells in one another. They promise nothing: a field's bounds hold for
// the sides that it was told.
#include "accel/signed_distance.hpp"
#include "bench/distance_field/sampled.hpp"

namespace treeline::bench::distance_field {
namespace {

using Samples = accel::field::BrickSamples;

template <class Rule>
Samples sampled_by(const Input& input, const Tree& tree) {
  const accel::field::SignBy<Rule, Tree> sign(input.mesh, tree, {}, input.threads);
  return accel::field::sample_mesh<Samples>(input.mesh, tree, sign,
                                            options_of(input, accel::field::Support::trilinear));
}

constexpr std::pair<const char*, Samples (*)(const Input&, const Tree&)> rules[] = {
    {"winding", sampled_by<accel::Winding>},
    {"first_hit", sampled_by<accel::FirstHit>},
    {"ray_parity", sampled_by<accel::RayParity>},
    {"pseudonormal", sampled_by<accel::Pseudonormal>}};

std::vector<Knobs> builds() {
  std::vector<Knobs> r;
  for (const int resolution : {128, 64, 32})
    for (const auto& [name, sample] : rules) r.push_back({{"resolution", resolution}, {"sign", name}});
  return r;
}

[[maybe_unused]] const bool registered = Registry<Method>::instance().add(
    {.info = {.name = "bricks_signs",
              .family = "field",
              .claim = Claim::approximate,
              .build_knobs = builds(),
              .stress_builds = {8, 9, 10, 11},
              .ladder = 3,
              .quick_builds = 4},
     .build = [](const Input& input, const Knobs& knobs) -> std::unique_ptr<Field> {
       const Tree tree = tree_of(input);
       for (const auto& [name, sample] : rules)
         if (knobs.at("sign") == name)
           return std::make_unique<Sampled<Samples, accel::field::Trilinear>>(sample(input, tree));
       throw std::invalid_argument(
           std::string("no rule for the sign is called ").append(knobs.at("sign").dump()));
     }});

}  // namespace
}  // namespace treeline::bench::distance_field
