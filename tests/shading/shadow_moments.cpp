// Variance, exponential and moment shadow maps: what leaks, against closed forms and independent bounds.
#include <algorithm>
#include <numeric>

#include "shading/shadow/esm.hpp"
#include "shading/shadow/evsm.hpp"
#include "shading/shadow/msm.hpp"
#include "shading/shadow/vsm.hpp"
#include "tests/shading/shadow_common.hpp"

namespace treeline::shading::shadow::test {
namespace {

/// Depths in columns, repeated; nothing else.
DepthMap columns(const std::vector<float>& depths, int size) {
  DepthMap map{parallel_view(), size, size, {}, {}};
  for (int j = 0; j < size; ++j)
    for (int i = 0; i < size; ++i) map.first.push_back(depths[std::size_t(i) % depths.size()]);
  return map;
}
/// A receiver over the centre of a texel in the middle.
Receiver over_a_centre(const DepthMap& map, double z) { return facing(1.0 / map.width, 1.0 / map.height, z); }

struct Layer {
  double depth, share;
};
template <class T>
std::array<T, 4> moments(const std::vector<Layer>& layers) {
  std::array<T, 4> m{};
  for (const Layer& l : layers) {
    const T z = T(l.depth), z2 = z * z;
    m[0] += T(l.share) * z, m[1] += T(l.share) * z2, m[2] += T(l.share) * z2 * z,
        m[3] += T(l.share) * z2 * z2;
  }
  return m;
}

// ---- variance ------------------------------------------------------------------------------------------

TEST(Vsm, TwoLayersLeakAsTheClosedFormSays) {
  for (const double r : {1.0, 0.5, 0.1}) {
    const double a = 0.2, b = 0.4, t = b + r * (b - a);
    double worst = 0, at = 0;
    for (int i = 1; i < 10000; ++i) {
      const double w = i / 10000.0;
      const auto m = moments<double>({{a, w}, {b, 1 - w}});
      const double v = chebyshev(m[0], m[1] - m[0] * m[0], t);
      if (v > worst) worst = v, at = w;
    }
    EXPECT_NEAR(worst, 1 / std::pow(1 + 2 * r, 2), 1e-6);
    EXPECT_NEAR(at, r / (1 + 2 * r), 1e-3);
  }
  // The same on a map: one column of three near, blurred over three; r = 1.
  const DepthMap map = columns({0.2f, 0.4f, 0.4f}, 30);
  const MomentMap<2> variance = make_variance_map(map, {{.radius = 1}, false});
  EXPECT_NEAR(Vsm(variance).visibility(over_a_centre(map, 0.6)), 1 / 9.0, 1e-4);
  EXPECT_NEAR(Vsm(variance, {.leak_cut = 0.12}).visibility(over_a_centre(map, 0.6)), 0, 1e-6);
}

TEST(Vsm, OneBlockerAndOneBackgroundAreExact) {
  // Chebyshev's inequality is met where the background is at the receiver.
  const DepthMap map = columns({0.2f, 0.6f, 0.6f, 0.2f, 0.2f}, 30);
  const MomentMap<2> variance = make_variance_map(map, {{.radius = 2}, false});
  EXPECT_NEAR(Vsm(variance).visibility(over_a_centre(map, 0.6)), 0.4, 1e-4);
}

TEST(Vsm, SlopesWithinTexelsLightATiltedPlane) {
  for (const double angle : {30.0, 70.0, 85.0}) {
    const Plane plane = tilted(angle * degrees, 0.4);
    LightView view = parallel_view();
    view.near = -20, view.far = 20;
    const DepthMap map = filled(view, 256, [&](double x, double y) { return plane.z(x, y); });
    const MomentMap<2> with = make_variance_map(map, {{.radius = 0}, true});
    EXPECT_LT(shadowed_share(Vsm(with, {.least_variance = 1e-9}), plane, 1, 20000, 1), 0.01) << angle;
  }
}

TEST(MomentMap, BlurIsTheMeanOfTheBoxWithinTheMap) {
  Pcg32 random(2);
  const DepthMap map = filled(parallel_view(), 23, [&](double, double) { return random.uniform(0.0, 1.0); });
  for (const int radius : {0, 1, 4, 30})
    for (const int threads : {1, 3}) {
      const MomentMap<4> m = make_four_moment_map(map, {radius, threads});
      for (int y = 0; y < 23; y += 3)
        for (int x = 0; x < 23; ++x) {
          double sum = 0, n = 0;
          for (int j = std::max(0, y - radius); j <= std::min(22, y + radius); ++j)
            for (int i = std::max(0, x - radius); i <= std::min(22, x + radius); ++i)
              sum += std::pow(2.0 * map.first[map.index(i, j)] - 1, 3), ++n;
          ASSERT_NEAR(m.values[4 * map.index(x, y) + 2], sum / n, 1e-5);
        }
    }
}

// ---- exponential ---------------------------------------------------------------------------------------

TEST(Esm, OneBlockerLeaksByItsDistanceAlone) {
  const DepthMap map = columns({0.3f}, 16);
  for (const double c : {20.0, 80.0, 88.0}) {
    const ExponentialMap e = make_exponential_map(map, c, {.radius = 2});
    for (const double d : {0.005, 0.02, 0.1})
      EXPECT_NEAR(Esm(e).visibility(over_a_centre(map, 0.3 + d)), std::exp(-c * d),
                  2e-4 * std::exp(-c * d) + 1e-6);
    EXPECT_EQ(Esm(e).visibility(over_a_centre(map, 0.29)), 1);
  }
  // Behind a third of the filter is light: it outweighs the rest.
  const DepthMap mixed = columns({0.3f, 0.3f, 0.9f}, 30);
  const ExponentialMap e = make_exponential_map(mixed, 80, {.radius = 1});
  EXPECT_EQ(Esm(e).visibility(over_a_centre(mixed, 0.5)), 1);
  EXPECT_THROW(make_exponential_map(map, 90), InvalidScene);
  // Farthest depths do not overflow, however wide the blur.
  const DepthMap clear = columns({1.0f}, 64);
  const ExponentialMap wide = make_exponential_map(clear, 88, {.radius = 30});
  for (const float v : wide.map.values) ASSERT_TRUE(std::isfinite(v));
  const WarpedMap<4> warped = make_warped_map<4>(clear, {42, 42}, {.radius = 30});
  for (const float v : warped.map.values) ASSERT_TRUE(std::isfinite(v));
}

TEST(Evsm, IsChebyshevOfWarpedDepths) {
  Pcg32 random(3);
  for (int n = 0; n < 200; ++n) {
    const float a = random.uniform(0.1f, 0.5f), b = random.uniform(0.5f, 0.9f);
    const DepthMap map = columns({a, b, b}, 30);
    const double t = random.uniform(0.2, 1.0);
    const Exponents c{random.uniform(2.0, 40.0), random.uniform(2.0, 10.0)};
    const auto bound = [&](double k) {  // in double; the mirror for the negative warp
      const auto w = [&](double z) { return (k < 0 ? -1 : 1) * std::exp(k * (2 * z - 1)); };
      const double mean = (w(a) + 2 * w(b)) / 3, variance = (w(a) * w(a) + 2 * w(b) * w(b)) / 3 - mean * mean;
      return chebyshev(mean, variance, w(t));
    };
    const Receiver r = over_a_centre(map, t);
    const EvsmOptions options{.least_deviation = 0};
    const WarpedMap<2> two = make_warped_map<2>(map, c, {.radius = 1});
    const WarpedMap<4> four = make_warped_map<4>(map, c, {.radius = 1});
    ASSERT_NEAR(Evsm<2>(two, options).visibility(r), bound(c.positive), 2e-3);
    ASSERT_NEAR(Evsm<4>(four, options).visibility(r), std::min(bound(c.positive), bound(-c.negative)), 2e-3);
  }
}

// ---- moments -------------------------------------------------------------------------------------------

TEST(Hamburger, TwoDepthsAreExact) {
  Pcg32 random(4);
  for (int n = 0; n < 2000; ++n) {
    const double a = random.uniform(-0.9, 0.0), b = random.uniform(a + 0.1, 0.9),
                 w = random.uniform(0.05, 0.95);
    const auto m = moments<double>({{a, w}, {b, 1 - w}});
    for (const double t : {a - 0.05, 0.5 * (a + b), b + 0.05}) {
      const double truth = t < a ? 0 : t < b ? w : 1;
      ASSERT_NEAR(hamburger(moved_moments(m, 1e-13), t).before, truth, 1e-4) << a << " " << b << " " << t;
      ASSERT_NEAR(hamburger(m, t).before, truth, 1e-4);
    }
  }
}

TEST(Hamburger, IsNeverMoreThanTheTruthAndIsReached) {
  Pcg32 random(5);
  for (int n = 0; n < 5000; ++n) {
    std::vector<Layer> layers(3 + n % 4);
    double sum = 0;
    for (Layer& l : layers)
      l.depth = random.uniform(-1.0, 1.0), l.share = random.uniform(0.05, 1.0), sum += l.share;
    for (Layer& l : layers) l.share /= sum;
    const double t = random.uniform(-1.0, 1.0);
    double truth = 0;
    for (const Layer& l : layers) truth += l.depth < t ? l.share : 0;
    const auto bound = hamburger(moments<double>(layers), t);
    if (!bound.definite) continue;
    ASSERT_LE(bound.before, truth + 1e-6) << n;
    ASSERT_GE(bound.before, 0);
  }
  // Of three depths the one at t is not before it; what is, is told exactly.
  const std::vector<Layer> three{{-0.5, 0.3}, {0.1, 0.45}, {0.7, 0.25}};
  EXPECT_NEAR(hamburger(moments<double>(three), 0.1).before, 0.3, 1e-9);
  EXPECT_NEAR(hamburger(moments<double>(three), 0.7).before, 0.75, 1e-9);
  EXPECT_NEAR(hamburger(moments<double>(three), -0.5).before, 0, 1e-9);
}

/// Mass at t of the distribution that has it there, from the inverse of the 3 x 3 matrix by cofactors.
double mass_at(const std::array<double, 4>& m, double t) {
  const double b[3][3] = {{1, m[0], m[1]}, {m[0], m[1], m[2]}, {m[1], m[2], m[3]}};
  double inverse[3][3], det = 0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
      inverse[j][i] = b[i1][j1] * b[i2][j2] - b[i1][j2] * b[i2][j1];
    }
  for (int j = 0; j < 3; ++j) det += b[0][j] * inverse[j][0];
  const double v[3] = {1, t, t * t};
  double sum = 0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) sum += v[i] * inverse[i][j] * v[j] / det;
  return 1 / sum;
}

