// Shadow volumes: z-fail, z-pass, and z-fail as textbooks have it and as hardware cuts it.
#include "shading/shadow/shadow_volumes.hpp"

#include "bench/core/registry.hpp"
#include "bench/shadow/method.hpp"

namespace treeline::bench::shadow {
namespace {

using namespace shading::shadow;

class Volumes final : public ShadowSubject {
 public:
  Volumes(const Input& input, const ShadowVolumeOptions& options) : volumes_(input.scene, options) {}

  /// One thread draws, whatever `threads` says.
  void visibility(std::span<const Receiver> receivers, const Knobs&, int, std::span<float> out) override {
    volumes_.visibility(receivers, out);
  }
  Knobs facts() const override {
    return {{"shadow_silhouette_edges", volumes_.silhouette_edges()}, {"shadow_faces", volumes_.faces()}};
  }

 private:
  ShadowVolumes volumes_;
};

ShadowVolumeOptions options_of(const Input& input, const Knobs& knobs) {
  ShadowVolumeOptions o;
  const std::string cut = knobs.value("cut", "");
  if (cut == "caps") o.volumes.back_caps = false;
  if (cut == "casters") o.volumes.casters = Casters::light_facing;
  if (cut == "far") {  // a far plane just behind the scene, as one would set it without volumes
    const auto& c = input.scene.camera;
    const auto ahead = normalized(c.target - c.position);
    o.far = 0;
    for (const auto& p : input.scene.mesh.vertices)
      if (is_finite(p)) o.far = std::max(o.far, dot(geometry::Vec3d(p) - c.position, ahead) * 1.01);
    if (!(o.far > 0)) throw shading::InvalidScene("the whole scene is behind the camera");
  }
  return o;
}

std::unique_ptr<ShadowSubject> fail(const Input& input, const Knobs& knobs) {
  return std::make_unique<Volumes>(input, options_of(input, knobs));
}
std::unique_ptr<ShadowSubject> pass(const Input& input, const Knobs&) {
  ShadowVolumeOptions o;
  o.test = VolumeTest::z_pass, o.volumes.front_caps = o.volumes.back_caps = false;
  return std::make_unique<Volumes>(input, o);
}

[[maybe_unused]] const bool registered =
    Registry<Method>::instance().add({.info = {.name = "shadow_volumes",
                                               .family = "volume",
                                               .claim = Claim::bounded,
                                               .ladder = 30,
                                               .scales = false},
                                      .build = fail}) &&
    Registry<Method>::instance().add({.info = {.name = "shadow_volumes_z_pass",
                                               .family = "volume",
                                               .claim = Claim::approximate,
                                               .ladder = 29,
                                               .scales = false},
                                      .build = pass}) &&
    Registry<Method>::instance().add(
        {.info = {.name = "shadow_volumes_cut",
                  .family = "volume",
                  .claim = Claim::approximate,
                  .build_knobs = {{{"cut", "far"}}, {{"cut", "caps"}}, {{"cut", "casters"}}},
                  .stress_builds = {0, 1, 2},
                  .ladder = 28,
                  .scales = false,
                  .hard_cases_only = true},
         .build = fail});

}  // namespace
}  // namespace treeline::bench::shadow
