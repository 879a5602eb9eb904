// The library's BRDF on vector registers, all pairs or samples of a set in one call: without colours where
// all channels are the same.
#include <variant>

#include "bench/brdf_integral/method.hpp"
#include "bench/core/registry.hpp"
#include "shading/brdf/batch_bsdf.hpp"

namespace treeline::bench::brdf_integral {
namespace {

namespace brdf = shading::brdf;

/// Room for answers that the task does not ask for.
struct Scratch {
  std::vector<float> a[6];

  std::span<float> operator()(std::size_t i, std::size_t n) {
    if (a[i].size() < n) a[i].resize(n);
    return std::span(a[i]).first(n);
  }
};

class Batch final : public Answerer {
 public:
  explicit Batch(const Input& input) : lobe_(lobe_of(input.material)) {}

  void answer(const Set& set, const Knobs&, int, std::span<float> out) override {
    const auto in = [](const Directions& d) { return brdf::Directions{d.x, d.y, d.z}; };
    const std::size_t n = out.size();
    const auto scratch = [&](std::size_t i) { return scratch_(i, n); };
    const brdf::DirectionsOut wi{scratch(0), scratch(1), scratch(2)};
    const brdf::ColoursOut colours{scratch(3), out, scratch(4)};
    if (const auto* bsdf = std::get_if<brdf::BatchBsdf>(&lobe_)) {
      if (!set.samples) return bsdf->eval(in(set.wi), in(set.wo), colours);
      if (choice_.size() != n) {
        choice_.resize(n);
        for (std::size_t i = 0; i < n; ++i)
          choice_[i] = static_cast<float>(i * 0x9e3779b9u & 0xffffffu) * 0x1p-24f;
      }
      return bsdf->sample(in(set.wo), choice_, set.u, set.v, wi, colours, scratch(5));
    }
    const auto one_channel = [&](const auto& lobe) {
      if (!set.samples) return lobe.eval(in(set.wi), in(set.wo), out);
      lobe.sample(in(set.wo), set.u, set.v, wi, out, scratch(5));
    };
    if (const auto* ggx = std::get_if<brdf::BatchGgx>(&lobe_)) return one_channel(*ggx);
    one_channel(std::get<brdf::BatchBeckmann>(lobe_));
  }

 private:
  using Lobe = std::variant<brdf::BatchBsdf, brdf::BatchGgx, brdf::BatchBeckmann>;
  Lobe lobe_;
  std::vector<float> choice_;
  Scratch scratch_;

  static Lobe lobe_of(const Material& m) {
    if (m.kind != shading::SurfaceKind::microfacet || m.fresnel != shading::FresnelKind::one ||
        m.compensation != shading::Compensation::none)
      return brdf::BatchBsdf(m);
    if (m.distribution == shading::Distribution::ggx) return brdf::BatchGgx(m.alpha_x, m.alpha_y, m.masking);
    return brdf::BatchBeckmann(m.alpha_x, m.alpha_y, m.masking);
  }
};

[[maybe_unused]] const bool registered = Registry<Method>::instance().add(
    {.info = {.name = "batch", .family = "kernel", .claim = Claim::bounded, .ladder = 2, .scales = false},
     .asks = Asks::kernels,
     .allowed = 1e-3,
     .build = [](const Input& input, const Knobs&) -> std::unique_ptr<Answerer> {
       return std::make_unique<Batch>(input);
     }});

}  // namespace
}  // namespace treeline::bench::brdf_integral
