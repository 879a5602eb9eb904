// Acne, bias and what bias costs: each against its closed form.
#include "shading/shadow/pcf.hpp"
#include "shading/shadow/second_depth.hpp"
#include "shading/shadow/shadow_map.hpp"
#include "tests/shading/shadow_common.hpp"

namespace treeline::shading::shadow::test {
namespace {

constexpr int side = 256, receivers = 100000;
constexpr double half = 1, texel = 2 * half / side;
/// Five deviations of a share measured on so many receivers.
const double noise = 5 * std::sqrt(0.25 / receivers);

/// The depth range is no longer than the plane takes, so that rounding is small beside a texel's rise.
LightView view_of(const Plane& plane) {
  LightView view = parallel_view(half);
  const double reach = 1.25 * half * (std::abs(plane.gx) + std::abs(plane.gy));
  view.near = plane.base - reach, view.far = plane.base + reach;
  return view;
}
DepthMap map_of(const Plane& plane) {
  return filled(view_of(plane), side, [&](double x, double y) { return plane.z(x, y); });
}
Bias none() { return {.slope = 0}; }

TEST(ShadowBias, AcneWithoutBiasIsHalfAtAnyAngle) {
  for (const double angle : {5.0, 30.0, 60.0, 85.0}) {
    const Plane plane = tilted(angle * degrees, 0);
    const DepthMap map = map_of(plane);
    EXPECT_NEAR(shadowed_share(ShadowMap(map, {none()}), plane, half, receivers, 1), 0.5, noise) << angle;
  }
}

TEST(ShadowBias, ConstantBiasLeavesHalfLessItsShareOfTheTexelsRise) {
  for (const double angle : {45.0, 70.0, 85.0})
    for (const double texels : {0.25, 0.5, 2.0, 5.0}) {
      const Plane plane = tilted(angle * degrees, 0);
      const DepthMap map = map_of(plane);
      Bias bias = none();
      bias.constant = texels * texel / (map.view.far - map.view.near);
      const double expected = std::max(0.0, 0.5 - texels / std::tan(angle * degrees));
      EXPECT_NEAR(shadowed_share(ShadowMap(map, {bias}), plane, half, receivers, 2), expected, noise)
          << angle << " " << texels;
    }
  EXPECT_NEAR(0.5 - 2 / std::tan(85 * degrees), 0.325, 5e-4);
}

TEST(ShadowBias, TheBoundBySlopeIsEnoughAndNoLessIs) {
  Pcg32 random(3);
  for (int n = 0; n < 40; ++n) {
    const int radius = n % 4;
    const Plane plane = tilted(random.uniform(0.2, 1.5), random.uniform(0.0, 7.0));
    const DepthMap map = map_of(plane);
    Bias bias{.slope = 1};
    EXPECT_EQ(shadowed_share(PcfGrid(map, {radius, false, bias}), plane, half, 20000, 4), 0) << n;
    bias.slope = 0.95;
    EXPECT_GT(shadowed_share(PcfGrid(map, {radius, false, bias}), plane, half, 20000, 4), 0) << n;
    bias.slope = 1;
    EXPECT_EQ(shadowed_share(PcfGrid(map, {radius, true, bias}), plane, half, 20000, 4), 0) << n;
    EXPECT_EQ(shadowed_share(PcfDisc(map, {16, 2.5, TapPattern::spiral, true, bias}), plane, half, 20000, 4),
              0);
  }
}

TEST(ShadowBias, TheReceiversPlaneNeedsNoBias) {
  Pcg32 random(5);
  for (int n = 0; n < 40; ++n) {
    const Plane plane = tilted(random.uniform(0.2, 1.5), random.uniform(0.0, 7.0));
    const DepthMap map = map_of(plane);
    const Bias bias{.slope = 0, .receiver_plane = true};
    EXPECT_EQ(shadowed_share(ShadowMap(map, {bias}), plane, half, 20000, 6), 0) << n;
    EXPECT_EQ(shadowed_share(PcfGrid(map, {3, n % 2 == 0, bias}), plane, half, 20000, 6), 0) << n;
    EXPECT_EQ(shadowed_share(PcfDisc(map, {16, 6, TapPattern::poisson, true, bias}), plane, half, 20000, 6),
              0);
    // And it does see what is a hundredth of the map in front of the plane.
    Plane above = plane;
    above.base -= 0.01 * half * std::hypot(plane.gx, plane.gy);
    const DepthMap blocked = filled(view_of(plane), side, [&](double x, double y) { return above.z(x, y); });
    EXPECT_EQ(shadowed_share(PcfGrid(blocked, {3, false, bias}), plane, half, 2000, 6), 1) << n;
  }
}

TEST(ShadowBias, BothHoldInPerspective) {
  Pcg32 random(7);
  for (int n = 0; n < 30; ++n) {
    const LightView view = perspective_view(0.5, 1, 30);
    const Vec3d normal = normalized(Vec3d{random.uniform(-1.5, 1.5), random.uniform(-1.5, 1.5), -1});
    const Vec3d through{0, 0, 6};
    const auto depth = [&](double x, double y) { return dot(normal, through) / dot(normal, Vec3d{x, y, 1}); };
    const DepthMap map = filled(view, 128, [&](double x, double y) {
      const double z = depth(x, y);
      return z > 0 ? z : INFINITY;
    });
    const PcfGrid slope(map, {2, false, {.slope = 1}}),
        plane(map, {2, false, {.slope = 0, .receiver_plane = true}}), plain(map, {2, false, none()});
    double acne = 0;
    for (int i = 0; i < 5000; ++i) {
      const double x = random.uniform(-0.45, 0.45), y = random.uniform(-0.45, 0.45), z = depth(x, y);
      if (!(z > 1.5 && z < 20)) continue;
      const Receiver r{{x * z, y * z, z}, normal};
      ASSERT_EQ(slope.visibility(r), 1) << n;
      ASSERT_EQ(plane.visibility(r), 1) << n;
      acne += 1 - plain.visibility(r);
    }
    EXPECT_GT(acne, 100);
  }
}

TEST(ShadowBias, AnOffsetOfRootHalfATexelSufficesForOneTap) {
  Pcg32 random(8);
  const double enough = std::sqrt(0.5) * (1 + 1e-4);
  for (int n = 0; n < 40; ++n) {
    const Plane plane =
        tilted(random.uniform(0.2, 1.5), n == 0 ? std::numbers::pi / 4 : random.uniform(0.0, 7.0));
    const DepthMap map = map_of(plane);
    Bias bias = none();
    bias.normal_offset = enough;
    EXPECT_EQ(shadowed_share(ShadowMap(map, {bias}), plane, half, 20000, 9), 0) << n;
    bias.normal_offset = 0.95 * enough;
    if (n == 0) {
      EXPECT_GT(shadowed_share(ShadowMap(map, {bias}), plane, half, 20000, 9), 0);
    }
  }
}

/// A wall without thickness, of height 1, on ground z = 0 at x = 0, under light that falls at `theta` towards
/// +x; where on the ground its shadow begins and ends.
struct Wall {
  double theta;
  LightView view;
  DepthMap map;
  double texel;

