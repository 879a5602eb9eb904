// Point sets: what each promises of its points' places, that each point alone is uniform, and how fast
// averages come to their integrals.
#include "geometry/point_sets.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>
#include <vector>

namespace treeline::test {
namespace {

using namespace treeline::geometry;

template <class T = double>
std::vector<Vec<T, 2>> points_of(PointSet set, std::size_t n, std::uint64_t seed) {
  std::vector<Vec<T, 2>> r(n);
  fill_points<T>(set, seed, r);
  return r;
}

TEST(PointSets, EachPointIsUniformOverSeeds) {
  // 255 degrees of freedom: beyond 374 once in 10^6, and 25 tests.
  constexpr int grid = 16, seeds = 20'000;
  for (const PointSet set : point_sets) {
    const std::array<std::size_t, 5> places{0, 1, 7, 12, 25};
    std::array<std::vector<double>, 5> counts;
    for (auto& c : counts) c.resize(grid * grid);
    for (std::uint64_t seed = 0; seed < seeds; ++seed) {
      const auto points = points_of(set, 26, seed);
      for (std::size_t k = 0; k < places.size(); ++k) {
        // A stratum's point is uniform within it only: of one stratum, for that.
        const Vec2d p =
            set == PointSet::stratified ? points_of(set, 1, 26 * seed + places[k])[0] : points[places[k]];
        ASSERT_TRUE(p[0] >= 0 && p[0] < 1 && p[1] >= 0 && p[1] < 1);
        ++counts[k][static_cast<std::size_t>(p[0] * grid) * grid + static_cast<std::size_t>(p[1] * grid)];
      }
    }
    constexpr double expected = double(seeds) / (grid * grid);
    for (const auto& c : counts) {
      double chi2 = 0;
      for (const double count : c) chi2 += (count - expected) * (count - expected) / expected;
      EXPECT_LT(chi2, 374) << name_of(set);
    }
  }
}

TEST(PointSets, FloatsStayBelowOneAndAreTheDoublesRounded) {
  for (const PointSet set : point_sets) {
    const auto exact = points_of(set, 5000, 3);
    const auto single = points_of<float>(set, 5000, 3);
    for (std::size_t i = 0; i < exact.size(); ++i)
      for (int k = 0; k < 2; ++k) {
        ASSERT_LT(single[i][k], 1.0f);
        ASSERT_NEAR(single[i][k], exact[i][k], 1.2e-7) << name_of(set);
      }
  }
  EXPECT_LT(detail::below_one<float>(1 - 1e-12), 1.0f);
}

TEST(PointSets, SeedsDifferAndRepeat) {
  for (const PointSet set : point_sets) {
    EXPECT_EQ(points_of(set, 33, 5), points_of(set, 33, 5));
    std::set<double> first;
    for (std::uint64_t seed = 0; seed < 100; ++seed) first.insert(points_of(set, 33, seed)[4][0]);
    EXPECT_EQ(first.size(), 100u) << name_of(set);
    EXPECT_TRUE(points_of(set, 0, 1).empty());
  }
}

TEST(PointSets, StratifiedHasOneInEachCellOfAnyNumber) {
  for (std::size_t n : {1u, 2u, 3u, 7u, 16u, 31u, 100u, 997u}) {
    const auto points = points_of(PointSet::stratified, n, 9);
    const auto rows = static_cast<std::size_t>(std::round(std::sqrt(double(n))));
    // Cells in order: of equal area, side by side in rows that lie on each other.
    double bottom = 0;
    std::size_t i = 0;
    for (std::size_t row = 0; row < rows; ++row) {
      const std::size_t columns = (n + rows - 1 - row) / rows;
      const double height = double(columns) / double(n);
      for (std::size_t c = 0; c < columns; ++c, ++i) {
        EXPECT_GE(points[i][0], double(c) / double(columns));
        EXPECT_LE(points[i][0], double(c + 1) / double(columns));
        EXPECT_GE(points[i][1], bottom - 1e-15);
        EXPECT_LE(points[i][1], bottom + height + 1e-15);
      }
      bottom += height;
    }
    EXPECT_EQ(i, n);
    EXPECT_NEAR(bottom, 1, 1e-12);
  }
}

TEST(PointSets, HaltonFillsEveryElementaryBox) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const auto points = points_of(PointSet::halton, 2 * 1296, seed);
    for (int a = 0; a <= 4; ++a)
      for (int b = 0; b <= 4; ++b) {
        const int columns = 1 << a, rows = static_cast<int>(std::round(std::pow(3, b))), run = columns * rows;
        for (int first = 0; first + run <= 2 * 1296; first += run) {
          std::set<int> cells;
          for (int i = first; i < first + run; ++i) {
            const Vec2d& p = points[static_cast<std::size_t>(i)];
            cells.insert(static_cast<int>(p[0] * columns) * rows + static_cast<int>(p[1] * rows));
          }
          ASSERT_EQ(static_cast<int>(cells.size()), run) << seed << " " << a << " " << b;
        }
      }
  }
}

