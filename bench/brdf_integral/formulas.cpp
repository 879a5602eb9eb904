// Formulas beside those that textbooks offer in their place: Fresnel's beside Schlick's, solid angles beside
// area over distance squared, and what gives back the light that rough metals lose.
#include "bench/brdf_integral/rules.hpp"
#include "bench/brdf_integral/shape_truth.hpp"
#include "bench/core/registry.hpp"
#include "shading/brdf/fresnel.hpp"
#include "shading/light/solid_angle.hpp"
#include "shading/light/spherical_ellipse.hpp"

namespace treeline::bench::brdf_integral {
namespace {

namespace brdf = shading::brdf;

template <bool exact>
class Fresnel final : public Answerer {
 public:
  void answer(const Set& set, const Knobs&, int, std::span<float> out) override {
    const auto index = float(set.medium.index), extinction = float(set.medium.extinction);
    const float head_on = brdf::fresnel_conductor(1.0f, index, extinction);
    for (std::size_t i = 0; i < out.size(); ++i) {
      const auto c = float(set.cosines[i]);
      out[i] = !exact               ? brdf::fresnel_schlick(c, head_on)
               : extinction == 0.0f ? brdf::fresnel_dielectric(c, index)
                                    : brdf::fresnel_conductor(c, index, extinction);
    }
  }
};

double solid_angle(const Shape& s) {
  namespace light = shading::light;
  const Vec3d from{};
  switch (s.kind) {
    case ShapeKind::sphere:
      return light::ball_solid_angle(length(s.u), length(s.centre));
    case ShapeKind::disc:
      return light::disc_solid_angle(s.centre, normalized(cross(s.u, s.v)), length(s.u), from);
    case ShapeKind::triangle:
      return light::triangle_solid_angle({s.centre, s.centre + s.u, s.centre + s.v}, from);
    case ShapeKind::rectangle:
      return light::rectangle_solid_angle(s.centre, s.u, s.v, from);
    case ShapeKind::box:
      break;
  }
  return light::box_solid_angle({s.centre - s.u, s.centre + s.u}, from);
}

class SolidAngles final : public Answerer {
 public:
  void answer(const Set& set, const Knobs&, int, std::span<float> out) override {
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = float(solid_angle(set.shapes[i]));
  }
};

template <bool tilted>
class AreaOverR2 final : public Answerer {
 public:
  void answer(const Set& set, const Knobs&, int, std::span<float> out) override {
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = float(area_over_r2(set.shapes[i], tilted));
  }
};

/// All viewers of a rough metal, by quadrature of its BRDF with a compensation.
class Compensated final : public Answerer {
 public:
  explicit Compensated(shading::Compensation c) : compensation_(c) {}

  void answer(const Set& set, const Knobs&, int, std::span<float> out) override {
    Material m;
    m.kind = shading::SurfaceKind::microfacet;
    m.alpha_x = m.alpha_y = set.alpha;
    m.fresnel = shading::FresnelKind::schlick;
    m.reflectance = shading::Rgb::filled(float(set.reflectance));
    m.compensation = compensation_;
    const Integrand f(m, true);
    out[0] = float(over_viewers(m, [&](const Vec3d& wo) { return over_facets(f, wo, {}, 32); })[1]);
  }

 private:
  shading::Compensation compensation_;
};

template <class A>
bool add(const char* name, const char* family, Asks asks, Claim claim, double allowed, int ladder) {
  return Registry<Method>::instance().add(
      {.info = {.name = name, .family = family, .claim = claim, .ladder = ladder, .scales = false},
       .asks = asks,
       .allowed = allowed,
       .build = [](const Input&, const Knobs&) -> std::unique_ptr<Answerer> {
         return std::make_unique<A>();
       }});
}

constexpr std::pair<const char*, shading::Compensation> compensations[] = {
    {"none", shading::Compensation::none},
    {"kulla_conty", shading::Compensation::kulla_conty},
    {"textbook", shading::Compensation::kulla_conty_textbook},
    {"directional", shading::Compensation::kulla_conty_directional},
    {"turquin", shading::Compensation::turquin}};

bool add_compensated() {
  std::vector<Knobs> knobs;
  for (const auto& [name, kind] : compensations) knobs.push_back({{"compensation", name}});
  return Registry<Method>::instance().add(
      {.info = {.name = "compensated",
                .family = "kernel",
                .claim = Claim::approximate,
                .build_knobs = std::move(knobs),
                .scales = false},
       .asks = Asks::furnace,
       .build = [](const Input&, const Knobs& asked) -> std::unique_ptr<Answerer> {
         for (const auto& [name, kind] : compensations)
           if (asked.at("compensation") == name) return std::make_unique<Compensated>(kind);
         throw std::invalid_argument("no compensation is called so");
       }});
}

[[maybe_unused]] const bool registered =
    add<Fresnel<true>>("fresnel", "kernel", Asks::fresnel, Claim::bounded, 1e-4, 2) &&
    add<Fresnel<false>>("schlick", "kernel", Asks::fresnel, Claim::approximate, 0, 1) &&
    add<SolidAngles>("solid_angle", "kernel", Asks::solid_angles, Claim::bounded, 1e-6, 3) &&
    add<AreaOverR2<false>>("area_over_r2", "kernel", Asks::solid_angles, Claim::approximate, 0, 1) &&
    add<AreaOverR2<true>>("projected_area_over_r2", "kernel", Asks::solid_angles, Claim::approximate, 0, 2) &&
    add_compensated();

}  // namespace
}  // namespace treeline::bench::brdf_integral