TEST(Hamburger, DeepestPointLeaksItsMassInTheInverse) {
  Pcg32 random(6);
  for (int n = 0; n < 2000; ++n) {
    const std::vector<Layer> layers{
        {random.uniform(-0.9, -0.4), 0.3}, {random.uniform(-0.3, 0.1), 0.3}, {random.uniform(0.2, 0.6), 0.4}};
    const double t = layers[2].depth + random.uniform(0.05, 0.4);
    const auto m = moments<double>(layers);
    ASSERT_NEAR(1 - hamburger(m, t).before, mass_at(m, t), 1e-8);
  }
}

TEST(Hamburger, ThreeLayersLeakAtWorstAsTheirLagrangePolynomialsSay) {
  const double figures[][2] = {{1, 0.02}, {0.5, 0.08}, {0.25, 0.22}, {0.1, 0.50}};
  for (const auto& [gap, figure] : figures) {
    // Layers at 0, 1, 2 and the receiver at 2 + gap, mapped into [-1, 1].
    const auto at = [](double z) { return 0.5 * (z - 1.5); };
    const double t = 2 + gap;
    const double l0 = std::abs((t - 1) * (t - 2) / 2), l1 = std::abs(t * (t - 2)),
                 l2 = std::abs(t * (t - 1) / 2);
    const double closed = 1 / std::pow(l0 + l1 + l2, 2);
    EXPECT_NEAR(closed, figure, 0.006);
    double worst = 0;
    for (int i = 1; i < 100; ++i)
      for (int j = 1; i + j < 100; ++j) {
        const auto m =
            moments<double>({{at(0), i / 100.0}, {at(1), j / 100.0}, {at(2), 1 - (i + j) / 100.0}});
        worst = std::max(worst, 1 - hamburger(moved_moments(m, 1e-13), at(t)).before);
      }
    EXPECT_LE(worst, closed + 1e-6);
    EXPECT_NEAR(worst, closed, 0.002) << gap;
    // And at the weights that are as the polynomials', exactly.
    const double l = l0 + l1 + l2;
    const auto m = moments<double>({{at(0), l0 / l}, {at(1), l1 / l}, {at(2), l2 / l}});
    EXPECT_NEAR(1 - hamburger(m, at(t)).before, closed, 1e-9);
    // Two moments leak 1 / (1 + gap)² where the middle layer is none.
    const auto two = moments<double>({{at(0), gap / 2 / (1 + gap)}, {at(2), 1 - gap / 2 / (1 + gap)}});
    EXPECT_NEAR(chebyshev(two[0], two[1] - two[0] * two[0], at(t)), 1 / std::pow(1 + gap, 2), 1e-9);
  }
}

