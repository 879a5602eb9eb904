// Sobol points: the net property that defines them, that scrambling keeps it, and their moments.
#include "geometry/sobol.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <vector>

namespace treeline::test {
namespace {

using namespace treeline::geometry;

/// Whether points first … first + 2^m - 1 put exactly one into each of the 2^m boxes of every elementary
/// shape.
template <class Coordinate>
bool is_net(std::uint32_t first, int m, const Coordinate& coordinate) {
  const std::uint32_t n = 1u << m;
  for (int p = 0; p <= m; ++p) {
    std::vector<bool> seen(n);
    for (std::uint32_t i = 0; i < n; ++i) {
      const auto x = static_cast<std::uint32_t>(coordinate(first + i, 0) * (1u << p));
      const auto y = static_cast<std::uint32_t>(coordinate(first + i, 1) * (1u << (m - p)));
      const std::uint32_t cell = x << (m - p) | y;
      if (seen[cell]) return false;
      seen[cell] = true;
    }
  }
  return true;
}

TEST(Sobol, FirstTwoDimensionsAreNets) {
  const auto plain = [](std::uint32_t i, int d) { return sobol_bits(i, d) * 0x1p-32; };
  for (int m = 0; m <= 12; ++m)
    for (std::uint32_t run : {0u, 1u, 5u}) EXPECT_TRUE(is_net(run << m, m, plain)) << m << " " << run;
}

TEST(Sobol, OwenScramblingKeepsNets) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const auto scrambled = [seed](std::uint32_t i, int d) { return sobol_owen(i, d, seed); };
    const auto single = [seed](std::uint32_t i, int d) { return sobol_owen<float>(i, d, seed); };
    for (int m : {1, 4, 7, 10})
      for (std::uint32_t run : {0u, 3u}) {
        EXPECT_TRUE(is_net(run << m, m, scrambled)) << seed << " " << m;
        EXPECT_TRUE(is_net(run << m, m, single)) << seed << " " << m;
      }
  }
}

TEST(Sobol, EveryDimensionIsStratified) {
  for (int d = 0; d < 3 * sobol_dimensions; ++d)
    for (std::uint64_t seed : {1ull, 99ull}) {
      std::set<std::uint32_t> cells;
      for (std::uint32_t i = 0; i < 1024; ++i)
        cells.insert(static_cast<std::uint32_t>(sobol_owen(i, d, seed) * 1024));
      EXPECT_EQ(cells.size(), 1024u) << d;
    }
}

TEST(Sobol, DirectionMatricesAreUpperTriangularAndDistinct) {
  for (int d = 0; d < sobol_dimensions; ++d) {
    for (int i = 0; i < 32; ++i) {
      const std::uint32_t v = detail::sobol_matrices[d][i];
      EXPECT_EQ(v & (0x7fffffffu >> i), 0u) << "no bit below the diagonal";
      EXPECT_NE(v & (0x80000000u >> i), 0u) << "a unit diagonal";
    }
    for (int e = 0; e < d; ++e) EXPECT_NE(detail::sobol_matrices[d], detail::sobol_matrices[e]);
  }
}

/// The order of x modulo a polynomial over GF(2), by counting.
std::uint32_t order_of_x(std::uint32_t polynomial, int degree) {
  std::uint32_t power = 1, n = 0;
  do {
    power <<= 1;
    if (power >> degree & 1) power ^= polynomial;
    ++n;
  } while (power != 1 && n < (1u << degree));
  return n;
}

TEST(Sobol, PolynomialsArePrimitive) {
  for (const auto& p : detail::sobol_polynomials) {
    const std::uint32_t polynomial = 1u << p.degree | p.coefficients << 1 | 1u;
    EXPECT_EQ(order_of_x(polynomial, p.degree), (1u << p.degree) - 1);
    for (int i = 0; i < p.degree; ++i) {
      EXPECT_EQ(p.initial[i] % 2, 1u);
      EXPECT_LT(p.initial[i], 2u << i);
    }
  }
}

// Over seeds, a scrambled point is uniform: its mean is 1/2 and its variance 1/12, and two points of
// different dimensions do not correlate. Limits at five standard errors.
TEST(Sobol, MomentsOverSeeds) {
  constexpr int seeds = 20000;
  for (int d : {0, 1, 7, 15, 16, 40})
    for (std::uint32_t index : {0u, 1u, 12345u}) {
      double sum = 0, squares = 0, product = 0;
      for (int s = 0; s < seeds; ++s) {
        const double x = sobol_owen(index, d, s) - 0.5, y = sobol_owen(index, d + 1, s) - 0.5;
        sum += x, squares += x * x, product += x * y;
      }
      const double n = seeds;
      EXPECT_LT(std::abs(sum / n), 5 * std::sqrt(1 / 12.0 / n)) << d << " " << index;
      EXPECT_LT(std::abs(squares / n - 1 / 12.0), 5 * std::sqrt(1 / 180.0 / n)) << d << " " << index;
      EXPECT_LT(std::abs(product / n), 5 * (1 / 12.0) / std::sqrt(n)) << d << " " << index;
    }
}

// Integrating a smooth function, scrambled Sobol points beat the error of independent samples by far.
TEST(Sobol, IntegratesFasterThanIndependentSamples) {
  constexpr int n = 1024, seeds = 50;
  double squares = 0;
  for (int s = 0; s < seeds; ++s) {
    double sum = 0;
    for (int i = 0; i < n; ++i) sum += sobol_owen(i, 0, s) * sobol_owen(i, 1, s) * sobol_owen(i, 2, s);
    const double error = sum / n - 0.125;
    squares += error * error;
  }
  const double independent = (1 / 27.0 - 1 / 64.0) / n;  // variance of the product of three uniforms, over n
  EXPECT_LT(squares / seeds, independent / 100);
}

}  // namespace
}  // namespace treeline::test
