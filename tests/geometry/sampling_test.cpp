// Samplers and generators: chi-square tests with fixed seeds against the densities they claim.
#include "geometry/sampling.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <vector>

#include "geometry/random.hpp"

namespace treeline::test {
namespace {

using namespace treeline::geometry;

/// Chi-square statistic of counts that should be equal, as standard deviations above its mean (Wilson and
/// Hilferty 1931: the cube root is close to normal).
double chi_square_z(const std::vector<int>& counts) {
  double total = 0, x2 = 0;
  for (int c : counts) total += c;
  const double expected = total / counts.size(), k = counts.size() - 1.0;
  for (int c : counts) x2 += (c - expected) * (c - expected) / expected;
  return (std::cbrt(x2 / k) - (1 - 2 / (9 * k))) / std::sqrt(2 / (9 * k));
}
constexpr double limit = 4;  // standard deviations: one run in 30,000 exceeds it, and the seeds are fixed

/// Counts samples in a grid of cells of equal probability, given by a map back to the unit square.
template <class Sample>
double uniformity(std::uint64_t seed, const Sample& unit_square_of) {
  constexpr int grid = 16, n = 200000;
  std::vector<int> counts(grid * grid);
  Pcg32 random(seed);
  for (int i = 0; i < n; ++i) {
    const float u = random.uniform<float>(), v = random.uniform<float>();
    const Vec2d q = unit_square_of(u, v);
    const auto cell = [](double x) { return std::min(grid - 1, std::max(0, static_cast<int>(x * grid))); };
    ++counts[cell(q[0]) * grid + cell(q[1])];
  }
  return std::abs(chi_square_z(counts));
}

double turn_of(double x, double y) { return std::atan2(y, x) / (2 * std::numbers::pi) + 0.5; }

TEST(Sampling, Disc) {
  EXPECT_LT(uniformity(1,
                       [](float u, float v) {
                         const Vec2f p = sample_disc(u, v);
                         EXPECT_LE(length2(p), 1 + 1e-6f);
                         return Vec2d{length2(Vec2d(p)), turn_of(p[0], p[1])};
                       }),
            limit);
}
TEST(Sampling, Sphere) {
  EXPECT_LT(uniformity(2,
                       [](float u, float v) {
                         const Vec3f p = sample_sphere(u, v);
                         EXPECT_NEAR(length(p), 1, 4e-7);
                         return Vec2d{0.5 + 0.5 * p[2], turn_of(p[0], p[1])};
                       }),
            limit);
}
TEST(Sampling, Hemisphere) {
  EXPECT_LT(uniformity(3,
                       [](float u, float v) {
                         const Vec3f p = sample_hemisphere(u, v);
                         EXPECT_NEAR(length(p), 1, 4e-7);
                         return Vec2d{p[2], turn_of(p[0], p[1])};
                       }),
            limit);
}
TEST(Sampling, HemisphereCosine) {
  EXPECT_LT(uniformity(4,
                       [](float u, float v) {
                         const Vec3f p = sample_hemisphere_cosine(u, v);
                         EXPECT_NEAR(length(p), 1, 4e-7);
                         EXPECT_GE(p[2], 0);
                         return Vec2d{double(p[2]) * p[2], turn_of(p[0], p[1])};  // the density of z is 2 z
                       }),
            limit);
}
TEST(Sampling, Triangle) {
  EXPECT_LT(
      uniformity(5,
                 [](float u, float v) {
                   const Vec3f w = sample_triangle(u, v);
                   EXPECT_GE(std::min({w[0], w[1], w[2]}), 0);
                   EXPECT_NEAR(w[0] + w[1] + w[2], 1, 2e-7);
                   // P(w0 > x) = (1 - x)^2; given w0, the share w1 / (w1 + w2) is uniform.
                   return Vec2d{(1.0 - w[0]) * (1.0 - w[0]), w[1] / std::max(1e-30, double(w[1]) + w[2])};
                 }),
      limit);
}
TEST(Sampling, TheTestCanFail) {
  EXPECT_GT(
      uniformity(
          6,
          [](float u, float v) {
            const Vec2d p{u * std::cos(6.2831853 * v), u * std::sin(6.2831853 * v)};  // crowds the centre
            return Vec2d{length2(p), turn_of(p[0], p[1])};
          }),
      100);
}

TEST(Frame, IsRightHandedAndOrthonormal) {
  Pcg32 random(9);
  for (int i = 0; i < 10000; ++i) {
    Vec3d n = sample_sphere(random.uniform(), random.uniform());
    if (i == 0) n = {0, 0, -1};
    if (i == 1) n = {0, 0, 1};
    const Frame<double> f(n);
    EXPECT_NEAR(dot(f.x, f.y), 0, 1e-14);
    EXPECT_NEAR(dot(f.x, f.z), 0, 1e-14);
    EXPECT_NEAR(length(f.x), 1, 1e-14);
    EXPECT_LT(distance(cross(f.x, f.y), f.z), 1e-14);
    EXPECT_EQ(f({0, 0, 1}), n);
  }
}

TEST(Random, Pcg32GivesThePublishedSequence) {
  // pcg32-demo of the reference implementation: seed 42, stream 54, first round.
  Pcg32 random(42, 54);
  for (std::uint32_t expected :
       {0xa15c02b7u, 0x7b47f409u, 0xba1d3330u, 0x83d2f293u, 0xbfa4784bu, 0xcbed606eu})
    EXPECT_EQ(random.next(), expected);
}
TEST(Random, NeverReachesOne) {
  EXPECT_LT(unit_interval<float>(~0ull), 1.0f);
  EXPECT_LT(unit_interval<double>(~0ull), 1.0);
  EXPECT_EQ(unit_interval<float>(0), 0.0f);
}
TEST(Random, UniformPairsAndBelow) {
  EXPECT_LT(uniformity(10, [](float u, float v) { return Vec2d{u, v}; }), limit);
  Pcg32 random(11);
  std::vector<int> counts(7);
  for (int i = 0; i < 70000; ++i) ++counts[random.below(7)];
  EXPECT_LT(chi_square_z(counts), limit);
}
TEST(Random, HashIsUniformAlongIndicesAndSeeds) {
  std::vector<int> along_index(256), along_seed(256), pairs(256);
  for (std::uint64_t i = 0; i < 100000; ++i) {
    ++along_index[static_cast<std::size_t>(uniform_at(5, i) * 256)];
    ++along_seed[static_cast<std::size_t>(uniform_at(i, 5) * 256)];
    ++pairs[static_cast<std::size_t>(uniform_at(5, i) * 16) * 16 +
            static_cast<std::size_t>(uniform_at(6, i) * 16)];
  }
  EXPECT_LT(std::abs(chi_square_z(along_index)), limit);
  EXPECT_LT(std::abs(chi_square_z(along_seed)), limit);
  EXPECT_LT(std::abs(chi_square_z(pairs)), limit);
}

}  // namespace
}  // namespace treeline::test
