// The recipes' own elementary functions against the C library's, and their random numbers against what they
// claim.
#include <gtest/gtest.h>

#include "datasets_gen/noise.hpp"
#include "datasets_gen/portable.hpp"

namespace treeline::datasets {
namespace {

constexpr double pi = 3.14159265358979323846;

TEST(Portable, SineAndCosineMatchTheLibrary) {
  for (int i = -4000; i <= 4000; ++i) {
    const double turns = i / 1234.5;
    const SinCos a = sincos_turns(turns);
    // The library gets an angle rounded to an ulp, which moves its result by as much.
    const double tolerance = 1e-15 + 2e-16 * std::abs(2 * pi * turns);
    EXPECT_NEAR(a.sin, std::sin(2 * pi * turns), tolerance) << turns;
    EXPECT_NEAR(a.cos, std::cos(2 * pi * turns), tolerance) << turns;
  }
}

TEST(Portable, QuarterTurnsAreExact) {
  for (int k = -8; k <= 8; ++k) {
    const SinCos a = sincos_turns(k * 0.25);
    constexpr double sines[] = {0, 1, 0, -1};
    EXPECT_EQ(a.sin, sines[k & 3]);
    EXPECT_EQ(a.cos, sines[(k + 1) & 3]);
  }
}

TEST(Portable, LogarithmMatchesTheLibrary) {
  for (double x = 1e-300; x < 1e300; x *= 1.37)
    EXPECT_NEAR(log_portable(x), std::log(x), 4e-16 * std::abs(std::log(x)) + 2e-16) << x;
  for (double x = 0.5; x < 2; x += 0.001) EXPECT_NEAR(log_portable(x), std::log(x), 3e-16) << x;
}

TEST(Portable, NormalDeviatesHaveMeanZeroAndVarianceOne) {
  constexpr int n = 40'000;
  for (int axis = 0; axis < 3; ++axis) {
    double sum = 0, squares = 0, fourth = 0;
    for (std::uint64_t i = 0; i < n; ++i) {
      const double x = Draws(5, i).normal()[axis];
      sum += x, squares += x * x, fourth += x * x * x * x;
    }
    // Standard errors of the mean, the variance and the fourth moment (3): 1, √2, √96 over √n; bounds at 4 of
    // them.
    EXPECT_LT(std::abs(sum / n), 4 / std::sqrt(n));
    EXPECT_LT(std::abs(squares / n - 1), 4 * std::sqrt(2.0 / n));
    EXPECT_LT(std::abs(fourth / n - 3), 4 * std::sqrt(96.0 / n));
  }
}

TEST(Portable, DirectionsAreUniformOnTheSphere) {
  constexpr int n = 40'000;
  Vec3d sum_of_all{}, squares{};
  for (std::uint64_t i = 0; i < n; ++i) {
    const Vec3d d = Draws(6, i).direction();
    EXPECT_NEAR(length(d), 1, 1e-14);
    for (int k = 0; k < 3; ++k) sum_of_all[k] += d[k], squares[k] += d[k] * d[k];
  }
  // A component has variance 1/3, its square 1/5 - 1/9.
  for (int k = 0; k < 3; ++k) {
    EXPECT_LT(std::abs(sum_of_all[k] / n), 4 * std::sqrt(1.0 / 3 / n));
    EXPECT_LT(std::abs(squares[k] / n - 1.0 / 3), 4 * std::sqrt(4.0 / 45 / n));
  }
}

TEST(Noise, IsBoundedContinuousAndTakesItsLatticeValues) {
  for (std::uint64_t i = 0; i < 2000; ++i) {
    const Vec3d p = Draws(7, i).in_box({-9, -9, -9}, {9, 9, 9});
    EXPECT_LE(std::abs(value_noise(1, p)), 1);
    EXPECT_LT(std::abs(fractal_noise(1, p, 6)), 1);
    // Across a face of the lattice: the two sides agree to what the step explains (slope at most 2 · 15/8).
    const double wall = std::floor(p[0]);
    EXPECT_NEAR(value_noise(1, {wall - 1e-9, p[1], p[2]}), value_noise(1, {wall + 1e-9, p[1], p[2]}), 1e-8);
  }
  EXPECT_NE(value_noise(1, {3, 4, 5}), value_noise(2, {3, 4, 5}));
}

}  // namespace
}  // namespace treeline::datasets
