// Percentage-closer filters: what they average, how many levels they tell apart, and how wide the soft ones
// get against the geometry of real lights.
#include <algorithm>
#include <set>

#include "shading/shadow/pcss.hpp"
#include "tests/shading/shadow_common.hpp"

namespace treeline::shading::shadow::test {
namespace {

/// Depth .2 left of x = edge, nothing right of it.
DepthMap half_plane(int size, double edge) {
  return filled(parallel_view(), size, [=](double x, double) { return x < edge ? 0.2 : INFINITY; });
}

TEST(Pcf, ColumnsBandAStraightEdge) {
  const int size = 64;
  const double texel = 2.0 / size;
  const DepthMap map = half_plane(size, 0);
  for (const int radius : {1, 2, 5}) {
    const PcfGrid method(map, {radius, false, {}});
    const int n = 2 * radius + 1;
    std::set<float> levels;
    double square = 0;
    const int samples = 20000;
    for (int i = 0; i < samples; ++i) {
      const double x = (2 * (i + 0.5) / samples - 1) * 0.5 * n * texel;  // the ramp, and no more
      const float v = method.visibility(facing(x, 0.3, 0.5));
      levels.insert(v);
      square += std::pow(v - (0.5 + x / (n * texel)), 2);
    }
    // n columns: steps of 1 / n, whose ends lie halfway into the ramp's.
    EXPECT_EQ(levels.size(), std::size_t(n + 1));
    EXPECT_NEAR(std::sqrt(square / samples) * std::sqrt(12) * n, 1, 0.02) << radius;
  }
}

TEST(Pcf, NTapsTellNPlusOneLevels) {
  // An edge at an angle, so that no two taps cross it together.
  const DepthMap map =
      filled(parallel_view(), 512, [](double x, double y) { return x + 0.37 * y < 0 ? 0.2 : INFINITY; });
  for (const int n : {4, 16, 25}) {
    std::set<float> levels;
    const PcfDisc method(map, {n, 40, TapPattern::spiral, false, {}});
    Pcg32 random(1);
    for (int i = 0; i < 40000; ++i)
      levels.insert(method.visibility(facing(random.uniform(-0.3, 0.3), random.uniform(-0.3, 0.3), 0.5)));
    EXPECT_EQ(levels.size(), std::size_t(n + 1));
  }
}

/// Area of the map's shadowed texels in a square, by overlaps, in double.
double shadowed_area(const DepthMap& map, double x, double y, double side, double z) {
  double sum = 0;
  for (int j = 0; j < map.height; ++j)
    for (int i = 0; i < map.width; ++i) {
      const double w = std::min(x + side / 2, i + 1.0) - std::max(x - side / 2, double(i));
      const double h = std::min(y + side / 2, j + 1.0) - std::max(y - side / 2, double(j));
      if (w > 0 && h > 0 && map.first[map.index(i, j)] < z) sum += w * h;
    }
  return sum / (side * side);
}

TEST(Pcf, SmoothIsTheExactShareOfItsSquare) {
  Pcg32 random(2);
  const DepthMap map = filled(parallel_view(), 24, [&](double, double) { return random.uniform(0.0, 1.0); });
  for (const int radius : {0, 1, 3})
    for (int i = 0; i < 2000; ++i) {
      const double x = random.uniform(0.0, 24.0), y = random.uniform(0.0, 24.0);
      const float v = PcfGrid(map, {radius, true, {}}).visibility(facing(x / 12 - 1, y / 12 - 1, 0.5));
      ASSERT_NEAR(v, 1 - shadowed_area(map, x, y, 2 * radius + 1, 0.5 - 1e-6), 2e-6) << x << " " << y;
    }
}

TEST(Pcf, DiscsConvergeToTheShareOfTheirArea) {
  const DepthMap map = half_plane(512, 0);
  for (const TapPattern pattern : {TapPattern::spiral, TapPattern::poisson, TapPattern::square}) {
    const PcfDisc method(map, {512, 64, pattern, true, {}});
    double worst = 0;
    for (int i = 0; i < 500; ++i) {
      const double x = (2 * (i + 0.5) / 500 - 1), v = method.visibility(facing(x / 4, 0.013 * i / 500, 0.5));
      const double truth = pattern == TapPattern::square
                               ? 0.5 + x / 2
                               : 0.5 + (x * std::sqrt(1 - x * x) + std::asin(x)) / std::numbers::pi;
      worst = std::max(worst, std::abs(v - truth));
    }
    EXPECT_LT(worst, pattern == TapPattern::poisson ? 0.06 : 0.02) << int(pattern);
  }
}

TEST(Taps, LieWhereTheyShouldAndTurnWithinIt) {
  for (const TapPattern pattern : {TapPattern::spiral, TapPattern::poisson, TapPattern::square})
    for (const Tap& t : taps(pattern, 64))
      for (std::uint32_t hash : {0u, 1u, 0xdeadbeefu, 0xffffffffu}) {
        const bool disc = pattern != TapPattern::square;
        const Tap q = detail::TapFrame(disc, true, hash, {1, 0}, {0, 1})(t);
        if (disc)
          ASSERT_LE(q.x * q.x + q.y * q.y, 1 + 1e-6f);
        else
          ASSERT_LE(std::max(std::abs(q.x), std::abs(q.y)), 1.0f);
      }
  EXPECT_THROW(taps(TapPattern::spiral, 0), InvalidScene);
}

// ---- soft shadows --------------------------------------------------------------------------------------

const LightView lamp_view = perspective_view(0.5, 1, 11);

PcssOptions dense() {
  PcssOptions o;
  o.search_taps = 256, o.filter_taps = 512;
  return o;
}

struct Penumbra {
  double rmse, worst, width;  ///< width: from 10 to 90 percent, divided by what it is of a whole ramp
};
/// Of a visibility, averaged over so many rows, and its truth over x in [-reach, reach], at distance d_r.
template <class Truth>
Penumbra measured(const Pcss& method, double reach, double ramp, Truth&& truth, int rows = 8) {
  const int n = 4000;
  double square = 0, worst = 0, first = NAN, last = NAN, count = 0;
  for (int i = 0; i < n; ++i) {
    const double x = (2 * (i + 0.5) / n - 1) * reach;
    double v = 0;
    for (int k = 0; k < rows; ++k) v += method.visibility(facing(x, 0.37 * k - 1.3, d_r)) / rows;
    const double t = truth(x);
    if (t > 0 && t < 1) square += std::pow(v - t, 2), ++count;
    worst = std::max(worst, std::abs(v - t));
    if (v < 0.1) first = x;
    if (v < 0.9) last = x;
  }
  return {std::sqrt(square / count), worst, (last - first) / (0.8 * ramp)};
}

TEST(Pcss, PenumbraOfParallelPlanesIsAsWideAsTheFormulaSays) {
  for (const double d_b : {4.0, 7.0, 9.0}) {
    const double w_l = 0.6, w = (d_r - d_b) * w_l / d_b;
    const DepthMap map = filled(lamp_view, 1024, [=](double x, double) { return x < 0 ? d_b : d_r; });
    const auto truth = [=](double x) { return std::clamp(0.5 + x / w, 0.0, 1.0); };
    const Penumbra right = measured(Pcss(map, square_light(w_l / 2), dense()), w, w, truth);
    EXPECT_NEAR(right.width, 1, 0.05) << d_b;
    EXPECT_LT(right.rmse, 0.02) << d_b;
    // Samples over [-1, 1] times the whole width.
    PcssOptions wrong = dense();
    wrong.width = Width::whole;
    const Penumbra twice = measured(Pcss(map, square_light(w_l / 2), wrong), 2 * w, w, truth);
    EXPECT_NEAR(twice.width, 2, 0.25) << d_b;
    EXPECT_GT(twice.rmse, 0.1) << d_b;
  }
}

TEST(Pcss, SunsPenumbraGrowsWithDistanceAlone) {
  Light sun;
  sun.direction = {0, 0, 1}, sun.angle = 0.05;
  LightView view = parallel_view(2);
  view.far = 11;
  for (const double d_b : {2.0, 6.0}) {
    const DepthMap map = filled(view, 1024, [=](double x, double) { return x < 0 ? d_b : d_r; });
    const double r = std::tan(sun.angle) * (d_r - d_b);
    const auto truth = [=](double x) {
      const double t = std::clamp(x / r, -1.0, 1.0);
      return 0.5 + (t * std::sqrt(1 - t * t) + std::asin(t)) / std::numbers::pi;
    };
    EXPECT_LT(measured(Pcss(map, sun, dense()), r, 2 * r, truth).rmse, 0.02) << d_b;
  }
}

TEST(Pcss, MeanOfTwoBlockersIsNeither) {
  // Edges at depths 2 and 9, each hiding the light from its side: the far one's penumbra is narrow, the near
  // one's wide, and the mean's neither.
  const double w_l = 1;
  const auto seen_from = [&](double edge, double z, double x, double side) {
    // Of the light's [-w_l/2, w_l/2], what passes the edge at x = edge, z.
    const double at = (edge * d_r - x * z) / (d_r - z) / w_l;  // the light's point behind the edge
    return std::clamp(side * at + 0.5, 0.0, 1.0);
  };
  // Both hide what is to their left; the near one as far as x = -1 in its plane.
  const double near_edge = -0.3, far_edge = 0.5;
  const DepthMap map = filled(lamp_view, 2048, [&](double x, double) {
    return x * 2 < near_edge ? 2 : x * 9 < far_edge ? 9 : d_r;
  });
  const auto truth = [&](double x) {
    // Lines to the light at u pass depth z at u + (x - u) z / d_r: to the right of the edge are those with
    // u above `at`; that is less than all of the light.
    return std::min(seen_from(near_edge, 2, x, -1), seen_from(far_edge, 9, x, -1));
  };
  const Penumbra both = measured(Pcss(map, square_light(w_l / 2), dense()), 3, 1, truth);
  EXPECT_GT(both.rmse, 0.1);
  EXPECT_GT(both.worst, 0.3);
  for (const auto& [edge, z] : {std::pair{near_edge, 2.0}, {far_edge, 9.0}}) {
    const DepthMap one = filled(lamp_view, 2048, [&](double x, double) { return x * z < edge ? z : d_r; });
    const auto alone = [&](double x) { return seen_from(edge, z, x, -1); };
    EXPECT_LT(measured(Pcss(one, square_light(w_l / 2), dense()), 3, 1, alone).rmse, 0.03) << z;
  }
  RecordProperty("rmse", std::to_string(both.rmse));
  std::cout << "two blockers: rmse " << both.rmse << ", worst " << both.worst << "\n";
}

TEST(Pcss, SearchMissesANarrowBlocker) {
  // A strip .05 wide, 1 in front of the receiver, hides half of the light from behind its middle.
  const double w_l = 1, strip = 0.05;
  const DepthMap map =
      filled(lamp_view, 2048, [&](double x, double) { return std::abs(9 * x) < strip / 2 ? 9 : d_r; });
  const auto truth = [&](double x) {
    const auto hidden = [&](double at) { return std::clamp((at * d_r - x * 9) / w_l + 0.5, 0.0, 1.0); };
    return 1 - (hidden(strip / 2) - hidden(-strip / 2));
  };
  const Penumbra p = measured(Pcss(map, square_light(w_l / 2)), 0.1, 1, truth, 1);
  EXPECT_NEAR(p.worst, 0.5, 0.05);
  EXPECT_GT(p.rmse, 0.25);
  std::cout << "missed strip: rmse " << p.rmse << ", worst " << p.worst << "\n";
}

TEST(Pcss, NothingNearerIsLitAndLightsWithoutExtentAreHard) {
  const DepthMap map = filled(lamp_view, 256, [](double x, double) { return x < 0 ? 5 : d_r; });
  const Pcss soft(map, square_light(0.3));
  EXPECT_EQ(soft.visibility(facing(4, 0, d_r)), 1);
  EXPECT_EQ(soft.visibility(facing(-3, 0, d_r)), 0);
  EXPECT_EQ(soft.visibility(facing(0, 0, 4)), 1);
  Light spot;
  spot.kind = LightKind::spot, spot.direction = {0, 0, 1}, spot.angle = 0.4;
  const Pcss hard(map, spot);
  EXPECT_EQ(hard.visibility(facing(0.2, 0, d_r)), 1);
  EXPECT_EQ(hard.visibility(facing(-0.2, 0, d_r)), 0);
  Light sun;
  EXPECT_THROW(Pcss(map, sun), InvalidScene);
}

TEST(LightExtent, IsTheLightThroughAPinhole) {
  // Rays from a receiver to random points of a light, where they pass a depth, in shares of the map.
  Light light = square_light(0.4);
  light.u = {0.3, 0.1, 0}, light.v = {-0.1, 0.3, 0};
  const LightExtent extent(light, lamp_view);
  Pcg32 random(3);
  for (int i = 0; i < 100; ++i) {
    const double a = random.uniform(-1.0, 1.0), b = random.uniform(-1.0, 1.0), z = random.uniform(2.0, 9.0);
    const Vec3d receiver{random.uniform(-2.0, 2.0), random.uniform(-2.0, 2.0), 10};
    const Vec3d on_light = light.u * a + light.v * b;
    const auto q = lamp_view.place(on_light + (receiver - on_light) * (z / 10));
    const auto p = lamp_view.place(receiver);
    const double scale = extent.scale(p.depth, q.depth);
    EXPECT_NEAR(q.x - p.x, scale * extent.offset_x(a, b), 1e-12);
    EXPECT_NEAR(q.y - p.y, scale * extent.offset_y(a, b), 1e-12);
  }
}

}  // namespace
}  // namespace treeline::shading::shadow::test