TEST(PointSets, R2IsItsRecurrence) {
  const long double g = 1.3247179572447460259609088544780973L;  // the root of x³ = x + 1
  ASSERT_NEAR(static_cast<double>(g * g * g - g - 1), 0, 1e-17);
  const auto points = points_of(PointSet::r2, 100'000, 8);
  for (std::size_t i = 0; i < points.size(); ++i)
    for (int k = 0; k < 2; ++k) {
      const long double at = points[0][k] + static_cast<long double>(i) / (k == 0 ? g : g * g);
      const auto off = static_cast<double>(at - std::floor(at)) - points[i][k];
      ASSERT_NEAR(off - std::round(off), 0, 1e-13) << i;
    }
}

TEST(PointSets, SobolIsTheLibrarysNet) {
  const auto points = points_of(PointSet::sobol_owen, 300, 77);
  for (std::uint32_t i = 0; i < 300; ++i)
    EXPECT_EQ(points[i], (Vec2d{sobol_owen(i, 0, 77), sobol_owen(i, 1, 77)}));
}

/// Root mean square error over seeds of the average of f over n points, and its mean as standard errors.
struct Errors {
  double rms, z;
};
template <class F>
Errors errors(PointSet set, std::size_t n, const F& f, double truth) {
  constexpr int seeds = 200;
  double sum = 0, squares = 0;
  for (std::uint64_t seed = 0; seed < seeds; ++seed) {
    double mean = 0;
    for (const Vec2d& p : points_of(set, n, seed + 1000 * n)) mean += f(p);
    const double e = mean / double(n) - truth;
    sum += e, squares += e * e;
  }
  return {std::sqrt(squares / seeds), sum / std::sqrt(squares)};
}
template <class F>
double slope(PointSet set, const F& f, double truth) {
  const Errors few = errors(set, 64, f, truth), many = errors(set, 4096, f, truth);
  for (const Errors& e : {few, many}) EXPECT_LT(std::abs(e.z), 4) << name_of(set);  // of 20; one in 800 fails
  return std::log(many.rms / few.rms) / std::log(64.0);
}

TEST(PointSets, AveragesAreUnbiasedAndConvergeAtTheRatesOfTheirKind) {
  const auto smooth = [](const Vec2d& p) { return std::exp(p[0] * p[1]) * (1 + std::sin(3 * p[0])); };
  const auto disc = [](const Vec2d& p) { return length2(p) < 0.64 ? 1.0 : 0.0; };
  // By Gauss and Legendre; the quarter disc is of area 0.16 pi.
  double integral = 0;
  constexpr int cells = 400;
  for (int i = 0; i < cells; ++i)
    for (int j = 0; j < cells; ++j)
      for (const double a : {-1 / std::sqrt(3.0), 1 / std::sqrt(3.0)})
        for (const double b : {-1 / std::sqrt(3.0), 1 / std::sqrt(3.0)})
          integral +=
              smooth({(i + 0.5 + 0.5 * a) / cells, (j + 0.5 + 0.5 * b) / cells}) / (4.0 * cells * cells);
  const double area = 0.16 * std::numbers::pi;
  // A slope from 200 seeds is known to 0.02; the bounds leave room for the kinds' own constants.
  EXPECT_NEAR(slope(PointSet::random, smooth, integral), -0.5, 0.06);
  EXPECT_NEAR(slope(PointSet::random, disc, area), -0.5, 0.06);
  EXPECT_NEAR(slope(PointSet::stratified, smooth, integral), -1, 0.08);
  EXPECT_NEAR(slope(PointSet::stratified, disc, area), -0.75, 0.08);
  // Discrepancies of sequences grow as log N / N at most, or 1/6 less than -1 from 64 to 4096; nets' errors
  // for smooth functions fall as N^-3/2.
  EXPECT_LT(slope(PointSet::r2, smooth, integral), -1 + std::log(2.0) / std::log(64.0));
  EXPECT_LT(slope(PointSet::halton, smooth, integral), -0.95);
  EXPECT_LT(slope(PointSet::sobol_owen, smooth, integral), -1.35);
  for (const PointSet set : {PointSet::halton, PointSet::r2, PointSet::sobol_owen})
    EXPECT_LT(slope(set, disc, area), -0.65) << name_of(set);
}

}  // namespace
}  // namespace treeline::test
