// Fresnel's factor and averages against closed forms and laws; how far off Schlick's approximation is.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "shading/brdf/fresnel.hpp"

namespace treeline::shading::brdf {
namespace {

/// Fresnel's equations as they are written, with a complex index.
double by_complex_numbers(double cosine, std::complex<double> n) {
  const std::complex<double> t = std::sqrt(1.0 - (1 - cosine * cosine) / (n * n));
  return 0.5 *
         (std::norm((cosine - n * t) / (cosine + n * t)) + std::norm((n * cosine - t) / (n * cosine + t)));
}

TEST(Fresnel, DielectricAndConductorAreFresnelsEquations) {
  for (const double n : {0.2, 0.5, 0.95, 1.0001, 1.05, 1.5, 3.0})
    for (const double k : {0.0, 0.2, 4.0, 9.0})
      for (double cosine = 1; cosine > 1e-4; cosine *= 0.9)
        EXPECT_NEAR(fresnel_conductor(cosine, n, k), by_complex_numbers(cosine, {n, k}), 1e-12);
  for (const double n : {0.2, 0.5, 0.95, 1.0001, 1.05, 1.5, 3.0})
    for (double cosine = 1; cosine > 1e-4; cosine *= 0.9)
      EXPECT_NEAR(fresnel_dielectric(cosine, n), by_complex_numbers(cosine, {n, 0}), 1e-12);
}

TEST(Fresnel, ClosedForms) {
  for (const double n : {1 / 1.5, 1.05, 1.5, 3.0}) {
    EXPECT_NEAR(fresnel_dielectric(1.0, n), fresnel_at_normal(n), 1e-15);
    EXPECT_EQ(fresnel_dielectric(0.0, n), 1);
    // Brewster's angle, tan = n: what is polarised in the plane is not reflected at all.
    const double brewster = 1 / std::sqrt(1 + n * n), s = (1 - n * n) / (1 + n * n);
    EXPECT_NEAR(fresnel_dielectric(brewster, n), 0.5 * s * s, 1e-15);
  }
  const double critical = std::sqrt(1 - 1 / 2.25);  // leaving glass of index 1.5
  EXPECT_EQ(fresnel_dielectric(critical * 0.999999, 1 / 1.5), 1);
  EXPECT_LT(fresnel_dielectric(critical * 1.0001, 1 / 1.5), 0.98);
  EXPECT_NEAR(fresnel_conductor(1.0, 0.2, 3.9), (0.64 + 15.21) / (1.44 + 15.21), 1e-15);
}

TEST(Fresnel, TheSameBothWays) {  // what is reflected at an angle is reflected on the way back
  for (const double n : {1.05, 1.5, 3.0})
    for (double cosine = 0.05; cosine <= 1; cosine += 0.05)
      EXPECT_NEAR(fresnel_dielectric(cosine, n), fresnel_dielectric(refracted_cosine(cosine, n), 1 / n),
                  1e-13);
}

/// Walsh 1926: the average over a diffuse sky in closed form, n > 1.
double walsh(double n) {
  const double n2 = n * n, n4 = n2 * n2, p = n2 + 1, m = n2 - 1;
  return 0.5 + (n - 1) * (3 * n + 1) / (6 * (n + 1) * (n + 1)) +
         n2 * m * m / (p * p * p) * std::log((n - 1) / (n + 1)) -
         2 * n2 * n * (n2 + 2 * n - 1) / (p * (n4 - 1)) +
         8 * n4 * (n4 + 1) / (p * (n4 - 1) * (n4 - 1)) * std::log(n);
}

TEST(Fresnel, AveragesAreWalshsAndSchlicks) {
  for (const double n : {1.05, 1.2, 1.5, 2.0, 3.0})
    EXPECT_NEAR(fresnel_average_dielectric(n), walsh(n), 1e-9) << n;
  EXPECT_NEAR(fresnel_average_dielectric(1.5), 0.09178, 5e-6);
  EXPECT_NEAR(fresnel_average_schlick(0.04), 0.08571, 5e-6);
  // From inside, summed directly on both sides of the critical angle.
  const double critical = std::sqrt(1 - 1 / 2.25);
  const auto inside = [](double mu) { return 2 * mu * fresnel_dielectric(mu, 1 / 1.5); };
  const auto from_critical = [&](double t) { return 2 * t * inside(critical + t * t); };  // a root's end
  EXPECT_NEAR(fresnel_average_dielectric(1 / 1.5),
              critical * critical + geometry::integrate<32>(from_critical, 0, std::sqrt(1 - critical), 8),
              1e-9);
  for (const double f0 : {0.0, 0.04, 0.5, 1.0})
    EXPECT_NEAR(fresnel_average_schlick(f0),
                fresnel_average([f0](double mu) { return fresnel_schlick(mu, f0); }), 1e-12);
  EXPECT_NEAR(fresnel_average_conductor(1.5, 0), walsh(1.5), 1e-9);
}

/// Schlick's error where it is largest.
template <class F>
double worst_of_schlick(F&& exact) {
  double worst = 0;
  const double normal = exact(1.0);
  for (int i = 0; i <= 9000; ++i) {
    const double cosine = std::cos(i / 9000.0 * std::numbers::pi / 2);
    const double error = fresnel_schlick(cosine, normal) - exact(cosine);
    if (std::abs(error) > std::abs(worst)) worst = error;
  }
  return worst;
}

TEST(Fresnel, SchlicksErrors) {
  const auto dielectric = [](double n) {
    return worst_of_schlick([n](double c) { return fresnel_dielectric(c, n); });
  };
  const auto conductor = [](double n, double k) {
    return worst_of_schlick([=](double c) { return fresnel_conductor(c, n, k); });
  };
  EXPECT_NEAR(dielectric(1.05), 0.32, 0.005);
  EXPECT_NEAR(dielectric(1.5), 0.036, 0.0005);
  EXPECT_NEAR(dielectric(3), 0.125, 0.0005);
  EXPECT_NEAR(dielectric(1 / 1.5), -0.96, 0.005);
  EXPECT_NEAR(conductor(0.2, 0.2), -0.40, 0.005);
}

TEST(Fresnel, StaysAShareInFloat) {
  for (const float n : {0.2f, 1 / 1.5f, 1.f, 1.0000001f, 1.5f, 40.f})
    for (const float k : {0.f, 1e-20f, 3.f, 100.f})
      for (float cosine = 1; cosine > 1e-30f; cosine *= 0.7f) {
        EXPECT_GE(fresnel_conductor(cosine, n, k), 0) << n << ' ' << k << ' ' << cosine;
        EXPECT_LE(fresnel_conductor(cosine, n, k), 1) << n << ' ' << k << ' ' << cosine;
        EXPECT_LE(fresnel_dielectric(cosine, n), 1);
      }
}

}  // namespace
}  // namespace treeline::shading::brdf
