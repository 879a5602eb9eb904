// What a footprint covers of each texel: areas and moments in closed form, and samples as a second witness.
#include "tests/shading/texture_common.hpp"

namespace treeline::shading::texture {
namespace {

struct Moments {
  double area = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0;
};

/// Of the covered parts, each taken for its texel's centre: mean and covariance but for the parts' own.
Moments moments(const Footprint& f) {
  Moments m;
  m.area = for_each_texel(f, [&](double i, double j, double w) {
    const double dx = i + 0.5 - f.x, dy = j + 0.5 - f.y;
    m.x += w * dx, m.y += w * dy, m.xx += w * dx * dx, m.xy += w * dx * dy, m.yy += w * dy * dy;
  });
  for (double* v : {&m.x, &m.y, &m.xx, &m.xy, &m.yy}) *v /= m.area;
  return m;
}

TEST(TextureCoverage, AreasAreThoseOfTheFootprint) {
  geometry::Pcg32 random(3);
  for (int k = 0; k < 300; ++k) {
    const double x = random.uniform(-20.0, 20.0), y = random.uniform(-20.0, 20.0);
    const double a = random.uniform(0.05, 15.0), b = random.uniform(0.05, 15.0),
                 turn = random.uniform(0.0, 7.0);
    EXPECT_NEAR(moments(box_footprint({x - a, y - b, x + a, y + b})).area, 4 * a * b, 1e-10);
    EXPECT_NEAR(moments(rotated_box(x, y, a, b, turn)).area, 4 * a * b, 1e-9);
    EXPECT_NEAR(moments(disc_footprint(x, y, a)).area, std::numbers::pi * a * a, 1e-9);
    const double kept = std::erf(gaussian_reach / std::numbers::sqrt2);
    EXPECT_NEAR(moments(gaussian_footprint(x, y, a, b)).area, kept * kept, 1e-12);
  }
}

TEST(TextureCoverage, NoTexelIsCoveredByMoreThanItselfNorTwice) {
  geometry::Pcg32 random(4);
  for (int k = 0; k < 100; ++k) {
    const Footprint f =
        k % 2 ? disc_footprint(random.uniform(-5.0, 5.0), random.uniform(-5.0, 5.0), random.uniform(0.1, 9.0))
              : rotated_box(random.uniform(-5.0, 5.0), random.uniform(-5.0, 5.0), random.uniform(0.1, 9.0),
                            random.uniform(0.1, 9.0), random.uniform(0.0, 7.0));
    std::vector<std::pair<double, double>> seen;
    for_each_texel(f, [&](double i, double j, double w) {
      EXPECT_LE(w, 1 + 1e-12);
      EXPECT_GE(w, 0);
      seen.push_back({i, j});
    });
    std::ranges::sort(seen);
    EXPECT_EQ(std::ranges::adjacent_find(seen), seen.end());
  }
}

TEST(TextureCoverage, LargeFootprintsHaveTheirMoments) {
  // A texel's own variance, 1/12, is in neither; it is small beside these.
  for (const double turn : {0.0, 0.4, 1.1, 2.5}) {
    const Moments m = moments(rotated_box(0.3, 0.7, 60, 20, turn));
    const double c = std::cos(turn), s = std::sin(turn), u = 3600 / 3.0, v = 400 / 3.0;
    EXPECT_NEAR(m.x, 0, 1e-3);
    EXPECT_NEAR(m.y, 0, 1e-3);
    EXPECT_NEAR(m.xx, u * c * c + v * s * s, 0.2);
    EXPECT_NEAR(m.yy, u * s * s + v * c * c, 0.2);
    EXPECT_NEAR(m.xy, (u - v) * s * c, 0.2);
  }
  const Moments disc = moments(disc_footprint(0.3, 0.7, 40));
  EXPECT_NEAR(disc.xx, 400, 0.2);
  EXPECT_NEAR(disc.xy, 0, 1e-3);
  const Moments bell = moments(gaussian_footprint(0.3, 0.7, 20, 10));
  EXPECT_NEAR(bell.xx, 0.97333692 * 400, 0.2);
  EXPECT_NEAR(bell.yy, 0.97333692 * 100, 0.2);
}

TEST(TextureCoverage, BruteForceAgreesWithSamples) {
  const Image image = random_levels(37, 29, 3, 9);
  const BruteForce brute(image);
  geometry::Pcg32 random(5);
  for (int k = 0; k < 60; ++k) {
    const double x = random.uniform(-6.0, 43.0),
                 y = random.uniform(-6.0, 35.0);  // some reach over the border
    const double a = random.uniform(0.3, 6.0), b = random.uniform(0.3, 6.0), turn = random.uniform(0.0, 7.0);
    const Footprint all[] = {box_footprint({x - a, y - b, x + a, y + b}), rotated_box(x, y, a, b, turn),
                             disc_footprint(x, y, a), gaussian_footprint(x, y, 0.3 * a, 0.3 * b)};
    for (const Footprint& f : all) {
      const auto found = mean_of(brute, f);
      for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(double(found[std::size_t(c)]), sampled_mean(image, f, c, 400), 4e-3)
            << int(f.shape) << " " << k;
    }
  }
}

TEST(TextureCoverage, RunsOfTexelsAreTheInterval) {
  geometry::Pcg32 random(6);
  for (int k = 0; k < 2000; ++k) {
    const int n = 1 + static_cast<int>(random.below(9));
    const double low = random.uniform(-3.0, 12.0),
                 high = low + (k % 3 ? random.uniform(0.0, 9.0) : random.below(3));
    const TexelRuns runs = texel_runs(low, high, n);
    double sum = 0, first_moment = 0, expected = 0;
    for (std::size_t r = 0; r < 3; ++r) {
      ASSERT_LE(0, runs.edge[r]);
      ASSERT_LE(runs.edge[r + 1], n);
      for (int i = runs.edge[r]; i < runs.edge[r + 1]; ++i)
        sum += runs.weight[r], first_moment += runs.weight[r] * i;
    }
    EXPECT_NEAR(sum, 1, 1e-12);
    // The mean of the texel's number over the interval, by its integral.
    const auto integral = [&](double t) {  // of clamp(floor(s), 0, n - 1) from 0 to t
      if (t <= 0) return 0.0;
      const double f = std::min(std::floor(t), n - 1.0);
      return f * (f - 1) / 2 + (t - f) * f;
    };
    expected = high > low ? (integral(high) - integral(low)) / (high - low)
                          : std::clamp(std::floor(low), 0.0, n - 1.0);
    EXPECT_NEAR(first_moment, expected, 1e-9 * n / std::max(high - low, 1e-3))
        << low << " " << high << " " << n;
  }
}

}  // namespace
}  // namespace treeline::shading::texture
