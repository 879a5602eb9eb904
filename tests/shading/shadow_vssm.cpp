// Variance soft shadow maps: what the statistics say about blockers, where that is wrong, and how exact the
// tables are.
#include <algorithm>

#include "shading/shadow/pcss.hpp"
#include "shading/shadow/vssm.hpp"
#include "tests/shading/shadow_common.hpp"

namespace treeline::shading::shadow::test {
namespace {

/// A share q of depth a, the rest of depth background.
DepthStatistics two(double q, double a, double background) {
  return {q * a + (1 - q) * background, q * (1 - q) * (background - a) * (background - a)};
}

TEST(Vssm, BlockersAreExactWhereTheRestIsAtTheReceiver) {
  Pcg32 random(1);
  for (int n = 0; n < 1000; ++n) {
    const double a = random.uniform(0.0, 0.5), t = random.uniform(0.55, 1.0), q = random.uniform(0.05, 0.95);
    const Occlusion o = occlusion(two(q, a, t), t);
    ASSERT_NEAR(o.share, q, 1e-12);
    ASSERT_NEAR(o.mean, a, 1e-10);
  }
}

TEST(Vssm, ABackgroundBehindTheReceiverDrawsBlockersTowardsTheLight) {
  const double a = 0.3, t = 0.6;
  const Occlusion o = occlusion(two(0.7, a, 0.8), t);
  EXPECT_NEAR(o.mean, 0.10, 1e-9);
  EXPECT_NEAR((t - o.mean) / o.mean, 5, 1e-6);  // the penumbra over the light; true is 1
  EXPECT_NEAR((t - a) / a, 1, 1e-12);
  EXPECT_LT(occlusion(two(0.7, a, 1.0), t).mean, 0);
}

TEST(Vssm, TheMeanHidesBlockersUpToItsShare) {
  // a = .45, t = .5, background 1: the mean is behind the receiver while q < (F - t) / (F - a) = .91.
  const double a = 0.45, t = 0.5, f = 1, limit = (f - t) / (f - a);
  EXPECT_NEAR(limit, 0.909, 1e-3);
  EXPECT_GT(two(limit - 1e-6, a, f).mean, t);
  EXPECT_LT(two(limit + 1e-6, a, f).mean, t);
}

// ---- tables --------------------------------------------------------------------------------------------

TEST(VarianceSums, AreThoseOfTheBoxWithItsFractions) {
  Pcg32 random(2);
  const int size = 40;
  const DepthMap map =
      filled(parallel_view(), size, [&](double, double) { return random.uniform(0.0, 1.0); });
  const VarianceSums sums(map, false);
  for (int n = 0; n < 500; ++n) {
    const double x0 = random.uniform(0.0, 30.0), y0 = random.uniform(0.0, 30.0);
    const TexelBox box{x0, x0 + random.uniform(0.05, 9.0), y0, y0 + random.uniform(0.05, 9.0)};
    double area = 0, mean = 0, square = 0;
    for (int j = 0; j < size; ++j)
      for (int i = 0; i < size; ++i) {
        const double w = std::min(box.x1, i + 1.0) - std::max(box.x0, double(i));
        const double h = std::min(box.y1, j + 1.0) - std::max(box.y0, double(j));
        if (!(w > 0 && h > 0)) continue;
        const double z = map.first[map.index(i, j)];
        area += w * h, mean += w * h * z, square += w * h * z * z;
      }
    mean /= area, square /= area;
    const DepthStatistics s = sums.over(box);
    ASSERT_NEAR(s.mean, mean, 1e-9);
    ASSERT_NEAR(s.variance, square - mean * mean, 1e-9);
  }
  // Boxes that stick out, or have no area, do not crash and stay in range.
  for (const TexelBox& box : {TexelBox{-5, -4, 3, 4}, {39.5, 90, -3, 100}, {7, 7, 7, 7}, {40, 41, 40, 41}}) {
    const DepthStatistics s = sums.over(box);
    EXPECT_TRUE(s.mean >= -1e-6 && s.mean <= 1 + 1e-6 && s.variance >= 0);
  }
}

TEST(VarianceSums, FloatSumsLoseTheVarianceOfAPlaneAndDoublesDoNot) {
  const int size = 1024, window = 9;
  const DepthMap map = filled(parallel_view(), size, [](double x, double) { return 0.5 + 0.5 * x; });
  const VarianceSums sums(map, false);
  std::vector<float> m1(std::size_t(size + 1) * (size + 1)), m2 = m1;
  const auto at = [&](int x, int y) { return std::size_t(y) * (size + 1) + std::size_t(x); };
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) {
      const float z = map.first[map.index(x, y)];
      m1[at(x + 1, y + 1)] = z + m1[at(x, y + 1)] + m1[at(x + 1, y)] - m1[at(x, y)];
      m2[at(x + 1, y + 1)] = z * z + m2[at(x, y + 1)] + m2[at(x + 1, y)] - m2[at(x, y)];
    }
  const double truth = (window * window - 1) / 12.0 / (double(size) * size);  // of 9 even steps of 1 / size
  Pcg32 random(3);
  double worst = 0, square = 0;
  int negative = 0;
  const int n = 4000;
  for (int i = 0; i < n; ++i) {
    const int x = int(random.below(size - window)), y = size / 2 + int(random.below(size / 2 - window));
    worst = std::max(
        worst,
        std::abs(sums.over({double(x), double(x + window), double(y), double(y + window)}).variance - truth));
    const auto mean = [&](const std::vector<float>& m) {
      return (m[at(x + window, y + window)] - m[at(x, y + window)] - m[at(x + window, y)] + m[at(x, y)]) /
             float(window * window);
    };
    const double v = mean(m2) - mean(m1) * mean(m1);
    square += (v - truth) * (v - truth), negative += v < 0;
  }
  EXPECT_LT(worst, 0.01 * truth);
  EXPECT_GT(std::sqrt(square / n), 100 * truth);
  EXPECT_GT(negative, n / 4);
  std::cout << "variance " << truth << ": doubles off by " << worst << ", floats by " << std::sqrt(square / n)
            << ", negative " << double(negative) / n << "\n";
}

TEST(DepthPyramid, BoundsEveryTexelOfTheBox) {
  Pcg32 random(4);
  for (const int size : {1, 7, 32, 45}) {
    const DepthMap map =
        filled(parallel_view(), size, [&](double, double) { return random.uniform(0.0, 0.9); });
    const DepthPyramid pyramid(map);
    for (int n = 0; n < 500; ++n) {
      const double x0 = random.uniform(-3.0, size + 1.0), y0 = random.uniform(-3.0, size + 1.0);
      const TexelBox box{x0, x0 + random.uniform(0.0, 20.0), y0, y0 + random.uniform(0.0, 20.0)};
      const auto [low, high] = pyramid.over(box);
      for (int j = 0; j < size; ++j)
        for (int i = 0; i < size; ++i)
          if (box.x0 < i + 1 && box.x1 > i && box.y0 < j + 1 && box.y1 > j) {
            ASSERT_LE(low, map.first[map.index(i, j)]);
            ASSERT_GE(high, map.first[map.index(i, j)]);
          }
      if (box.x0 < 0) {
        ASSERT_EQ(high, 1);
      }
    }
  }
}

// ---- the method ----------------------------------------------------------------------------------------

const LightView far_lamp_view = perspective_view(0.5, 1, 21);

struct Tables {
  DepthMap map;
  VarianceSums sums;
  DepthPyramid pyramid;
  explicit Tables(DepthMap m) : map(std::move(m)), sums(map), pyramid(map) {}
  Vssm method(double w_l, const VssmOptions& options = {}) const {
    return {map, sums, &pyramid, square_light(w_l / 2), options};
  }
};

TEST(Vssm, ParallelPlanesHaveTheExactPenumbra) {
  for (const double d_b : {4.0, 7.0, 9.0}) {
    const double w_l = 0.6, w = (d_r - d_b) * w_l / d_b;
    const Tables t(filled(far_lamp_view, 1024, [=](double x, double) { return x < 0 ? d_b : d_r; }));
    for (const BelowMean kind : {BelowMean::lit, BelowMean::formula, BelowMean::cut}) {
      const Vssm method = t.method(w_l, {.below_mean = kind});
      double square = 0;
      const int n = 2000;
      for (int i = 0; i < n; ++i) {
        const double x = (2 * (i + 0.5) / n - 1) * 0.5 * w;
        square += std::pow(method.visibility(facing(x, 0.2, d_r)) - (0.5 + x / w), 2);
      }
      EXPECT_LT(std::sqrt(square / n), 0.03) << d_b << " " << int(kind);
      EXPECT_EQ(method.visibility(facing(2, 0, d_r)), 1);
      EXPECT_NEAR(method.visibility(facing(-2, 0, d_r)), 0, 1e-3);
    }
  }
}

TEST(Vssm, CuttingFindsWhatTheMeanHides) {
  // A floor far behind shows past the blocker: the mean over the box is behind the receiver, the blocker
  // hides three quarters of the light.
  const double d_b = 9, w_l = 0.9, w = (d_r - d_b) * w_l / d_b, x = -0.25 * w;
  const Tables t(filled(far_lamp_view, 2048, [=](double a, double) { return a < 0 ? d_b : 20.9; }));
  const Receiver r = facing(x, 0.2, d_r);
  EXPECT_EQ(t.method(w_l, {.below_mean = BelowMean::lit, .early = false}).visibility(r), 1);
  EXPECT_NEAR(t.method(w_l, {.below_mean = BelowMean::cut, .parts = 16}).visibility(r), 0.25, 0.08);
}

TEST(Vssm, EarlyAnswersAreThoseOfTheTables) {
  Pcg32 random(5);
  const Tables t(filled(far_lamp_view, 256, [](double x, double y) {
    return std::hypot(x, y) < 0.15 ? 6 : x + y > 0.5 ? 3 : d_r;
  }));
  const Vssm early = t.method(0.5, {.early = true}), late = t.method(0.5, {.early = false});
  int sure = 0;
  for (int i = 0; i < 3000; ++i) {
    const Receiver r = facing(random.uniform(-4.5, 4.5), random.uniform(-4.5, 4.5), d_r);
    const float a = early.visibility(r), b = late.visibility(r);
    ASSERT_TRUE(a >= 0 && a <= 1);
    // Chebyshev's bound is above the truth, which the pyramid tells where it is 0.
    ASSERT_NEAR(a, b, 0.02);
    sure += a == 0 || a == 1;
  }
  EXPECT_GT(sure, 1500);
}

TEST(Vssm, ALitTiltedPlaneStaysLit) {
  LightView view = parallel_view(2);
  view.near = -20, view.far = 20;
  Light sun;
  sun.direction = {0, 0, 1}, sun.angle = 0.02;
  for (const double angle : {0.0, 40.0, 75.0}) {
    const Plane plane = tilted(angle * degrees, 0.3);
    const DepthMap map = filled(view, 512, [&](double x, double y) { return plane.z(x, y); });
    const VarianceSums sums(map);
    const DepthPyramid pyramid(map);
    for (const bool early : {false, true}) {
      const Vssm method(map, sums, &pyramid, sun, {.early = early});
      EXPECT_LT(shadowed_share(method, plane, 2, 5000, 6), 0.02) << angle;
    }
  }
}

TEST(Vssm, RefusesWhatItCannotTake) {
  const Tables t(filled(far_lamp_view, 16, [](double, double) { return 5; }));
  EXPECT_THROW(Vssm(t.map, t.sums, nullptr, square_light(1)), InvalidScene);
  EXPECT_THROW(t.method(1, {.parts = 0}), InvalidScene);
  EXPECT_NO_THROW(Vssm(t.map, t.sums, nullptr, square_light(1), {.early = false}));
}

}  // namespace
}  // namespace treeline::shading::shadow::test