TEST(Msm, LeakOfTwoLayersByMethodOnTheSameSet) {
  // Two layers that hide all light, the receiver .001 to .1 behind the second; truth is 0.
  Pcg32 random(7);
  double vsm = 0, evsm = 0, msm = 0, coarse = 0, exact = 0;
  const int n = 4000;
  for (int i = 0; i < n; ++i) {
    const double a = random.uniform(0.05, 0.85), b = random.uniform(a, 0.88), w = random.uniform(0.05, 0.95);
    const double t = b + random.uniform(0.001, 0.1);
    const auto unsigned_m = moments<double>({{a, w}, {b, 1 - w}});
    const auto m = moments<float>({{2 * a - 1, w}, {2 * b - 1, 1 - w}});
    const auto md = moments<double>({{2 * a - 1, w}, {2 * b - 1, 1 - w}});
    vsm += chebyshev(unsigned_m[0], unsigned_m[1] - unsigned_m[0] * unsigned_m[0], t);
    const auto warped = [&](double k) {
      const auto f = [&](double z) { return (k < 0 ? -1 : 1) * std::exp(k * (2 * z - 1)); };
      const double mean = w * f(a) + (1 - w) * f(b), square = w * f(a) * f(a) + (1 - w) * f(b) * f(b);
      return chebyshev(mean, std::max(0.0, square - mean * mean), f(t));
    };
    evsm += std::min(warped(40), warped(-5));
    msm += 1 - hamburger(moved_moments(m, 3e-7f), float(2 * t - 1)).before;
    coarse += 1 - hamburger(moved_moments(m, 6e-5f), float(2 * t - 1)).before;
    exact += 1 - hamburger(moved_moments(md, 1e-12), 2 * t - 1).before;
  }
  std::cout << "mean leak: vsm " << vsm / n << ", evsm4 " << evsm / n << ", msm 3e-7 " << msm / n << ", 6e-5 "
            << coarse / n << ", double 1e-12 " << exact / n << "\n";
  EXPECT_LT(exact / n, 1e-4);
  EXPECT_LT(msm, evsm);
  EXPECT_LT(evsm, vsm);
  EXPECT_GT(coarse, 2 * msm);
}

