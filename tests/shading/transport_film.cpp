// Films: sums that do not stop growing, and estimates against the formulas they stand for.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "geometry/random.hpp"
#include "geometry/sampling.hpp"
#include "shading/transport/cosine_directions.hpp"
#include "shading/transport/film.hpp"
#include "shading/transport/float_sums.hpp"

namespace treeline::shading::transport {
namespace {

TEST(Film, SurvivesAHundredMillionSamples) {
  Film film(1, 1);
  geometry::Pcg32 random(1);
  double exact = 0;  // multiples of 2^-8 below 2^30: every sum is exact
  for (int i = 0; i < 100'000'000; ++i) {
    const float x = static_cast<float>(random.next() >> 24) * 0x1p-8f;
    film.add(0, {x, 1, 0.1f});
    exact += static_cast<double>(x);
  }
  EXPECT_EQ(film.mean(0)[0], exact / 1e8);
  EXPECT_EQ(film.mean(0)[1], 1);
  EXPECT_NEAR(film.mean(0)[2], double(0.1f), 1e-8);
  // Of numbers spread evenly over 0 … 255/256.
  EXPECT_NEAR(film.standard_error(0)[0] * 1e4, std::sqrt((1 - 0x1p-16) / 12), 1e-4);
}

TEST(FloatSums, SomeSurviveAHundredMillionSamples) {
  geometry::Pcg32 random(1);
  PlainSum plain, ones;
  RunningMean running;
  BlockSum blocks;
  KahanSum kahan;
  double exact = 0;  // multiples of 2^-24 below 2^27: to 2^-26 of it
  constexpr int n = 100'000'000;
  for (int i = 0; i < n; ++i) {
    const float x = static_cast<float>(random.next() >> 8) * 0x1p-24f;
    plain.add(x), ones.add(1), running.add(x), blocks.add(x), kahan.add(x);
    exact += static_cast<double>(x);
  }
  const double truth = exact / n;
  EXPECT_EQ(ones.mean(), 16777216.0f / n);
  EXPECT_NEAR(double(plain.mean()), 0.168, 0.001);
  EXPECT_GT(std::abs(double(running.mean()) - truth), 1e-5);
  EXPECT_NEAR(double(running.mean()), truth, 1e-3);
  EXPECT_NEAR(double(blocks.mean()), truth, 1e-6);
  EXPECT_NEAR(double(kahan.mean()), truth, 1e-7);
}

TEST(CosineDirections, AreThoseOfTheLibraryInDouble) {
  constexpr std::size_t n = 4096;
  geometry::Pcg32 random(4);
  std::vector<float> u{0, 0.5f, 0.5f, 0, 0.25f, 0.75f, 0x1.fffffep-1f},
      v{0, 0.5f, 0, 0.5f, 0.75f, 0.75f, 0.5f};
  while (u.size() < n) u.push_back(random.uniform<float>()), v.push_back(random.uniform<float>());
  std::vector<float> x(n), y(n), z(n);
  cosine_directions(n, u.data(), v.data(), x.data(), y.data(), z.data());
  for (std::size_t i = 0; i < n; ++i) {
    const geometry::Vec3d d = geometry::sample_hemisphere_cosine(double(u[i]), double(v[i]));
    ASSERT_NEAR(double(x[i]), d[0], 3e-7) << i;
    ASSERT_NEAR(double(y[i]), d[1], 3e-7) << i;
    ASSERT_NEAR(double(z[i]) * double(z[i]), d[2] * d[2], 6e-7) << i;
  }
}

struct Moments {
  double mean, error, kurtosis, largest_share;
};
Moments by_definition(const std::vector<double>& x, std::size_t set) {
  const double n = static_cast<double>(x.size());
  double sum = 0, largest = 0;
  for (const double v : x) sum += v, largest = std::max(largest, v);
  const double mean = sum / n;
  double second = 0, fourth = 0;
  for (const double v : x) second += std::pow(v - mean, 2) / n, fourth += std::pow(v - mean, 4) / n;
  const std::size_t sets = x.size() / set;
  std::vector<double> means(sets);
  double all = 0, squares = 0;
  for (std::size_t s = 0; s < sets; ++s) {
    for (std::size_t i = 0; i < set; ++i) means[s] += x[s * set + i] / double(set);
    all += means[s] / double(sets);
  }
  for (const double m : means) squares += (m - all) * (m - all);
  return {mean, std::sqrt(squares / double(sets - 1) / double(sets)), fourth / (second * second),
          largest / sum};
}

TEST(Film, EstimatesAreThoseOfTheirDefinitions) {
  geometry::Pcg32 random(2);
  for (const int set : {1, 4}) {
    Film film(2, 1, set);
    std::vector<double> x;
    for (int i = 0; i < 83; ++i) {
      const float v = std::exp(3 * random.uniform<float>());
      x.push_back(double(v));
      film.add(1, {v, v, v});
    }
    const Moments truth = by_definition(x, static_cast<std::size_t>(set));
    EXPECT_NEAR(film.mean(1)[2], truth.mean, 1e-6);
    EXPECT_NEAR(film.standard_error(1)[2], truth.error, 1e-6 * truth.error);
    EXPECT_NEAR(film.kurtosis(1), truth.kurtosis, 1e-4);
    EXPECT_NEAR(film.largest_share(1), truth.largest_share, 1e-6);
    EXPECT_EQ(film.samples(1), 83u);
    EXPECT_EQ(film.samples(0), 0u);
  }
}

TEST(Film, KurtosisOfAlmostEqualSamplesDoesNotCancel) {
  Film film(2, 1);
  geometry::Pcg32 random(3);
  std::vector<double> x;
  for (int i = 0; i < 64; ++i) {
    const float v = 1000 + random.uniform<float>(), same = 0.1f + (i % 3) * 1e-8f;
    x.push_back(double(v));
    film.add(0, {v, v, v}), film.add(1, {same, same, same});
  }
  EXPECT_NEAR(film.kurtosis(0), by_definition(x, 1).kurtosis, 1e-2);
  EXPECT_EQ(film.kurtosis(1), 0);
}

TEST(Film, KnowsNoErrorBeforeTwoSets) {
  Film film(1, 1, 4);
  EXPECT_EQ(film.mean(0)[0], 0);
  EXPECT_EQ(film.kurtosis(0), 0);
  EXPECT_EQ(film.largest_share(0), 0);
  for (int i = 0; i < 8; ++i) {
    EXPECT_TRUE(std::isinf(film.standard_error(0)[0])) << i;
    EXPECT_TRUE(std::isinf(film.relative_error())) << i;
    film.add(0, {1, 1, 1});
  }
  EXPECT_EQ(film.standard_error(0)[0], 0);
  EXPECT_EQ(film.relative_error(), 0);
}

TEST(Film, ImagesHoldMeansAndErrors) {
  Film film(2, 1);
  film.add(0, {1, 2, 3}), film.add(0, {3, 4, 5});
  film.add(1, {1, 1, 1}), film.add(1, {1, 1, 1});
  const Image image = film.image(), errors = film.errors();
  EXPECT_EQ(image.values, (std::vector<float>{2, 3, 4, 1, 1, 1}));
  EXPECT_EQ(errors.values, (std::vector<float>{1, 1, 1, 0, 0, 0}));
  EXPECT_NEAR(film.relative_error(), std::sqrt(0.5) / 2, 1e-12);
}

TEST(Film, RefusesNoPixels) {
  EXPECT_THROW(Film(0, 1), InvalidOptions);
  EXPECT_THROW(Film(1, -1), InvalidOptions);
  EXPECT_THROW(Film(1, 1, 0), InvalidOptions);
}

}  // namespace
}  // namespace treeline::shading::transport
