// What every reflection must obey, whatever its model: not negative, the same both ways, no more light out
// than in, white under a white sky where the loss is made good, the same turned about the normal; and small
// roughness.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "geometry/random.hpp"
#include "shading/brdf/albedo.hpp"
#include "tests/shading/brdf_common.hpp"

namespace treeline::shading::brdf::test {
namespace {

using geometry::Vec3d;

/// Facets with what gives back their loss; textbook's and directional colours are not among them.
std::vector<Material> compensated(Compensation compensation) {
  std::vector<Material> all;
  for (const auto d : {Distribution::ggx, Distribution::beckmann})
    for (const auto& [x, y] : {std::pair{0.05, 0.05}, {0.3, 0.3}, {1.0, 1.0}, {0.4, 0.15}})
      for (const auto m : {Masking::separable, Masking::correlated}) {
        if (x != y && m == Masking::separable) continue;  // its table takes long
        all.push_back(facets(d, m, x, y));
        all.back().compensation = compensation;
        all.back().name += " compensated";
      }
  return all;
}

Vec3d drawn(geometry::Pcg32& random) {
  return geometry::sample_hemisphere(random.uniform<double>(), random.uniform<double>());
}

Vec3d turned(const Vec3d& w, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return {c * w[0] - s * w[1], s * w[0] + c * w[1], w[2]};
}

TEST(Laws, NotNegativeTheSameBothWaysAndTurned) {
  std::vector<Material> all = opaque_materials();
  for (Material& m : compensated(Compensation::kulla_conty)) all.push_back(m);
  for (const Material& m : all) {
    const Bsdf<double> bsdf(m);
    geometry::Pcg32 random(2);
    double unlike_turned = 0;
    for (int i = 0; i < 500; ++i) {
      const Vec3d wi = drawn(random), wo = drawn(random);
      const auto f = bsdf.eval(wi, wo), back = bsdf.eval(wo, wi),
                 round = bsdf.eval(turned(wi, 1.1), turned(wo, 1.1)),
                 mirrored_x = bsdf.eval({-wi[0], wi[1], wi[2]}, {-wo[0], wo[1], wo[2]});
      for (int c = 0; c < 3; ++c) {
        EXPECT_GE(f[c], 0) << m.name;
        EXPECT_NEAR(back[c], f[c], 1e-12 * f[c]) << m.name;
        EXPECT_NEAR(mirrored_x[c], f[c], 1e-12 * f[c]) << m.name;
        unlike_turned = std::max(unlike_turned, std::abs(round[c] - f[c]) / (f[c] + 1e-3));
      }
    }
    if (m.kind == SurfaceKind::diffuse || m.alpha_x == m.alpha_y)
      EXPECT_LT(unlike_turned, 1e-9) << m.name;
    else
      EXPECT_GT(unlike_turned, 0.1) << m.name;
  }
}

TEST(Laws, FormsThatAreNotTheSameBothWays) {
  Material m = ggx(1);
  m.compensation = Compensation::turquin;
  const Vec3d low = at(0.1), high = at(1);
  const Bsdf<double> turquin(m);
  // E(0.1) / E(1) in closed form: (1 - 0.1 ln 11) / (1 - ln 2) = 2.48.
  EXPECT_NEAR(turquin.eval(low, high)[0] / turquin.eval(high, low)[0],
              (1 - 0.1 * std::log(11)) / (1 - std::numbers::ln2), 1e-3);
  m.compensation = Compensation::kulla_conty_directional;
  m.fresnel = FresnelKind::schlick;
  m.reflectance = {0.2f, 0.5f, 0.8f};
  const Bsdf<double> directional(m);
  EXPECT_GT(std::abs(directional.eval(low, high)[1] / directional.eval(high, low)[1] - 1), 0.05);
}

TEST(Laws, NoMoreLightOutThanIn) {
  for (const Material& m : opaque_materials())
    for (const double mu : {0.02, 0.2, 0.7, 1.0})
      for (const double azimuth : {0.0, 0.8}) {
        const auto e = directional_albedo(m, at(mu, azimuth));
        for (int c = 0; c < 3; ++c) {
          EXPECT_LE(e[c], 1 + 1e-8) << m.name << " at " << mu;
          EXPECT_GT(e[c], 0.005) << m.name << " at " << mu;
        }
      }
}

TEST(Laws, AWhiteFurnaceStaysWhite) {
  for (const auto compensation : {Compensation::kulla_conty, Compensation::turquin})
    for (const Material& m : compensated(compensation)) {
      const Bsdf<double> bsdf(m);
      for (const double mu : {0.03, 0.2, 0.7, 1.0})
        for (const double azimuth : {0.0, 0.5, 1.5}) {
          if (azimuth > 0 && m.alpha_x == m.alpha_y) break;
          EXPECT_NEAR(directional_albedo(m, bsdf, at(mu, azimuth))[0], 1, 2e-4)
              << m.name << " at " << mu << ' ' << azimuth;
        }
    }
}

TEST(Laws, NothingIsAddedWhereNothingIsLost) {
  for (const double alpha : {1e-9, 1e-5, 1e-3}) {  // 1 - Ē goes to 0: no 0/0, and white all the same
    Material m = ggx(alpha);
    m.compensation = Compensation::kulla_conty;
    const Bsdf<double> bsdf(m);
    geometry::Pcg32 random(3);
    for (int i = 0; i < 200; ++i) {
      const auto s = bsdf.sample(drawn(random), random.uniform<double>(), random.uniform<double>(),
                                 random.uniform<double>());
      EXPECT_TRUE(std::isfinite(s.weight[0]) && std::isfinite(s.pdf)) << alpha;
      EXPECT_GE(s.weight[0], 0);
    }
    EXPECT_NEAR(directional_albedo(m, at(0.5))[0], 1, 1e-4) << alpha;
  }
}

TEST(Laws, ColourOfManyBounces) {
  // F constant by channel: Schlick's with F0 = F is not; so the formula itself, as a sum over bounces.
  for (const double f : {0.0, 0.2, 0.8, 1.0})
    for (const double e : {0.4, 0.9}) {
      double in = f * (1 - e), sum = 0;  // reflected once, and still there
      for (int bounce = 0; bounce < 400; ++bounce) sum += in * f * e, in *= f * (1 - e);
      EXPECT_NEAR((1 - e) * kulla_conty_colour(f, e), sum, 1e-14);
    }
  EXPECT_NEAR(kulla_conty_colour(1.0, 0.3), 1, 1e-15);
}

TEST(Laws, MixedMaterialsAreMixedByTheirResults) {
  // Twice the light is twice the reflection, but half the reflectance of metal and half that of plastic is
  // not the mean of their albedos: many bounces are not linear in F0.
  Material m = ggx(1);
  m.compensation = Compensation::kulla_conty;
  m.fresnel = FresnelKind::schlick;
  m.reflectance = {0.04f, 0.52f, 1.f};  // the middle one is the mean of the others
  const auto e = directional_albedo(m, at(0.7));
  EXPECT_NEAR(e[2], 1, 2e-4);
  const double mean = 0.5 * (e[0] + e[2]);
  EXPECT_LT(e[1], 0.85 * mean);
  m.compensation = Compensation::none;  // one bounce is
  const auto once = directional_albedo(m, at(0.7));
  EXPECT_NEAR(once[1], 0.5 * (once[0] + once[2]), 1e-7);
}

/// Share of the light that a GGX surface of one roughness gives back, viewers by their cosine, facets that
/// reflect F: a walk over facets of uniformly distributed heights (Heitz et al. 2016), which is what
/// height-correlated masking means. After how many bounces light leaves is all that is needed: shares by
/// number of bounces.
std::vector<double> shares_by_bounces(double alpha, int walks) {
  const Ggx<double> d{alpha, alpha};
  geometry::Pcg32 random(4);
  const auto u = [&] { return random.uniform<double>(); };
  std::vector<double> shares(60, 0.0);
  for (int walk = 0; walk < walks; ++walk) {
    Vec3d w = -geometry::sample_hemisphere_cosine(u(), u());
    double height = 1;  // share of the heights below
    for (std::size_t bounce = 0; bounce < shares.size(); ++bounce) {
      // Λ of a direction that goes down is -1 - Λ of the opposite one.
      const double lambda = w[2] > 0 ? d.lambda(w) : -1 - d.lambda(-w), free = u();
      if (w[2] > 0 && free < std::pow(height, lambda)) {
        shares[bounce] += 1.0 / walks;
        break;
      }
      height *= std::pow(w[2] > 0 ? free : 1 - free, -1 / lambda);
      w = reflected(-w, sample_visible_caps(d, -w, u(), u()));
    }
  }
  return shares;
}

TEST(Laws, AWalkOverTheFacetsConfirmsTheColour) {
  for (const double alpha : {0.25, 0.5, 1.0}) {
    const std::vector<double> shares = shares_by_bounces(alpha, 400'000);
    const double once = average_albedo(ggx(alpha))[0];
    EXPECT_NEAR(shares[1], once, 4 * std::sqrt(0.25 / 400'000)) << alpha;
    for (const double f : {0.2, 0.5, 0.8}) {
      double walk = 0;
      for (std::size_t k = 0; k < shares.size(); ++k) walk += shares[k] * std::pow(f, double(k));
      const double right = f * once + (1 - once) * kulla_conty_colour(f, once);
      const double textbook = f * once + (1 - once) * kulla_conty_colour_textbook(f, once);
      EXPECT_NEAR(right, walk, 0.075 * walk) << alpha << ' ' << f;
      EXPECT_LT(right, walk + 2e-3) << alpha << ' ' << f;
      EXPECT_GT(textbook, walk) << alpha << ' ' << f;
      if (f <= 0.5) {
        EXPECT_GT(textbook - walk, 2 * std::abs(right - walk)) << alpha << ' ' << f;
      }
      if (alpha == 1 && f == 0.2) {
        EXPECT_NEAR(walk, 0.0961, 1e-3);
        EXPECT_NEAR(textbook / walk, 1.42, 0.02);
      }
    }
  }
}

// ---- small roughness, in float -------------------------------------------------------------------------

TEST(SmallRoughness, ComponentsKeepThePeak) {
  const geometry::Vec3f normal{0, 0, 1};
  const auto textbook = [](float alpha, float cosine) {
    const float a2 = alpha * alpha, s = cosine * cosine * (a2 - 1) + 1;
    return a2 / (std::numbers::pi_v<float> * s * s);
  };
  for (const float alpha : {0.1f, 1e-3f, 2e-4f, 1e-4f, 1e-9f}) {
    const double peak = 1 / (std::numbers::pi * double(alpha) * double(alpha));
    EXPECT_NEAR((Ggx<float>{alpha, alpha}).d(normal) / peak, 1, 1e-6) << alpha;
    EXPECT_NEAR((Beckmann<float>{alpha, alpha}).d(normal) / peak, 1, 1e-6) << alpha;
  }
  EXPECT_NEAR(textbook(1e-3f, 1) * (std::numbers::pi * 1e-6), 1 - 0.026, 1e-3);
  EXPECT_NEAR(textbook(2e-4f, 1) * (std::numbers::pi * 4e-8), 1 - 0.55, 1e-2);
  EXPECT_TRUE(std::isinf(textbook(1e-4f, 1)));
}

TEST(SmallRoughness, SamplesStayFiniteAndWhite) {
  for (const auto distribution : {Distribution::ggx, Distribution::beckmann})
    for (const double alpha : {smallest_alpha, 1e-6, 1e-4, 1e-2}) {
      const Bsdf<float> bsdf(facets(distribution, Masking::correlated, alpha, alpha));
      geometry::Pcg32 random(5);
      for (const double mu : {1.0, 0.5, 1e-2, 1e-4, 1e-7}) {
        const geometry::Vec3f wo = at<float>(mu);
        for (int i = 0; i < 200; ++i) {
          const auto s =
              bsdf.sample(wo, random.uniform<float>(), random.uniform<float>(), random.uniform<float>());
          EXPECT_TRUE(s.weight[0] >= 0 && s.weight[0] <= 1 + 1e-5f)
              << alpha << ' ' << mu << ' ' << s.weight[0];
          EXPECT_TRUE(std::isfinite(s.pdf) && std::isfinite(bsdf.eval(s.wi, wo)[0])) << alpha << ' ' << mu;
          if (mu >= 0.5 && alpha <= 1e-4 && s.weight[0] > 0) {
            EXPECT_LT(geometry::length(s.wi - mirrored(wo)), 2e-6 + 1e4 * alpha);
          }
        }
      }
      double sum = 0;
      for (int i = 0; i < 1000; ++i)
        sum += bsdf.sample(at<float>(0.5), 0.5f, random.uniform<float>(), random.uniform<float>()).weight[0];
      EXPECT_NEAR(sum / 1000, 1, alpha < 1e-3 ? 1e-4 : 0.01) << alpha;
    }
}

}  // namespace
}  // namespace treeline::shading::brdf::test
