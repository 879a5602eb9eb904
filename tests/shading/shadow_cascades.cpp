// Cascades: where they split, what each holds, and that texels stay where they are as the camera moves.
#include <algorithm>

#include "shading/shadow/cascades.hpp"
#include "shading/shadow/pcf.hpp"
#include "tests/shading/shadow_common.hpp"

namespace treeline::shading::shadow::test {
namespace {

/// Texels of depth that slices need to be as dense, on the screen, as at their near ends.
double depth_texels(const std::vector<double>& splits) {
  double sum = 0;
  for (std::size_t i = 0; i + 1 < splits.size(); ++i) sum += (splits[i + 1] - splits[i]) / splits[i];
  return sum;
}

TEST(Cascades, FourLogarithmicOnesNeedAFiftiethOfOne) {
  EXPECT_NEAR(depth_texels(practical_splits(1, 1000, 1, 1)), 999, 1e-9);
  EXPECT_NEAR(depth_texels(practical_splits(1, 1000, 4, 1)), 18.5, 0.01);
  EXPECT_NEAR(depth_texels(practical_splits(1, 1000, 4, 1)), 4 * (std::pow(1000, 0.25) - 1), 1e-9);
  // No other splits need less.
  for (const double lambda : {0.0, 0.5, 0.9, 0.99})
    EXPECT_GT(depth_texels(practical_splits(1, 1000, 4, lambda)), 18.5);
}

TEST(Cascades, SplitsBlendTheGeometricAndTheArithmeticSeries) {
  const auto arithmetic = practical_splits(2, 50, 3, 0), geometric = practical_splits(2, 50, 3, 1),
             half = practical_splits(2, 50, 3, 0.5);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(arithmetic[i], 2 + 16.0 * double(i), 1e-12);
    EXPECT_NEAR(geometric[i], 2 * std::pow(25, double(i) / 3), 1e-12);
    EXPECT_NEAR(half[i], 0.5 * (arithmetic[i] + geometric[i]), 1e-12);
  }
  EXPECT_THROW(practical_splits(0, 1, 2, 1), InvalidScene);
  EXPECT_THROW(practical_splits(1, 2, 0, 1), InvalidScene);
  EXPECT_THROW(practical_splits(1, 2, 2, 1.5), InvalidScene);
}

/// Light along a slant onto ground z = 0, seen from above it.
LightView slanted() {
  Light sun;
  sun.direction = normalized(Vec3d{0.5, 0.2, -1});
  geometry::Box3d box;
  box.low = {-200, -200, -1}, box.high = {200, 200, 30};
  return fit_view(sun, box);
}
Camera walker(const Vec3d& at) {
  Camera c;
  c.position = at, c.target = at + Vec3d{1, 0.3, -0.25}, c.up = {0, 0, 1};
  return c;
}
/// Points of the ground, and some above it, that the camera sees.
std::vector<Vec3d> seen(const Camera& camera, double far, int n, std::uint64_t seed) {
  const Vec3d axis = normalized(camera.target - camera.position), right = normalized(cross(axis, camera.up)),
              up = cross(right, axis);
  const double tangent = std::tan(0.5 * camera.height_angle), aspect = double(camera.width) / camera.height;
  Pcg32 random(seed);
  std::vector<Vec3d> r;
  for (int i = 0; i < n; ++i) {
    const double z = std::exp(random.uniform(0.0, std::log(far)));
    r.push_back(camera.position + axis * z + right * (z * tangent * aspect * random.uniform(-1.0, 1.0)) +
                up * (z * tangent * random.uniform(-1.0, 1.0)));
  }
  return r;
}

TEST(Cascades, HoldWhatTheCameraSees) {
  const LightView whole = slanted();
  const Camera camera = walker({1, 2, 3});
  const std::vector<Vec3d> points = seen(camera, 60, 5000, 1);
  for (const bool fitted : {true, false})
    for (const int count : {1, 3, 4}) {
      CascadeOptions o;
      o.count = count, o.fitted = fitted, o.resolution = 256;
      const CascadeViews c = fit_cascades(whole, camera, points, o);
      ASSERT_EQ(c.views.size(), std::size_t(count));
      std::vector<int> in(c.views.size());
      for (const Vec3d& p : points) {
        const std::size_t i = c.slice(p);
        ASSERT_TRUE(c.distance(p) >= c.splits[i] && c.distance(p) <= c.splits[i + 1]);
        const auto q = c.views[i].place(p);
        const double margin = (o.margin - 1e-6) / o.resolution;
        ASSERT_TRUE(q.x >= margin && q.x <= 1 - margin && q.y >= margin && q.y <= 1 - margin)
            << fitted << " " << q.x << " " << q.y;
        // Depth is that of the whole view.
        ASSERT_NEAR(q.depth, whole.place(p).depth, 1e-12);
        ++in[i];
      }
      for (const int n : in) EXPECT_GT(n, 0);
      // Nearer slices have smaller texels.
      for (std::size_t i = 0; i + 1 < c.views.size(); ++i)
        EXPECT_LT(c.views[i].half_width, c.views[i + 1].half_width);
    }
}

TEST(Cascades, FittedOnesAreNoLargerThanTheirSamples) {
  const LightView whole = slanted();
  const Camera camera = walker({1, 2, 3});
  const std::vector<Vec3d> points = seen(camera, 60, 5000, 2);
  CascadeOptions tight, loose;
  loose.fitted = false;
  const CascadeViews a = fit_cascades(whole, camera, points, tight),
                     b = fit_cascades(whole, camera, points, loose);
  for (std::size_t i = 0; i < a.views.size(); ++i) {
    EXPECT_LT(a.views[i].half_width, b.views[i].half_width);
    double low = INFINITY, high = -INFINITY;
    for (const Vec3d& p : points)
      if (a.slice(p) == i)
        low = std::min(low, dot(p, whole.right)), high = std::max(high, dot(p, whole.right));
    const double used = (high - low) / (2 * a.views[i].half_width);
    EXPECT_NEAR(used, 1 - 2 * tight.margin / tight.resolution, 1e-3);
  }
}

/// Largest change of visibility over so many frames of a moving camera, and the largest of all errors.
double crawl(bool snapped, bool fitted) {
  const LightView whole = slanted();
  Pcg32 random(3);
  const Camera first = walker({1, 2, 3});
  std::vector<Receiver> receivers;
  for (const Vec3d& p : seen(first, 60, 20000, 4)) receivers.push_back({p, -whole.forward});
  std::vector<float> before;
  double worst = 0;
  for (int frame = 0; frame < 12; ++frame) {
    const Vec3d step{random.uniform(-0.02, 0.02), random.uniform(-0.02, 0.02), random.uniform(-0.02, 0.02)};
    const Camera camera = frame == 0 ? first : walker(first.position + step);
    const std::vector<Vec3d> points = seen(camera, 62, 20000, 4);
    CascadeOptions o;
    o.count = 1, o.fitted = fitted, o.snapped = snapped, o.resolution = 512;
    if (!fitted) o.near = 0.5, o.far = 70;
    // Blockers in front of all, in stripes of an edge that is no multiple of texels.
    const auto map_of = [&](const LightView& view) {
      DepthMap map{view, o.resolution, o.resolution, {}, {}};
      for (int j = 0; j < o.resolution; ++j)
        for (int i = 0; i < o.resolution; ++i) {
          const Vec3d p = view.at({(i + 0.5) / o.resolution, (j + 0.5) / o.resolution, 0});
          const double s = dot(p, whole.right) * 0.31 + dot(p, whole.down) * 0.17;
          map.first.push_back(s - std::floor(s) < 0.5 ? 0.0f : 1.0f);
        }
      return map;
    };
    const Cascades<PcfGrid> method(fit_cascades(whole, camera, points, o), map_of,
                                   [](const DepthMap& map) { return PcfGrid(map); });
    std::vector<float> now(receivers.size());
    shade(method, receivers, 1, now);
    for (std::size_t i = 0; frame > 0 && i < now.size(); ++i)
      worst = std::max(worst, double(std::abs(now[i] - before[i])));
    before = now;
  }
  return worst;
}

TEST(Cascades, SnappedOnesDoNotCrawl) {
  EXPECT_EQ(crawl(true, false), 0);
  EXPECT_GT(crawl(false, false), 0.1);
  EXPECT_GT(crawl(true, true), 0.1);  // fitted to samples: the price
}

TEST(Cascades, AnswerAsTheMapOfTheirSlice) {
  const LightView whole = slanted();
  const Camera camera = walker({1, 2, 3});
  const std::vector<Vec3d> points = seen(camera, 60, 500, 5);
  const auto map_of = [](const LightView& view) {
    DepthMap map{view, 32, 32, {}, {}};
    map.first.assign(32 * 32, float(view.half_width > 10 ? 0 : 1));
    return map;
  };
  CascadeOptions o;
  o.resolution = 32, o.margin = 2;
  const Cascades<PcfGrid> method(fit_cascades(whole, camera, points, o), map_of,
                                 [](const DepthMap& map) { return PcfGrid(map); });
  EXPECT_EQ(method.bytes(), 4 * 32 * 32 * sizeof(float));
  int shadowed = 0;
  for (const Vec3d& p : points) {
    const bool wide = method.views().views[method.views().slice(p)].half_width > 10;
    ASSERT_EQ(method.visibility({p, -whole.forward}), wide ? 0 : 1);
    shadowed += wide;
  }
  EXPECT_GT(shadowed, 0);
  EXPECT_LT(shadowed, 500);
}

TEST(Cascades, APointBesideItsSlicesMapIsSoughtInFartherOnes) {
  const LightView whole = slanted();
  const Camera camera = walker({1, 2, 3});
  const std::vector<Vec3d> points = seen(camera, 60, 5000, 7);
  const CascadeViews c = fit_cascades(whole, camera, points);
  Pcg32 random(8);
  int sought = 0;
  for (int n = 0; n < 2000; ++n) {
    // Near the camera by its axis, and beside the near slices.
    const Vec3d p = camera.position + c.axis * random.uniform(c.splits[0], c.splits[1]) +
                    whole.right * random.uniform(-15.0, 15.0) + whole.down * random.uniform(-15.0, 15.0);
    const auto holds = [&](std::size_t i) {
      const auto q = c.views[i].place(p);
      return q.x >= 0 && q.x < 1 && q.y >= 0 && q.y < 1;
    };
    std::size_t own = 0;
    while (own + 1 < c.views.size() && c.distance(p) >= c.splits[own + 1]) ++own;
    std::size_t expected = own;
    while (expected < c.views.size() && !holds(expected)) ++expected;
    ASSERT_EQ(c.slice(p), expected < c.views.size() ? expected : own);
    sought += expected > own && expected < c.views.size();
  }
  EXPECT_GT(sought, 100);
}

TEST(Cascades, RefuseWhatTheyCannotTake) {
  const LightView whole = slanted();
  const Camera camera = walker({1, 2, 3});
  const std::vector<Vec3d> points = seen(camera, 60, 10, 6), none, behind{camera.position - Vec3d{5, 0, 0}};
  EXPECT_THROW(fit_cascades(whole, camera, none), InvalidScene);
  EXPECT_THROW(fit_cascades(whole, camera, behind), InvalidScene);
  EXPECT_THROW(fit_cascades(perspective_view(1, 1, 2), camera, points), InvalidScene);
  Camera blind = camera;
  blind.target = blind.position;
  EXPECT_THROW(fit_cascades(whole, blind, points), InvalidScene);
}

}  // namespace
}  // namespace treeline::shading::shadow::test
