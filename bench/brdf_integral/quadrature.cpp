// Sums over fixed nodes: of directions, of facets' normals, and the latter as if no facet were ever in the
// way of another.
#include "bench/brdf_integral/rules.hpp"
#include "bench/brdf_integral/share.hpp"
#include "bench/core/registry.hpp"

namespace treeline::bench::brdf_integral {
namespace {

enum class Over { directions, facets, unmasked_facets };

template <Over over>
class Quadrature final : public Answerer {
 public:
  explicit Quadrature(const Input& input) : f_(input.material, over != Over::unmasked_facets) {
    if (over == Over::unmasked_facets && (input.material.kind != shading::SurfaceKind::microfacet ||
                                          input.material.compensation != shading::Compensation::none))
      throw Unsupported("there is no masking to be left out");
  }

  void answer(const Set& set, const Knobs& knobs, int threads, std::span<float> out) override {
    const int nodes = knobs.at("nodes").get<int>();
    const bool light = set.sky.kind == SkyKind::cap;
    if (light && over != Over::directions)
      throw Unsupported("no rule over facets knows where the light ends");
    const auto reflect = [&](const Vec3d& wo) {
      return over == Over::directions ? over_directions(f_, wo, set.sky, nodes)
                                      : over_facets(f_, wo, set.sky, nodes);
    };
    share(set.queries(), threads, [&](std::size_t q) {
      const Vec3d r = set.averages > 0 ? over_viewers(f_.material(), reflect) : reflect(set.views[q]);
      for (int c = 0; c < 3; ++c) out[3 * q + std::size_t(c)] = static_cast<float>(r[c]);
    });
  }

 private:
  Integrand f_;
};

template <Over over>
bool add(const char* name, int ladder, std::vector<int> nodes) {
  std::vector<Knobs> knobs;
  for (const int n : nodes) knobs.push_back({{"nodes", n}});
  return Registry<Method>::instance().add(
      {.info = {.name = name,
                .family = "quadrature",
                .claim = Claim::approximate,
                .query_knobs = std::move(knobs),
                .ladder = ladder,
                .scales = false},
       .build = [](const Input& input, const Knobs&) -> std::unique_ptr<Answerer> {
         return std::make_unique<Quadrature<over>>(input);
       }});
}

[[maybe_unused]] const bool registered = add<Over::directions>("quadrature", 8, {4, 8, 16, 32}) &&
                                         add<Over::facets>("quadrature_facets", 8, {4, 8, 16, 32}) &&
                                         add<Over::unmasked_facets>("unmasked", 0, {16});

}  // namespace
}  // namespace treeline::bench::brdf_integral
