// One ray to the middle of the light: right for hard lights, and what a perfect shadow map would say of soft
// ones.
#include "accel/bvh.hpp"
#include "bench/core/registry.hpp"
#include "bench/shadow/lights.hpp"
#include "bench/shadow/method.hpp"
#include "bench/shadow/truth.hpp"
#include "shading/shadow/surface_offset.hpp"

namespace treeline::bench::shadow {
namespace {

using geometry::Vec3f;

class CentreRay final : public ShadowSubject {
 public:
  explicit CentreRay(const Input& input)
      : light_(input.scene.light),
        tree_(input.scene.mesh, options(input.threads)),
        offset_(ray_offset(input.scene)) {}

  void visibility(std::span<const Receiver> receivers, const Knobs&, int threads,
                  std::span<float> out) override {
    rays_.resize(receivers.size()), hit_.resize(receivers.size());
    for (std::size_t i = 0; i < receivers.size(); ++i) {
      const Receiver& r = receivers[i];
      const ToLight to = to_light(light_, r.position);
      const auto start = shading::shadow::shadow_start(r, to.direction, offset_);
      rays_[i] = {Vec3f(start.origin), Vec3f(to.direction), static_cast<float>(start.t_min)};
      if (to.distance < far_away) rays_[i].t_max = static_cast<float>(to.distance);
    }
    tree_.any_hit(std::span<const geometry::Rayf>(rays_), hit_, threads, accel::RayBatch::packets);
    for (std::size_t i = 0; i < receivers.size(); ++i) out[i] = hit_[i] ? 0.0f : 1.0f;
  }

 private:
  static Tree::Options options(int threads) {
    Tree::Options o;
    o.non_finite = accel::NonFinite::drop, o.threads = threads;
    return o;
  }

  shading::Light light_;
  Tree tree_;
  double offset_;
  std::vector<geometry::Rayf> rays_;
  std::vector<std::uint8_t> hit_;
};

[[maybe_unused]] const bool registered = Registry<Method>::instance().add(
    {.info = {.name = "centre_ray", .family = "bvh", .claim = Claim::bounded, .ladder = 40, .scales = false},
     .build = [](const Input& input, const Knobs&) -> std::unique_ptr<ShadowSubject> {
       return std::make_unique<CentreRay>(input);
     }});

}  // namespace
}  // namespace treeline::bench::shadow
