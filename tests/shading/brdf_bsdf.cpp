// The materials' common face: sampling, density and function of one surface agree; what is refused.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "geometry/random.hpp"
#include "shading/brdf/bsdf.hpp"
#include "tests/shading/brdf_common.hpp"

namespace treeline::shading::brdf::test {
namespace {

TEST(Bsdf, WeightIsFunctionTimesCosineOverDensity) {
  for (const Material& m : opaque_materials()) {
    const Bsdf<double> bsdf(m);
    geometry::Pcg32 random(1);
    for (int i = 0; i < 2000; ++i) {
      const auto wo = geometry::sample_hemisphere(random.uniform<double>(), random.uniform<double>());
      const auto s =
          bsdf.sample(wo, random.uniform<double>(), random.uniform<double>(), random.uniform<double>());
      EXPECT_FALSE(s.delta);
      if (s.pdf == 0) {
        EXPECT_EQ(s.weight, Colour<double>{});
        continue;
      }
      EXPECT_GT(s.wi[2], 0) << m.name;
      EXPECT_NEAR(geometry::length(s.wi), 1, 1e-12) << m.name;
      EXPECT_NEAR(bsdf.pdf(s.wi, wo) / s.pdf, 1, 1e-9) << m.name;
      const auto f = bsdf.eval(s.wi, wo);
      for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(f[c] * s.wi[2] / s.pdf, s.weight[c], 1e-9 * s.weight[c] + 1e-15) << m.name;
    }
  }
}

TEST(Bsdf, NothingBelowTheSurface) {
  const geometry::Vec3d above{0.6, 0, 0.8}, below{0.6, 0, -0.8}, along{1, 0, 0};
  for (const Material& m : opaque_materials()) {
    const Bsdf<double> bsdf(m);
    for (const auto& [wi, wo] :
         {std::pair{above, below}, {below, above}, {below, below}, {along, above}, {above, along}}) {
      EXPECT_EQ(bsdf.eval(wi, wo), Colour<double>{}) << m.name;
      EXPECT_EQ(bsdf.pdf(wi, wo), 0) << m.name;
    }
    for (const auto& wo : {below, along}) EXPECT_EQ(bsdf.sample(wo, 0.5, 0.5, 0.5).weight, Colour<double>{});
  }
}

TEST(Bsdf, MirrorAndGlassAreDeltas) {
  Material m;
  m.kind = SurfaceKind::mirror;
  m.reflectance = {0.25f, 0.5f, 1.f};
  const geometry::Vec3d wo{0.48, 0.36, 0.8};
  const Bsdf<double> mirror(m);
  EXPECT_TRUE(mirror.delta());
  const auto s = mirror.sample(wo, 0.3, 0.3, 0.3);
  EXPECT_TRUE(s.delta);
  EXPECT_EQ(s.wi, (geometry::Vec3d{-0.48, -0.36, 0.8}));
  EXPECT_EQ(s.weight, (Colour<double>{0.25, 0.5, 1}));
  EXPECT_EQ(mirror.eval(s.wi, wo), Colour<double>{});

  m.kind = SurfaceKind::glass;
  m.index = 1.5;
  const Bsdf<double> glass(m);
  const double f = fresnel_dielectric(0.8, 1.5);
  EXPECT_EQ(glass.sample(wo, f * 0.999, 0, 0).weight[0], 1);
  const auto in = glass.sample(wo, f * 1.001, 0, 0);
  EXPECT_LT(in.wi[2], 0);
  EXPECT_NEAR(geometry::length(in.wi), 1, 1e-15);
  EXPECT_NEAR(std::hypot(in.wi[0], in.wi[1]), 0.6 / 1.5, 1e-15);  // Snell
  EXPECT_NEAR(in.weight[0], 1 / 2.25, 1e-15);
  const auto out = glass.sample(in.wi, 0.999, 0, 0);  // and back the same way
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(out.wi[k], wo[k], 1e-15);
  EXPECT_NEAR(in.weight[0] * out.weight[0], 1, 1e-15);
  const auto total = glass.sample({0.8, 0, -0.6}, std::nextafter(1.0, 0.0), 0, 0);
  EXPECT_EQ(total.wi, (geometry::Vec3d{-0.8, 0, -0.6}));  // beyond 41.8 degrees all is reflected
  EXPECT_EQ(total.weight[0], 1);
}

TEST(Bsdf, RefusesWhatHasNoReflection) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const auto refused = [](auto&& spoil, const char* field) {
    Material m = ggx(0.3);
    m.name = "tried";
    spoil(m);
    try {
      Bsdf<float>{m};
      ADD_FAILURE() << field << " accepted";
    } catch (const InvalidMaterial& e) {
      EXPECT_NE(std::string(e.what()).find("'tried': " + std::string(field)), std::string::npos) << e.what();
    }
  };
  refused([&](Material& m) { m.alpha_x = nan; }, "alpha_x");
  refused([](Material& m) { m.alpha_y = 0; }, "alpha_y");
  refused([](Material& m) { m.alpha_y = -0.1; }, "alpha_y");
  refused([](Material& m) { m.alpha_x = 11; }, "alpha_x");
  refused([&](Material& m) { m.emission[1] = -1; }, "emission[1]");
  refused([&](Material& m) { m.kind = SurfaceKind::diffuse, m.reflectance[2] = 1.01f; }, "reflectance[2]");
  refused([&](Material& m) { m.kind = SurfaceKind::mirror, m.reflectance[0] = nan; }, "reflectance[0]");
  refused([&](Material& m) { m.kind = SurfaceKind::glass, m.index = 0; }, "index");
  refused([&](Material& m) { m.fresnel = FresnelKind::schlick, m.reflectance[0] = -0.1f; }, "reflectance[0]");
  refused([&](Material& m) { m.fresnel = FresnelKind::dielectric, m.index = nan; }, "index");
  refused([&](Material& m) { m.fresnel = FresnelKind::conductor, m.conductor_index[0] = -1; },
          "conductor_index[0]");
  refused([&](Material& m) { m.fresnel = FresnelKind::conductor, m.conductor_extinction[1] = nan; },
          "conductor_extinction[1]");
  refused([](Material& m) { m.kind = SurfaceKind(17); }, "kind");
  refused([](Material& m) { m.distribution = Distribution(17); }, "distribution");
  refused([](Material& m) { m.masking = Masking(-1); }, "masking");
  refused([](Material& m) { m.fresnel = FresnelKind(17); }, "fresnel");
  refused([](Material& m) { m.compensation = Compensation(17); }, "compensation");
}

}  // namespace
}  // namespace treeline::shading::brdf::test
