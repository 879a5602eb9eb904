// Chi-square of every sampler of normals and of directions against the density that it states.
#include <gtest/gtest.h>

#include <cmath>

#include "shading/brdf/bsdf.hpp"
#include "tests/shading/brdf_common.hpp"
#include "tests/shading/chi_square.hpp"

namespace treeline::shading::brdf::test {
namespace {

using geometry::Pcg32, geometry::Vec3d;
using shading::test::chi_square_sphere, shading::test::SphereOptions, shading::test::TestFamily;

SphereOptions around(const Vec3d& axis, double width) { return {{12, 8, 30'000, 1}, axis, width}; }

/// A sampler of normals that takes (u, v).
template <class Draw, class Density>
void add(TestFamily& family, const std::string& name, double alpha, const Draw& draw,
         const Density& density) {
  family.add(name, chi_square_sphere(
                       [&](Pcg32& random) -> std::optional<Vec3d> {
                         const double u = random.uniform<double>(), v = random.uniform<double>();
                         return draw(u, v);
                       },
                       density, around({0, 0, 1}, 0.5 * alpha)));
}

constexpr std::pair<double, double> roughnesses[] = {{0.05, 0.05}, {0.4, 0.4}, {1.0, 1.0}, {0.6, 0.15}};
const Vec3d viewers[] = {at(0.6, 2), at(0.08, 0.4)};

TEST(Sampling, NormalsByTheirDistribution) {
  TestFamily family;
  for (const auto& [x, y] : roughnesses) {
    const Ggx<double> g{x, y};
    const Beckmann<double> b{x, y};
    const std::string name = std::to_string(x) + ' ' + std::to_string(y);
    add(
        family, "ggx " + name, x, [&](double u, double v) { return g.sample_normal(u, v); },
        [&](const Vec3d& h) { return g.d(h) * h[2]; });
    add(
        family, "beckmann " + name, x, [&](double u, double v) { return b.sample_normal(u, v); },
        [&](const Vec3d& h) { return b.d(h) * h[2]; });
  }
}

TEST(Sampling, VisibleNormals) {
  TestFamily family;
  for (const auto& [x, y] : roughnesses)
    for (const Vec3d& wo : viewers) {
      const Ggx<double> g{x, y};
      const Beckmann<double> b{x, y};
      const auto visible = [&](const auto& d) {
        return [&](const Vec3d& h) {
          return d.d(h) * std::max(0.0, geometry::dot(wo, h)) / d.projected_area(wo);
        };
      };
      const std::string name = std::to_string(x) + ' ' + std::to_string(y) + " from " + std::to_string(wo[2]);
      add(
          family, "2018 " + name, x,
          [&](double u, double v) { return sample_visible_heitz_2018(g, wo, u, v); }, visible(g));
      add(
          family, "caps " + name, x, [&](double u, double v) { return sample_visible_caps(g, wo, u, v); },
          visible(g));
      add(
          family, "beckmann " + name, x, [&](double u, double v) { return sample_visible(b, wo, u, v); },
          visible(b));
    }
}

template <class T>
void add(TestFamily& family, const Material& m, const Vec3d& viewer) {
  const Bsdf<T> bsdf(m);
  const Direction<T> wo(viewer);
  const bool narrow = m.kind == SurfaceKind::microfacet && std::max(m.alpha_x, m.alpha_y) < 0.2;
  family.add(m.name + " from " + std::to_string(viewer[2]),
             chi_square_sphere(
                 [&](Pcg32& random) -> std::optional<Vec3d> {
                   const T choice = random.uniform<T>(), u = random.uniform<T>(), v = random.uniform<T>();
                   const auto s = bsdf.sample(wo, choice, u, v);
                   if (s.weight == Colour<T>{}) return std::nullopt;
                   return Vec3d(s.wi);
                 },
                 [&](const Vec3d& wi) { return double(bsdf.pdf(Direction<T>(wi), wo)); },
                 narrow ? around(mirrored(viewer), m.alpha_x) : around({0, 0, 1}, 1)));
}

TEST(Sampling, DirectionsOfEverySurface) {
  TestFamily family;
  for (const Vec3d& wo : viewers) {
    for (const auto distribution : {Distribution::ggx, Distribution::beckmann})
      for (const auto& [x, y] : roughnesses)
        if (x > 0.2 || wo[2] > 0.4) add<double>(family, facets(distribution, Masking::correlated, x, y), wo);
    for (const auto& compensation :
         {Compensation::kulla_conty, Compensation::turquin, Compensation::kulla_conty_directional}) {
      Material m = ggx(0.7);
      m.compensation = compensation;
      m.fresnel = FresnelKind::conductor;
      add<double>(family, m, wo);
    }
    add<double>(family, Material{}, wo);
    add<float>(family, ggx(0.4), wo);
  }
}

TEST(Sampling, GlassChoosesByFresnel) {
  Material m;
  m.kind = SurfaceKind::glass;
  const Bsdf<double> glass(m);
  for (const Vec3d& wo : {at(0.9), at(0.2), -at(0.9), -at(0.76)}) {
    geometry::Pcg32 random(9);
    constexpr int n = 20'000;
    int reflections = 0;
    for (int i = 0; i < n; ++i)
      reflections += glass.sample(wo, random.uniform<double>(), 0, 0).wi[2] * wo[2] > 0;
    const double f = fresnel_dielectric(std::abs(wo[2]), wo[2] > 0 ? 1.5 : 1 / 1.5);
    EXPECT_NEAR(double(reflections) / n, f, 4 * std::sqrt(f * (1 - f) / n)) << wo[2];
  }
}

}  // namespace
}  // namespace treeline::shading::brdf::test
