// A BRDF pair by pair and sample by sample, as textbooks write it: the half vector of unit length, tangents
// of angles by division, D and G each by its formula, and visible normals after Heitz 2018 with a frame
// around the view and the library's sine and cosine. What the others' speed is measured by.
//
// Isotropic GGX and Beckmann whose facets reflect all; other surfaces are Unsupported.
#include <cmath>
#include <numbers>

#include "bench/brdf_integral/method.hpp"
#include "bench/core/registry.hpp"

namespace treeline::bench::brdf_integral {
namespace {

using geometry::Vec3f;
using shading::Distribution;
using shading::Masking;

constexpr float pi = std::numbers::pi_v<float>;

class Textbook final : public Answerer {
 public:
  explicit Textbook(const Input& input)
      : material_(input.material), alpha_(static_cast<float>(input.material.alpha_x)) {
    const Material& m = input.material;
    if (m.kind != shading::SurfaceKind::microfacet || m.alpha_x != m.alpha_y ||
        m.fresnel != shading::FresnelKind::one || m.compensation != shading::Compensation::none)
      throw Unsupported("written for isotropic facets that reflect all");
  }

  void answer(const Set& set, const Knobs&, int, std::span<float> out) override {
    const auto at = [](const Directions& d, std::size_t i) { return Vec3f{d.x[i], d.y[i], d.z[i]}; };
    if (!set.samples) {
      for (std::size_t i = 0; i < out.size(); ++i) out[i] = eval(at(set.wi, i), at(set.wo, i));
      return;
    }
    if (material_.distribution != Distribution::ggx) throw Unsupported("samples GGX only");
    directions_.resize(out.size()), densities_.resize(out.size());
    for (std::size_t i = 0; i < out.size(); ++i)
      out[i] = sample(at(set.wo, i), set.u[i], set.v[i], directions_[i], densities_[i]);
  }

 private:
  float tangent2(const Vec3f& w) const { return (1 - w[2] * w[2]) / (w[2] * w[2]); }
  float d(const Vec3f& h) const {
    const float c2 = h[2] * h[2], a2 = alpha_ * alpha_;
    if (material_.distribution == Distribution::ggx) {
      const float x = c2 * (a2 - 1) + 1;
      return a2 / (pi * x * x);
    }
    return std::exp(-tangent2(h) / a2) / (pi * a2 * c2 * c2);
  }
  float lambda(const Vec3f& w) const {
    if (material_.distribution == Distribution::ggx)
      return 0.5f * (std::sqrt(1 + alpha_ * alpha_ * tangent2(w)) - 1);
    const float a = 1 / (alpha_ * std::sqrt(tangent2(w)));
    return 0.5f * (std::erf(a) - 1) + std::exp(-a * a) * std::numbers::inv_sqrtpi_v<float> / (2 * a);
  }
  float g(const Vec3f& wi, const Vec3f& wo) const {
    const float li = lambda(wi), lo = lambda(wo);
    return material_.masking == Masking::correlated ? 1 / (1 + li + lo) : 1 / ((1 + li) * (1 + lo));
  }
  float eval(const Vec3f& wi, const Vec3f& wo) const {
    if (!(wi[2] > 0 && wo[2] > 0)) return 0;
    const Vec3f h = normalized(wi + wo);
    return d(h) * g(wi, wo) / (4 * wi[2] * wo[2]);
  }

  /// The weight f cos / pdf.
  float sample(const Vec3f& wo, float u, float v, Vec3f& wi, float& pdf) const {
    const Vec3f w = normalized(Vec3f{alpha_ * wo[0], alpha_ * wo[1], wo[2]});
    const float across2 = w[0] * w[0] + w[1] * w[1];
    const Vec3f t1 = across2 > 0 ? Vec3f{-w[1], w[0], 0} / std::sqrt(across2) : Vec3f{1, 0, 0};
    const Vec3f t2 = cross(w, t1);
    const float r = std::sqrt(u), angle = 2 * pi * v, s = 0.5f * (1 + w[2]);
    const float p1 = r * std::cos(angle);
    const float p2 = (1 - s) * std::sqrt(std::max(0.0f, 1 - p1 * p1)) + s * r * std::sin(angle);
    const Vec3f n = t1 * p1 + t2 * p2 + w * std::sqrt(std::max(0.0f, 1 - p1 * p1 - p2 * p2));
    const Vec3f h = normalized(Vec3f{alpha_ * n[0], alpha_ * n[1], std::max(0.0f, n[2])});
    wi = h * (2 * dot(wo, h)) - wo;
    if (!(wi[2] > 0)) return pdf = 0;
    const float g1 = 1 / (1 + lambda(wo));
    pdf = g1 * d(h) / (4 * wo[2]);
    return g(wi, wo) / g1;
  }

  Material material_;
  float alpha_;
  std::vector<Vec3f> directions_;
  std::vector<float> densities_;
};

[[maybe_unused]] const bool registered = Registry<Method>::instance().add(
    {.info = {.name = "scalar_textbook", .family = "kernel", .claim = Claim::approximate, .scales = false},
     .asks = Asks::kernels,
     .build = [](const Input& input, const Knobs&) -> std::unique_ptr<Answerer> {
       return std::make_unique<Textbook>(input);
     }});

}  // namespace
}  // namespace treeline::bench::brdf_integral