TEST(Msm, SignedDepthsStayDefiniteWhereUnsignedDoNot) {
  Pcg32 random(8);
  int of_signed = 0, of_unsigned = 0;
  const int n = 20000;
  for (int i = 0; i < n; ++i) {
    const double a = random.uniform(0.0, 1.0), b = random.uniform(0.0, 1.0), w = random.uniform(0.0, 1.0);
    const float t = random.uniform(0.0f, 1.0f);
    const auto m0 = moments<float>({{a, w}, {b, 1 - w}});
    const auto m1 = moments<float>({{2 * a - 1, w}, {2 * b - 1, 1 - w}});
    // What is usual for depths in [0, 1]: towards those of 0 and 1, half each.
    std::array<float, 4> moved;
    for (std::size_t k = 0; k < 4; ++k) moved[k] = (1 - 3e-7f) * m0[k] + 1.5e-7f;
    of_unsigned += !hamburger(moved, t).definite;
    of_signed += !hamburger(moved_moments(m1, 3e-7f), 2 * t - 1).definite;
  }
  std::cout << "not definite: unsigned " << double(of_unsigned) / n << ", signed " << double(of_signed) / n
            << "\n";
  EXPECT_GT(of_unsigned, n / 10);
  EXPECT_LT(of_signed, n / 50);
}

