// One pyramid, looked up with ever more texels: a square, a square of a better level, a grid of probes,
// probes along the longer axis.
#include "bench/region_average/own_averager.hpp"
#include "shading/texture/anisotropic.hpp"

namespace treeline::bench::region_average {
namespace {

namespace texture = shading::texture;

/// look(chain, knobs) is what answers.
template <class Look>
class OnMips final : public Averager {
 public:
  explicit OnMips(const Input& input)
      : chain_(std::make_shared<texture::MipChain>(input.image, input.threads)) {}

  void means(std::span<const Footprint> footprints, const Knobs& knobs, int threads,
             std::span<float> out) const override {
    texture::means(Look::at(chain_, knobs), footprints, out, threads);
  }
  void rebuild(const Image& image, int threads) override { chain_->rebuild(image, threads); }

 private:
  std::shared_ptr<texture::MipChain> chain_;
};

struct Square {
  static auto at(const std::shared_ptr<texture::MipChain>& c, const Knobs& k) {
    return texture::Trilinear(c, k.at("bias").get<double>());
  }
};
struct Grid {
  static auto at(const std::shared_ptr<texture::MipChain>& c, const Knobs& k) {
    return texture::MultiProbe(c, k.at("side").get<int>());
  }
};
struct Along {
  static auto at(const std::shared_ptr<texture::MipChain>& c, const Knobs& k) {
    return texture::Anisotropic(c, k.at("probes").get<int>());
  }
};

template <class Look>
bool add(const char* name, int ladder, std::vector<Knobs> knobs) {
  return Registry<Method>::instance().add(
      {.info = {.name = name,
                .family = "mip",
                .claim = Claim::approximate,
                .query_knobs = std::move(knobs),
                .ladder = ladder},
       .build = [](const Input& input, const Knobs&) -> std::unique_ptr<Averager> {
         return std::make_unique<OnMips<Look>>(input);
       }});
}

[[maybe_unused]] const bool square =
    add<Square>("mip_square", 1, {{{"bias", 0}}, {{"bias", -0.5}}, {{"bias", texture::best_bias}}});
[[maybe_unused]] const bool grid = add<Grid>("mip_probes", 2, {{{"side", 2}}, {{"side", 4}}});
[[maybe_unused]] const bool along = add<Along>("mip_anisotropic", 3, {{{"probes", 4}}, {{"probes", 16}}});

}  // namespace
}  // namespace treeline::bench::region_average