  explicit Wall(double angle, int size = 4096) : theta(angle) {
    view.forward = {std::sin(theta), 0, -std::cos(theta)}, view.right = {std::cos(theta), 0, std::sin(theta)};
    view.down = cross(view.forward, view.right);
    view.half_width = 2, view.half_height = 2.0 / size, view.near = -10, view.far = 10;
    map = {view, size, 1, {}, {}};
    texel = view.texel_width(size, 0);
    for (int i = 0; i < size; ++i) {
      const double x = (2 * (i + 0.5) / size - 1) * view.half_width;
      const bool wall = x >= 0 && x <= std::sin(theta);
      const double z = wall ? -x / std::tan(theta) : x * std::tan(theta);
      map.first.push_back(float((z - view.near) / (view.far - view.near)));
    }
  }
  /// The first or last x, from the wall's foot on, that the wall shadows.
  double shadow_from(const Bias& bias) const { return edge(bias, true); }
  double shadow_to(const Bias& bias) const { return edge(bias, false); }
  double edge(const Bias& bias, bool first) const {
    const ShadowMap method(map, {bias});
    const double end = std::tan(theta) * 1.1, step = 0.05 * texel;
    for (double x = first ? step : end; first ? x < end : x > 0; x += first ? step : -step)
      if (method.visibility({{x, 0, 0}, {0, 0, 1}}) == 0) return x;
    return -1;
  }
};

TEST(ShadowBias, ConstantBiasOpensAContactGap) {
  for (const double angle : {30.0, 45.0, 60.0}) {
    const Wall wall(angle * degrees);
    const double b = 100 * wall.texel;
    Bias bias = none();
    bias.constant = b / (wall.view.far - wall.view.near);
    // A texel is seen 1 / cos(theta) wide on the ground; the first one may start anywhere.
    const double slack = 1.5 * wall.texel / std::cos(wall.theta);
    EXPECT_NEAR(wall.shadow_from(bias), b * std::sin(wall.theta), slack) << angle;
    EXPECT_NEAR(wall.shadow_to(bias), std::tan(wall.theta), slack) << angle;
  }
}

TEST(ShadowBias, AnOffsetAlongTheNormalCutsTheTipByTheSameLength) {
  for (const double angle : {30.0, 45.0, 60.0}) {
    const Wall wall(angle * degrees);
    Bias bias = none();
    bias.normal_offset = 100;
    const double o = 100 * wall.texel * std::sin(wall.theta);
    const double slack = 1.5 * wall.texel / std::cos(wall.theta);
    EXPECT_NEAR(wall.shadow_from(bias), 0, slack) << angle;
    EXPECT_NEAR(std::tan(wall.theta) - wall.shadow_to(bias), o * std::tan(wall.theta), slack) << angle;
    // The same lift as a constant bias loses as much, at the foot.
    const double b = 100 * wall.texel * std::tan(wall.theta);
    EXPECT_NEAR(o * std::tan(wall.theta), b * std::sin(wall.theta), 1e-12);
  }
}

TEST(SecondDepth, ASlabShowsAcneByItsThickness) {
  for (const double angle : {45.0, 80.0})
    for (const double thickness : {0.0, 0.5, 1.0, 4.0, 12.0}) {  // in texels
      const Plane plane = tilted(angle * degrees, 0);
      DepthMap map = map_of(plane);
      const double share = thickness * texel / (map.view.far - map.view.near);
      for (const float z : map.first) map.second.push_back(z + float(share));
      const DepthMap middle = between_depths(map);
      const double expected = std::max(0.0, 0.5 - thickness / (2 * std::tan(angle * degrees)));
      EXPECT_NEAR(shadowed_share(ShadowMap(middle, {none()}), plane, half, receivers, 10), expected, noise);
    }
}

TEST(SecondDepth, DualDepthIsTheMidpointUpToItsCap) {
  DepthMap map{parallel_view(), 3, 1, {0.2f, 0.2f, 0.2f}, {0.21f, 0.6f, 0.1f}};
  const DepthMap dual = between_depths(map, {SecondDepth::dual, 0.01});
  EXPECT_FLOAT_EQ(dual.first[0], 0.205f);
  EXPECT_FLOAT_EQ(dual.first[1], 0.21f);
  EXPECT_FLOAT_EQ(dual.first[2], 0.2f);
  EXPECT_EQ(between_depths(map, {SecondDepth::second}).first[1], 0.6f);
}

TEST(ShadowMethods, WhatTheMapDoesNotHoldIsLitAndNothingCrashes) {
  const DepthMap map = filled(parallel_view(), 8, [](double, double) { return 0.1; });
  const ShadowMap one(map);
  const PcfGrid grid(map);
  const PcfDisc disc(map);
  EXPECT_EQ(one.visibility(facing(0, 0, 0.5)), 0);
  for (const Vec3d& p : {Vec3d{1.5, 0, 0.5}, Vec3d{0, -1.01, 0.5}, Vec3d{0, 0, 1.5}, Vec3d{0, 0, -0.1},
                         Vec3d{NAN, 0, 0.5}, Vec3d{INFINITY, 0, 0.5}, Vec3d{0, 0, NAN}})
    for (const Vec3d& n : {Vec3d{0, 0, -1}, Vec3d{1, 0, 0}, Vec3d{0, 0, 1}}) {
      EXPECT_EQ(one.visibility({p, n}), 1);
      EXPECT_EQ(grid.visibility({p, n}), 1);
      EXPECT_EQ(disc.visibility({p, n}), 1);
    }
  // Edge on and from behind: an answer in range.
  for (const Vec3d& n : {Vec3d{1, 0, 0}, Vec3d{0, 0, 1}, Vec3d{0.6, 0, 0.8}})
    for (const bool plane : {false, true}) {
      const float v = PcfGrid(map, {2, true, {.receiver_plane = plane}}).visibility({{0, 0, 0.5}, n});
      EXPECT_TRUE(v >= 0 && v <= 1);
    }
  // Taps beyond the border are lit: of 3 x 3 around a corner, five.
  EXPECT_FLOAT_EQ(grid.visibility(facing(0.95, 0.95, 0.5)), 5 / 9.f);
}

TEST(ShadowMethods, ABatchIsItsReceivers) {
  const Plane plane = tilted(1, 0.3);
  const DepthMap map = map_of(plane);
  const ShadowMap method(map, {none()});
  std::vector<Receiver> all;
  Pcg32 random(11);
  for (int i = 0; i < 5000; ++i)
    all.push_back(plane.at(random.uniform(-1.1, 1.1) * half, random.uniform(-1.1, 1.1) * half));
  std::vector<float> one(all.size()), three(all.size());
  shade(method, all, 1, one), shade(method, all, 3, three);
  EXPECT_EQ(one, three);
  for (std::size_t i = 0; i < all.size(); ++i) ASSERT_EQ(one[i], method.visibility(all[i]));
  one.pop_back();
  EXPECT_THROW(shade(method, all, 1, one), InvalidScene);
  EXPECT_THROW(shade(method, all, 0, three), accel::InvalidInput);
}

TEST(ShadowMethods, RefuseMapsAndKnobsThatAreNone) {
  DepthMap map = filled(parallel_view(), 8, [](double, double) { return 0.1; });
  EXPECT_THROW(ShadowMap(map, {{.constant = NAN}}), InvalidScene);
  EXPECT_THROW(PcfGrid(map, {-1, false, {}}), InvalidScene);
  EXPECT_THROW(PcfDisc(map, {0, 1, TapPattern::spiral, false, {}}), InvalidScene);
  EXPECT_THROW(between_depths(map), InvalidScene);
  map.first.pop_back();
  EXPECT_THROW(ShadowMap{map}, InvalidScene);
  map = {};
  EXPECT_THROW(PcfGrid{map}, InvalidScene);
}

}  // namespace
}  // namespace treeline::shading::shadow::test
