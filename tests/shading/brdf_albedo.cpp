// Distributions and albedos of facets: normalised, against closed forms, by two quadratures, by samples, by
// table.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "geometry/random.hpp"
#include "shading/brdf/albedo.hpp"
#include "tests/shading/brdf_common.hpp"

namespace treeline::shading::brdf::test {
namespace {

using geometry::Vec3d;
using std::numbers::pi;

/// Calls use(Microfacets<...>) of the material's own distribution.
template <class Use>
void with_facets(const Material& m, Use&& use) {
  if (m.distribution == Distribution::ggx)
    use(Microfacets<Ggx<double>>{{m.alpha_x, m.alpha_y}, m.masking});
  else
    use(Microfacets<Beckmann<double>>{{m.alpha_x, m.alpha_y}, m.masking});
}

/// ∫ g(h) dω over the upper hemisphere, by slopes r (ax cos, ay sin).
template <class G>
double over_normals(const Material& m, G&& g) {
  const auto around = [&](double t) {
    const double r = std::sinh(t);
    double sum = 0;
    constexpr int steps = 128;
    for (int i = 0; i < steps; ++i) {
      const double angle = 2 * pi * (i + 0.5) / steps;
      const double x = m.alpha_x * r * std::cos(angle), y = m.alpha_y * r * std::sin(angle);
      const double z = 1 / std::sqrt(1 + x * x + y * y);
      sum += g(Vec3d{x * z, y * z, z}) * z * z * z;
    }
    return sum * (2 * pi / steps) * m.alpha_x * m.alpha_y * r * std::cosh(t);
  };
  return geometry::integrate<12>(around, 0, 21, 28);
}

TEST(Normals, HaveTheSurfacesAreaAndTheViewersArea) {
  for (const Material& m : all_facets()) {
    if (m.masking == Masking::separable) continue;  // of no account here
    with_facets(m, [&](const auto& facets) {
      const auto& normals = facets.normals;
      EXPECT_NEAR(over_normals(m, [&](const Vec3d& h) { return normals.d(h) * h[2]; }), 1, 1e-9) << m.name;
      for (const double mu : {1.0, 0.4}) {
        const Vec3d wo = at(mu, 0.5);
        const double area = normals.projected_area(wo),
                     seen = over_normals(m, [&](const Vec3d&h) {
                       return normals.d(h) * std::max(0.0, geometry::dot(h, wo));
                     });
        EXPECT_NEAR(seen, area, 1e-3 * area) << m.name << ' ' << mu;  // the integrand has a kink
        EXPECT_NEAR(area, mu * (1 + normals.lambda(wo)), 1e-12) << m.name << ' ' << mu;
        // Seen from both sides, facets face one or the other: their areas differ by the surface's own.
        EXPECT_NEAR(area - normals.projected_area(-wo), mu, 1e-12) << m.name << ' ' << mu;
      }
    });
  }
}

TEST(Normals, AreTheTextbooksForms) {
  for (const double alpha : {0.1, 0.5, 1.0})
    for (const double cosine : {1.0, 0.8, 0.3}) {
      const double c2 = cosine * cosine, tan2 = (1 - c2) / c2, a2 = alpha * alpha;
      const Ggx<double> g{alpha, alpha};
      const Beckmann<double> b{alpha, alpha};
      const Vec3d h = at(cosine, 0.7);
      EXPECT_NEAR(g.d(h) / (a2 / (pi * std::pow(c2 * (a2 - 1) + 1, 2))), 1, 1e-12);
      const double beckmann = std::exp(-tan2 / a2) / (pi * a2 * c2 * c2);
      EXPECT_NEAR(b.d(h), beckmann, 1e-12 * beckmann);
      EXPECT_NEAR(g.lambda(h), (std::sqrt(1 + a2 * tan2) - 1) / 2, 1e-12);
      const double a = 1 / (alpha * std::sqrt(tan2));
      if (cosine < 1) {
        EXPECT_NEAR(b.lambda(h), 0.5 * (std::erf(a) - 1) + std::exp(-a * a) / (2 * a * std::sqrt(pi)), 1e-12);
      }
      // Masking by the rational fit in common use is off by up to 0.31 %, but not by more.
      const double fit = a < 1.6 ? (3.535 * a + 2.181 * a * a) / (1 + 2.276 * a + 2.577 * a * a) : 1;
      EXPECT_NEAR(smith_g1(b, h), fit, 0.0032);
    }
  // Both maskings: G2 is the product, or by the sum of the Λ.
  const Ggx<double> g{0.7, 0.3};
  const Vec3d i = at(0.3, 1), o = at(0.6, 2);
  EXPECT_NEAR(smith_g2(g, Masking::separable, i, o), 1 / ((1 + g.lambda(i)) * (1 + g.lambda(o))), 1e-14);
  EXPECT_NEAR(smith_g2(g, Masking::correlated, i, o), 1 / (1 + g.lambda(i) + g.lambda(o)), 1e-14);
}

TEST(Albedo, ClosedFormsOfGgxAtRoughnessOne) {
  // D = 1/π and A = (1 + μ)/2 throughout.
  Material separable = facets(Distribution::ggx, Masking::separable, 1, 1);
  for (const double mu : {0.01, 0.1, 0.5, 1.0}) {
    EXPECT_NEAR(directional_albedo(ggx(1), at(mu))[0], 1 - mu * std::log((1 + mu) / mu), 1e-9);
    EXPECT_NEAR(directional_albedo(separable, at(mu))[0], 2 * (1 - std::numbers::ln2) / (1 + mu), 1e-9);
  }
  EXPECT_NEAR(directional_albedo(ggx(1), at(1))[0], 1 - std::numbers::ln2, 1e-9);
  EXPECT_NEAR(average_albedo(separable)[0], 4 * std::pow(1 - std::numbers::ln2, 2), 1e-7);
}

TEST(Albedo, LossOfOneBounce) {
  // GGX, separable, in percent: growing with roughness. To the digits in which they were first measured.
  const std::pair<double, double> losses[] = {{0.05, 0.9}, {0.1, 2.8}, {0.25, 12},
                                              {0.5, 31},   {0.75, 49}, {1, 62}};
  for (const auto& [alpha, percent] : losses) {
    const double loss =
        100 * (1 - average_albedo(facets(Distribution::ggx, Masking::separable, alpha, alpha))[0]);
    EXPECT_NEAR(loss, percent, percent < 10 ? 0.1 : 0.55) << alpha;
  }
}

TEST(Albedo, TwoQuadraturesAgree) {
  for (const Material& m : all_facets())
    for (const auto& [mu, azimuth] : {std::pair{0.05, 0.0}, {0.3, 0.9}, {1.0, 0.0}}) {
      const Vec3d wo = at(mu, azimuth);
      with_facets(m, [&](const auto& facets) {
        const auto f = [&](const Vec3d& wi) { return facets.eval(wi, wo) * wi[2]; };
        EXPECT_NEAR(integrate_by_normals(m.alpha_x, m.alpha_y, wo, f),
                    integrate_by_directions(m.alpha_x, m.alpha_y, wo, f, 1e-8), 1e-7)
            << m.name << " at " << mu;
      });
    }
}

TEST(Albedo, SamplesAgreeWithQuadrature) {
  constexpr int n = 20'000;
  int beyond_two = 0, tests = 0;
  for (const auto distribution : {Distribution::ggx, Distribution::beckmann})
    for (const auto masking : {Masking::separable, Masking::correlated})
      for (const auto& [x, y] : {std::pair{0.02, 0.02},
                                 {0.05, 0.05},
                                 {0.1, 0.1},
                                 {0.25, 0.25},
                                 {0.5, 0.5},
                                 {1.0, 1.0},
                                 {0.02, 0.4},
                                 {0.9, 0.1}}) {
        const Material m = facets(distribution, masking, x, y);
        const Bsdf<double> bsdf(m);
        geometry::Pcg32 random(6);
        for (const double mu : {0.03, 0.4, 1.0}) {
          const Vec3d wo = at(mu, 0.6);
          double sum = 0, squares = 0;
          for (int i = 0; i < n; ++i) {
            const double w = bsdf.sample(wo, 0, random.uniform<double>(), random.uniform<double>()).weight[0];
            sum += w, squares += w * w;
          }
          const double mean = sum / n, error = std::sqrt(std::max(0.0, squares / n - mean * mean) / n);
          // Where all weights are 1 but for one sample in n, the error estimated from the samples is none.
          const double off = std::abs(mean - directional_albedo(m, bsdf, wo)[0]);
          EXPECT_LE(off, 4 * std::max(error, 0.5 / n)) << m.name << " at " << mu;
          beyond_two += off > 2 * error, ++tests;
        }
      }
  EXPECT_LT(beyond_two, tests * 0.05 + 4 * std::sqrt(tests * 0.05));  // nor are they too often rather far
}

TEST(Albedo, ShareOfVisibleNormalsThatReflectBelowTheSurface) {
  constexpr int n = 40'000;
  const auto check = [&](double alpha, double mu, double expected) {
    const Ggx<double> d{alpha, alpha};
    geometry::Pcg32 random(7);
    int lost_2018 = 0, lost_caps = 0, lost_bounded = 0;
    for (int i = 0; i < n; ++i) {
      const double u = random.uniform<double>(), v = random.uniform<double>();
      lost_2018 += reflected(at(mu), sample_visible_heitz_2018(d, at(mu), u, v))[2] < 0;
      lost_caps += reflected(at(mu), sample_visible_caps(d, at(mu), u, v))[2] < 0;
      lost_bounded += reflected(at(mu), sample_visible_bounded(d, at(mu), u, v))[2] < -1e-12;
    }
    const double error = 4 * std::sqrt(expected * (1 - expected) / n);
    EXPECT_NEAR(double(lost_2018) / n, expected, error) << alpha << ' ' << mu;
    EXPECT_NEAR(double(lost_caps) / n, expected, error) << alpha << ' ' << mu;
    if (mu == 1) {
      EXPECT_EQ(lost_bounded, 0) << alpha;  // head-on the bound is exact
    }
  };
  for (const double alpha : {0.1, 0.5, 1.0}) check(alpha, 1, alpha * alpha / (1 + alpha * alpha));
  for (const double mu : {0.1, 0.5}) check(1, mu, mu / (1 + mu));
}

TEST(Albedo, BoundedSamplingVariesLess) {
  // Variance of E's estimate by bounded caps over that by visible normals: about 5 % at α = 0.1 head-on, 15 %
  // at α = 1 head-on, 93 % at α = 0.1, cosine 0.1.
  const auto ratio = [](double alpha, double mu) {
    const Microfacets<Ggx<double>> facets{{alpha, alpha}, Masking::correlated};
    geometry::Pcg32 random(8);
    constexpr int n = 100'000;
    double sums[4] = {};
    const Vec3d wo = at(mu);
    for (int i = 0; i < n; ++i) {
      const double u = random.uniform<double>(), v = random.uniform<double>();
      const double b = facets.weight(facets.sample(wo, u, v), wo);
      const Vec3d wi = reflected(wo, sample_visible_caps(facets.normals, wo, u, v));
      const double c =
          facets.weight(wi, wo) * facets.normals.projected_area(wo) / bounded_area(facets.normals, wo);
      sums[0] += b, sums[1] += b * b, sums[2] += c, sums[3] += c * c;
    }
    const auto variance = [&](double s, double s2) { return s2 / n - (s / n) * (s / n); };
    return variance(sums[0], sums[1]) / variance(sums[2], sums[3]);
  };
  EXPECT_NEAR(ratio(0.1, 1), 0.05, 0.01);
  EXPECT_NEAR(ratio(1, 1), 0.15, 0.01);
  EXPECT_NEAR(ratio(0.1, 0.1), 0.93, 0.02);
}

TEST(AlbedoTable, IsWithinItsError) {
  for (Material m :
       {ggx(0.001), ggx(0.1), ggx(1), facets(Distribution::beckmann, Masking::separable, 0.1, 0.1),
        facets(Distribution::ggx, Masking::correlated, 0.05, 0.5)}) {
    const AlbedoTable table(m);
    for (double mu = 1; mu > 0.02 * m.alpha_x; mu *= 0.7)
      for (const double azimuth : {0.0, 0.1, 0.7, 1.5}) {
        if (azimuth > 0 && m.alpha_x == m.alpha_y) break;
        EXPECT_NEAR(table(at(mu, azimuth)), directional_albedo(m, at(mu, azimuth))[0], 1.5e-4)
            << m.name << " at " << mu;
        EXPECT_NEAR(table(at<float>(mu, azimuth)), table(at(mu, azimuth)), 2e-6) << m.name << " at " << mu;
      }
    if (m.alpha_x == m.alpha_y) {
      EXPECT_NEAR(table.average(), average_albedo(m)[0], 5e-5) << m.name;
    }
  }
  EXPECT_THROW(AlbedoTable(ggx(0.3), 3), std::invalid_argument);
  EXPECT_THROW(AlbedoTable(ggx(0.3), 33, 9, 0), std::invalid_argument);
  EXPECT_THROW(AlbedoTable(ggx(0)), InvalidMaterial);
}

}  // namespace
}  // namespace treeline::shading::brdf::test
