// Cones marched through samples of the distance to the scene.
#include "shading/shadow/distance_field_shadow.hpp"

#include "accel/bvh/wide_triangles.hpp"
#include "bench/core/registry.hpp"
#include "bench/shadow/method.hpp"

namespace treeline::bench::shadow {
namespace {

using namespace shading::shadow;
using Tree = accel::Bvh<accel::Triangles<float, geometry::Watertight>, accel::Wide>;
using Samples = accel::field::DenseSamples;

class FieldCones final : public ShadowSubject {
 public:
  FieldCones(const Input& input, int resolution)
      : light_(input.scene.light), samples_(sampled(input, resolution)) {}

  void visibility(std::span<const Receiver> receivers, const Knobs& knobs, int threads,
                  std::span<float> out) override {
    const accel::field::Trilinear field(samples_);
    FieldShadowOptions o = field_shadow_options(field);
    const std::string form = knobs.at("form").get<std::string>();
    o.form = form == "one_sided"   ? FieldShadowForm::one_sided
             : form == "clamped"   ? FieldShadowForm::clamped
             : form == "two_sided" ? FieldShadowForm::two_sided
                                   : FieldShadowForm::disc;
    o.cone_step = knobs.value("cone_step", o.cone_step);
    if (knobs.value("aaltonen", false)) o.nearest = NearestThing::between;
    o.guard = knobs.value("guard", true);
    if (o.form == FieldShadowForm::clamped) o.min_radius = o.start, o.max_steps = 64;
    shade(DistanceFieldShadow(field, light_, o), receivers, threads, out);
  }
  Knobs facts() const override {
    return {{"shadow_closed", samples_.report().closed}, {"shadow_cell", samples_.lattice().spacing}};
  }

 private:
  /// Known everywhere: cones are wider than a band around the surface.
  static Samples sampled(const Input& input, int resolution) {
    Tree::Options how;
    how.non_finite = accel::NonFinite::drop, how.threads = input.threads;
    const Tree tree(input.scene.mesh, how);
    accel::field::FieldOptions o;
    o.resolution = resolution, o.band = INFINITY, o.threads = input.threads;
    o.support = accel::field::Support::trilinear;
    return accel::field::sample_mesh<Samples>(input.scene.mesh, tree, o);
  }

  shading::Light light_;
  Samples samples_;
};

std::vector<Knobs> forms() {
  std::vector<Knobs> all;
  for (const char* form : {"disc", "one_sided", "two_sided", "clamped"}) all.push_back({{"form", form}});
  all.push_back({{"form", "disc"}, {"cone_step", 1}});
  all.push_back({{"form", "disc"}, {"cone_step", 0.1}});
  all.push_back({{"form", "one_sided"}, {"aaltonen", true}});
  all.push_back({{"form", "disc"}, {"aaltonen", true}});
  all.push_back({{"form", "disc"}, {"aaltonen", true}, {"guard", false}});
  return all;
}

[[maybe_unused]] const bool registered = Registry<Method>::instance().add(
    {.info = {.name = "distance_field",
              .family = "field",
              .claim = Claim::approximate,
              .build_knobs =
                  {{{"resolution", 64}}, {{"resolution", 128}}, {{"resolution", 32}}, {{"resolution", 256}}},
              .query_knobs = forms(),
              .ladder = 20,
              .quick_builds = 3,
              .quick_largest_n = 50'000},
     .build = [](const Input& input, const Knobs& knobs) -> std::unique_ptr<ShadowSubject> {
       return std::make_unique<FieldCones>(input, knobs.at("resolution").get<int>());
     }});

}  // namespace
}  // namespace treeline::bench::shadow
