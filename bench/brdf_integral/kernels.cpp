// The library's BRDF, pair by pair and sample by sample.
#include "bench/brdf_integral/method.hpp"
#include "bench/core/registry.hpp"
#include "shading/brdf/bsdf.hpp"

namespace treeline::bench::brdf_integral {
namespace {

class Scalar final : public Answerer {
 public:
  explicit Scalar(const Input& input) : bsdf_(input.material) {}

  void answer(const Set& set, const Knobs&, int, std::span<float> out) override {
    const auto at = [](const Directions& d, std::size_t i) {
      return geometry::Vec3f{d.x[i], d.y[i], d.z[i]};
    };
    if (!set.samples) {
      for (std::size_t i = 0; i < out.size(); ++i) out[i] = bsdf_.eval(at(set.wi, i), at(set.wo, i))[1];
      return;
    }
    // Which lobe: as good as a third number, and as cheap for everyone. Directions and densities are kept, as
    // whoever samples needs them.
    wi_.resize(out.size()), pdf_.resize(out.size());
    for (std::size_t i = 0; i < out.size(); ++i) {
      const float choice = static_cast<float>(i * 0x9e3779b9u & 0xffffffu) * 0x1p-24f;
      const auto s = bsdf_.sample(at(set.wo, i), choice, set.u[i], set.v[i]);
      wi_[i] = s.wi, pdf_[i] = s.pdf, out[i] = s.weight[1];
    }
  }

 private:
  shading::brdf::Bsdf<float> bsdf_;
  std::vector<geometry::Vec3f> wi_;
  std::vector<float> pdf_;
};

[[maybe_unused]] const bool registered = Registry<Method>::instance().add(
    {.info = {.name = "scalar", .family = "kernel", .claim = Claim::bounded, .ladder = 1, .scales = false},
     .asks = Asks::kernels,
     .allowed = 1e-3,
     .build = [](const Input& input, const Knobs&) -> std::unique_ptr<Answerer> {
       return std::make_unique<Scalar>(input);
     }});

}  // namespace
}  // namespace treeline::bench::brdf_integral