TEST(Msm, MixedMomentsFillTheirRangeAndComeBack) {
  std::array<float, 4> low{1, 1, 1, 1}, high{};
  for (int i = 0; i <= 2000; ++i) {
    const float z = float(i) / 1000 - 1;
    const std::array<float, 4> m{z, z * z, z * z * z, z * z * z * z}, q = detail::mixed(m),
                                                                      back = detail::unmixed(q);
    for (std::size_t k = 0; k < 4; ++k) {
      low[k] = std::min(low[k], q[k]), high[k] = std::max(high[k], q[k]);
      ASSERT_NEAR(back[k], m[k], 1e-6);
    }
  }
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_NEAR(low[k], 0, 2e-6) << k;
    EXPECT_NEAR(high[k], 1, 2e-6) << k;
  }
}

TEST(Msm, SixteenBitsAreOffByTheirRounding) {
  Pcg32 random(9);
  const DepthMap map = filled(parallel_view(), 40, [&](double x, double) { return x < 0.1 ? 0.3 : 0.8; });
  const MomentMap<4> m = make_four_moment_map(map, {.radius = 3});
  const QuantisedMoments q = quantised(m);
  EXPECT_EQ(2 * q.bytes(), m.bytes());
  const Msm<MomentMap<4>> fine(m, {.alpha = 6e-5});
  const Msm<QuantisedMoments> coarse(q, {.alpha = 6e-5});
  double fine_error = 0, coarse_error = 0;
  for (int i = 0; i < 4000; ++i) {
    const double x = random.uniform(-0.6, 0.6), z = random.uniform(0.4, 0.7);
    // The box of seven texels, interpolated between texels: a ramp from the edge's own texel.
    const double edge = 22;  // texels below 22 are near
    const double v = std::clamp(0.5 + ((x + 1) * 20 - edge) / 7, 0.0, 1.0);
    fine_error = std::max(fine_error, std::abs(fine.visibility(facing(x, 0.01, z)) - v));
    coarse_error = std::max(coarse_error, std::abs(coarse.visibility(facing(x, 0.01, z)) - v));
  }
  EXPECT_LT(fine_error, 0.02);
  EXPECT_LT(coarse_error, 0.04);
}

TEST(MomentMethods, RefuseKnobsThatAreNone) {
  const DepthMap map = columns({0.5f}, 4);
  const MomentMap<2> two = make_variance_map(map);
  const MomentMap<4> four = make_four_moment_map(map);
  EXPECT_THROW(Vsm(two, {.leak_cut = 1}), InvalidScene);
  EXPECT_THROW(Msm<MomentMap<4>>(four, {.alpha = -1}), InvalidScene);
  EXPECT_THROW(make_four_moment_map(map, {.radius = -1}), InvalidScene);
  EXPECT_THROW(make_warped_map<2>(map, {50, 5}), InvalidScene);
  EXPECT_THROW(make_variance_map(DepthMap{}), InvalidScene);
}

}  // namespace
}  // namespace treeline::shading::shadow::test
