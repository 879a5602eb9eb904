// Area shadows by rays: against closed forms, and how their error falls with the number of samples.
#include <gtest/gtest.h>

#include <rapidcheck/gtest.h>

#include "accel/brute_force/triangles.hpp"
#include "accel/bvh/wide_triangles.hpp"
#include "shading/shadow/area_rays.hpp"
#include "shading/shadow/closed_forms.hpp"
#include "tests/accel/triangles_common.hpp"
#include "tests/shading/shadow_scenes.hpp"

namespace treeline::shading::shadow::test {
namespace {

using namespace shading::test;
using Tree = accel::Bvh<accel::Triangles<float, geometry::Watertight>, accel::Wide>;
using geometry::Pcg32;
using std::numbers::pi;

AreaRayOptions options(int samples, SamplePattern pattern = SamplePattern::sobol_owen,
                       std::uint64_t seed = 0) {
  return {samples, pattern, seed};
}

/// A floor at y = 0, and at y = 2 a blocker that ends at x = 0 and hides all x < 0.
Scene half_plane(const Light& light) {
  Scene scene;
  scene.name = "half plane";
  add_quad(scene.mesh, {0, 0, 0}, {0, 0, 40}, {40, 0, 0});
  add_quad(scene.mesh, {-20, 2, 0}, {0, 0, 40}, {20, 0, 0});
  scene.camera.position = {0, 5, 20};
  scene.light = light;
  return scene;
}
Receiver on_floor(double x, double z = 0) { return {{x, 0, z}, {0, 1, 0}}; }

Light disc_light() {
  Light light;
  light.kind = LightKind::disc, light.position = {0, 6, 0};
  light.u = {1, 0, 0}, light.v = {0, 0, 1};
  return light;
}
/// Seen from x on the floor, the edge appears on the light's plane at -2 x, and hides what is beyond.
double edge_on_light(double x) { return 2 * x; }

TEST(LightSamples, EachPatternIsUniformOverTheSquare) {
  for (const SamplePattern pattern :
       {SamplePattern::sobol_owen, SamplePattern::random, SamplePattern::jittered, SamplePattern::regular}) {
    const SquareSamples samples(12, pattern, 7);
    std::vector<Vec2d> points(12);
    const int cells = 6;
    std::vector<double> counts(cells * cells);
    const int pixels = 6000;
    for (int pixel = 0; pixel < pixels; ++pixel) {
      samples(static_cast<std::uint64_t>(pixel), points);
      for (const Vec2d& p : points) {
        ASSERT_TRUE(p[0] >= 0 && p[0] < 1 && p[1] >= 0 && p[1] < 1);
        ++counts[static_cast<std::size_t>(p[1] * cells) * cells + static_cast<std::size_t>(p[0] * cells)];
      }
    }
    // Points of a pixel repel each other, so the sum stays below chi-square's; of 35 degrees, beyond 75 one
    // time in 10^4.
    const double expected = 12.0 * pixels / (cells * cells);
    double chi2 = 0;
    for (const double c : counts) chi2 += (c - expected) * (c - expected) / expected;
    EXPECT_LT(chi2, 75) << int(pattern);
  }
}

TEST(LightSamples, AreTheLibrarysNets) {
  const SquareSamples samples(16, SamplePattern::sobol_owen, 3);
  std::vector<Vec2d> points(16);
  samples(99, points);
  for (std::uint32_t i = 0; i < 16; ++i)
    for (int k = 0; k < 2; ++k)
      EXPECT_EQ(points[i][k], geometry::sobol_owen<double>(i, k, geometry::hash_u64(3, 99)));
}

TEST(LightSamples, RefusesWhatIsNone) {
  EXPECT_THROW(SquareSamples(0), InvalidScene);
  Light light = disc_light();
  light.v = light.u;
  EXPECT_THROW(LightShape{light}, InvalidScene);
  light = {};
  light.direction = {};
  EXPECT_THROW(LightShape{light}, InvalidScene);
  light.direction = {0, -1, 0}, light.angle = 1.6;
  EXPECT_THROW(LightShape{light}, InvalidScene);
}

/// Root mean square error over edges at any angle, any distance from the middle of the unit square that they
/// still cut, and any pixel. Truth: the square's share on one side of a line.
double edge_error(SamplePattern pattern, int n, int edges) {
  const SquareSamples samples(n, pattern, 11);
  std::vector<Vec2d> points(static_cast<std::size_t>(n));
  Pcg32 random(5);
  double sum = 0;
  for (int e = 0; e < edges; ++e) {
    const double angle = 2 * pi * random.uniform(), c = std::abs(std::cos(angle)),
                 s = std::abs(std::sin(angle));
    const double reach = 0.5 * (c + s), at = random.uniform(-reach, reach);
    // Of x with dot(normal, x) < at: a trapezoid's distribution, the sum of two uniform ones.
    const auto ramp = [](double t) { return t > 0 ? 0.5 * t * t : 0; };
    const double truth =
        (ramp(at + reach) - ramp(at + reach - c) - ramp(at + reach - s) + ramp(at - reach)) / (c * s);
    samples(static_cast<std::uint64_t>(e), points);
    int seen = 0;
    for (const Vec2d& p : points)
      seen += std::cos(angle) * (p[0] - 0.5) + std::sin(angle) * (p[1] - 0.5) < at ? 1 : 0;
    const double error = double(seen) / n - truth;
    sum += error * error;
  }
  return std::sqrt(sum / edges);
}

TEST(LightSamples, ErrorsOverEdgesFollowTheirLaws) {
  const auto law = [](double factor, double power, int n) { return factor * std::pow(n, power); };
  for (const int n : {16, 64, 256}) {
    const int edges = 20000;
    const double nets = edge_error(SamplePattern::sobol_owen, n, edges);
    const double random = edge_error(SamplePattern::random, n, edges);
    const double jittered = edge_error(SamplePattern::jittered, n, edges);
    const double regular = edge_error(SamplePattern::regular, n, edges);
    std::printf("N %d: sobol_owen %.4f random %.4f jittered %.4f regular %.4f\n", n, nets, random, jittered,
                regular);
    EXPECT_NEAR(nets, law(0.30, -0.75, n), 0.1 * law(0.30, -0.75, n));
    EXPECT_NEAR(random, law(0.35, -0.5, n), 0.1 * law(0.35, -0.5, n));
    EXPECT_NEAR(jittered, law(0.37, -0.75, n), 0.1 * law(0.37, -0.75, n));
    EXPECT_NEAR(regular, law(0.27, -0.5, n), 0.1 * law(0.27, -0.5, n));  // no faster than random ones
  }
}

TEST(AreaRays, DiscOverAnEdge) {
  const Scene scene = half_plane(disc_light());
  const Tree tree(scene.mesh);
  const AreaRays rays(tree, scene, options(4096));
  for (double x = -0.7; x <= 0.7; x += 0.05)
    EXPECT_NEAR(rays.visibility(on_floor(x, 0.3)), disc_over_edge(edge_on_light(x)), 0.004) << x;
}

TEST(AreaRays, RectangleOverAnEdge) {
  Light light = disc_light();
  light.kind = LightKind::rectangle;
  const Scene scene = half_plane(light);
  const Tree tree(scene.mesh);
  const AreaRays rays(tree, scene, options(4096));
  for (double x = -0.7; x <= 0.7; x += 0.05)
    EXPECT_NEAR(rays.visibility(on_floor(x)), rectangle_over_edge(edge_on_light(x) / 2), 0.002) << x;
}

TEST(AreaRays, SunOverAnEdge) {
  Light light;
  light.direction = normalized(Vec3d{0.4, -1, 0}), light.angle = 0.1;
  const Scene scene = half_plane(light);
  const Tree tree(scene.mesh);
  const AreaRays rays(tree, scene, options(4096));
  // The edge cuts the sun's plane at right angles to it, at distance 1: along the way to x, up 2.
  const double cosine = -light.direction[1], sine = light.direction[0];
  for (double x = 0.6; x <= 1.0; x += 0.02) {
    const double along = -x * -sine + 2 * cosine, across = x * cosine - 2 * sine;
    EXPECT_NEAR(rays.visibility(on_floor(x)), disc_over_edge(across / along / std::tan(0.1)), 0.004) << x;
  }
}

/// What rays start above the surface by grows with the scene, where edges of shadows stay: a kilometre from
/// the origin half a penumbra of 6 cm, which 15 mm of that would move by a third of it.
TEST(AreaRays, EdgesStayInLargeScenes) {
  Scene scene;
  add_quad(scene.mesh, {0, 0, 0}, {0, 0, 1000}, {1000, 0, 0});
  add_quad(scene.mesh, {780, 2, 0}, {0, 0, 40}, {20, 0, 0});  // ends at x = 800
  scene.camera.position = {800, 5, 20};
  scene.light.direction = {0.8, -0.6, 0}, scene.light.angle = 0.005;
  const Tree tree(scene.mesh);
  const AreaRays rays(tree, scene, options(4096));
  EXPECT_GT(rays.offset(), 0.01);
  for (double x = 2.63; x <= 2.71; x += 0.004) {
    const double along = x * 0.8 + 2 * 0.6, across = x * 0.6 - 2 * 0.8;
    // Float rounds the receiver's place by 31 µm, of 17 mm that the sun's radius covers there across the way.
    EXPECT_NEAR(rays.visibility(on_floor(800 + x)), disc_over_edge(across / along / std::tan(0.005)), 0.006)
        << x;
  }
}

/// What stands on the floor shades it up to its foot, at every height of the sun.
TEST(AreaRays, ShadowsReachTheFeetOfWalls) {
  for (const double sine : {0.02, 0.1, 0.126, 0.3, 0.9}) {
    Scene scene;
    add_quad(scene.mesh, {0, 0, 0}, {0, 0, 10}, {10, 0, 0});
    add_quad(scene.mesh, {0, 2, 0}, {0, 0, 10}, {0, 2, 0});  // a wall in x = 0, 4 high
    scene.camera.position = {5, 5, 5};
    scene.light.direction = {std::sqrt(1 - sine * sine), -sine, 0};
    const Tree tree(scene.mesh);
    const AreaRays rays(tree, scene, options(1));
    EXPECT_LT(rays.offset(), 3e-4);
    for (const double x : {0.003, 0.01, 0.1, 1.0})
      EXPECT_EQ(rays.visibility(on_floor(x)), 0) << sine << ' ' << x;
    for (const double x : {-0.003, -0.1}) EXPECT_EQ(rays.visibility(on_floor(x)), 1) << sine << ' ' << x;
  }
}

TEST(AreaRays, DiscBehindDisc) {
  Scene scene;
  add_quad(scene.mesh, {0, 0, 0}, {0, 0, 40}, {40, 0, 0});
  add_disc(scene.mesh, {0, 2, 0}, {0, 0, 0.5}, {0.5, 0, 0}, 400);
  scene.light = disc_light();
  const Tree tree(scene.mesh);
  const AreaRays rays(tree, scene, options(4096));
  for (double x = 0; x <= 1.6; x += 0.1)
    EXPECT_NEAR(rays.visibility(on_floor(x)), disc_behind_disc(1.5, 2 * x), 0.004) << x;
}

TEST(AreaRays, HardLightsSeeAllOrNothing) {
  for (const LightKind kind : {LightKind::directional, LightKind::point, LightKind::spot}) {
    Light light;
    light.kind = kind, light.position = {0, 6, 0};
    const Scene scene = half_plane(light);
    const Tree tree(scene.mesh);
    const AreaRays rays(tree, scene, options(16));
    EXPECT_EQ(rays.visibility(on_floor(-0.01)), 0);
    EXPECT_EQ(rays.visibility(on_floor(0.01)), 1);
    // The blocker's own faces: lit from above, not from below.
    EXPECT_EQ(rays.visibility({{-1, 2, 0}, {0, 1, 0}}), 1);
    EXPECT_EQ(rays.visibility({{-1, 2, 0}, {0, -1, 0}}), 0);
  }
}

TEST(AreaRays, NothingBehindTheLightHides) {
  Scene scene = half_plane(disc_light());
  add_quad(scene.mesh, {0, 6.5, 0}, {0, 0, 4}, {4, 0, 0});
  const Tree tree(scene.mesh);
  EXPECT_EQ(AreaRays(tree, scene, options(16)).visibility(on_floor(1)), 1);
}

// A mean over seeds is that far from the truth that chance has it: 4 standard errors, one time in 16000.
TEST(AreaRays, IsUnbiased) {
  const Scene scene = half_plane(disc_light());
  const Tree tree(scene.mesh);
  for (const SamplePattern pattern :
       {SamplePattern::sobol_owen, SamplePattern::random, SamplePattern::jittered, SamplePattern::regular})
    for (const double x : {-0.31, 0.02, 0.17}) {
      const int seeds = 4000;
      double sum = 0, squares = 0;
      for (int seed = 0; seed < seeds; ++seed) {
        const double v = AreaRays(tree, scene, options(9, pattern, static_cast<std::uint64_t>(seed)))
                             .visibility(on_floor(x));
        sum += v, squares += v * v;
      }
      const double mean = sum / seeds, error = std::sqrt((squares / seeds - mean * mean) / (seeds - 1));
      EXPECT_LT(std::abs(mean - disc_over_edge(edge_on_light(x))), 4 * error) << int(pattern) << " at " << x;
    }
}

// Over the whole penumbra of a disc light, and between two halves of different seeds: root two as far apart
// as either is from the truth.
TEST(AreaRays, ErrorOverAPenumbraAndBetweenTwoHalves) {
  const Scene scene = half_plane(disc_light());
  const Tree tree(scene.mesh);
  Pcg32 random(9);
  std::vector<Receiver> receivers;
  for (int i = 0; i < 6000; ++i)
    receivers.push_back(on_floor(random.uniform(-0.5, 0.5), random.uniform(-1.0, 1.0)));
  for (const int n : {16, 64}) {
    std::vector<float> a(receivers.size()), b(receivers.size());
    AreaRays(tree, scene, options(n, SamplePattern::sobol_owen, 1)).visibility(receivers, a);
    AreaRays(tree, scene, options(n, SamplePattern::sobol_owen, 2)).visibility(receivers, b);
    double error = 0, apart = 0;
    for (std::size_t i = 0; i < receivers.size(); ++i) {
      const double truth = disc_over_edge(edge_on_light(receivers[i].position[0]));
      error += std::pow(a[i] - truth, 2), apart += std::pow(a[i] - b[i], 2);
    }
    error = std::sqrt(error / double(receivers.size())), apart = std::sqrt(apart / double(receivers.size()));
    std::printf("N %d: error %.4f, halves apart %.4f\n", n, error, apart);
    EXPECT_NEAR(error, 0.30 * std::pow(n, -0.75), 0.15 * 0.30 * std::pow(n, -0.75));
    EXPECT_NEAR(apart / error, std::sqrt(2.0), 0.06);
  }
}

TEST(AreaRays, BatchesThreadsAndTreesAgree) {
  Scene scene = half_plane(disc_light());
  const Mesh3f ball = accel::test::sphere<float>(3, {2, 1, 0}, 0.7f);
  for (std::size_t i = 0; i < ball.size(); ++i) {
    const auto t = ball.triangle(i);
    add_triangle(scene.mesh, Vec3d(t.a), Vec3d(t.b), Vec3d(t.c));
  }
  const Tree tree(scene.mesh);
  const accel::BruteForce<accel::Triangles<float, geometry::Watertight>> brute(
      std::span<const geometry::Triangle3f>(triangles_of(scene.mesh)));
  Pcg32 random(2);
  std::vector<Receiver> receivers;
  for (int i = 0; i < 700; ++i)
    receivers.push_back(on_floor(random.uniform(-3.0, 4.0), random.uniform(-2.0, 2.0)));
  const AreaRays rays(tree, scene, options(16));
  std::vector<float> one(receivers.size()), two(receivers.size()), streams(receivers.size()),
      packets(receivers.size()), slow(receivers.size());
  rays.visibility(receivers, one);
  rays.visibility(receivers, two, 2);
  rays.visibility(receivers, streams, 1, accel::RayBatch::streams);
  rays.visibility(receivers, packets, 1, accel::RayBatch::packets);
  AreaRays(brute, scene, options(16)).visibility(receivers, slow);
  EXPECT_EQ(one, two);
  EXPECT_EQ(one, streams);
  EXPECT_EQ(one, packets);
  double apart = 0;
  for (std::size_t i = 0; i < receivers.size(); ++i) {
    EXPECT_EQ(one[i], rays.visibility(receivers[i]));
    apart += std::abs(one[i] - slow[i]);
  }
  EXPECT_LT(apart / double(receivers.size()), 1e-3);  // their ray tests differ by rounding
  EXPECT_THROW(rays.visibility(receivers, std::span(one).first(3)), InvalidScene);
}

// A convex body never hides the light from its own lit side, at whatever size and place.
TEST(AreaRays, NoConvexBodyShadesItself) {
  for (const double size : {1e-3, 1.0, 1e4})
    for (const double away : {0.0, 10.0}) {
      Scene scene;
      const Vec3d centre = Vec3d{3, -2, 1} * (away * size);
      scene.mesh = accel::test::sphere<float>(4, Vec3f(centre), static_cast<float>(size));
      scene.camera.position = centre + Vec3d{0, 0, 3 * size};
      scene.light.kind = LightKind::disc, scene.light.position = centre + Vec3d{0, 20, 0} * size;
      scene.light.u = Vec3d{1, 0, 0} * size, scene.light.v = Vec3d{0, 0, 1} * size;
      const Tree tree(scene.mesh);
      const AreaRays rays(tree, scene, options(4));
      Pcg32 random(4);
      for (int i = 0; i < 20000; ++i) {
        const geometry::Triangle3d t(
            scene.mesh.triangle(random.below(static_cast<std::uint32_t>(scene.mesh.size()))));
        const Vec3d w = geometry::sample_triangle(random.uniform(), random.uniform());
        Receiver r{t.a * w[0] + t.b * w[1] + t.c * w[2], normalized(t.area_normal())};
        r.position = Vec3d(Vec3f(r.position));  // as a ray in float would find it
        const double least = dot(r.normal, scene.light.position - r.position) - 2 * size;
        if (least > 0) {
          ASSERT_EQ(rays.visibility(r), 1) << "size " << size << ", receiver " << i;
        } else if (least < -4 * size) {
          ASSERT_EQ(rays.visibility(r), 0) << "size " << size << ", receiver " << i;
        }
      }
    }
}

RC_GTEST_PROP(ClosedForms, ALensIsWhatSamplesCount, ()) {
  const auto in = [](int low, int high) { return double(*rc::gen::inRange(low, high)) / 100; };
  const double a = in(20, 200), b = in(20, 200), d = in(0, 300);
  const SquareSamples samples(16384, SamplePattern::sobol_owen, 1);
  std::vector<Vec2d> points(16384);
  samples(0, points);
  int both = 0;
  for (const Vec2d& s : points) {
    const Vec2d p = geometry::sample_disc(s[0], s[1]) * a;
    both += length(p - Vec2d{d, 0}) < b ? 1 : 0;
  }
  RC_ASSERT(std::abs(both / 16384.0 * pi * a * a - lens_area(a, b, d)) < 0.003 * pi * a * a);
}

RC_GTEST_PROP(ClosedForms, ACapsOverlapIsWhatSamplesCount, ()) {
  const auto in = [](int low, int high) { return double(*rc::gen::inRange(low, high)) / 100; };
  const double a = in(10, 140), b = in(10, 140), apart = in(0, 314);
  RC_PRE(a + b + apart < 2 * pi);
  const SquareSamples samples(16384, SamplePattern::sobol_owen, 1);
  std::vector<Vec2d> points(16384);
  samples(0, points);
  const Vec3d other{std::sin(apart), 0, std::cos(apart)};
  int both = 0;
  for (const Vec2d& s : points) {
    const Vec3d w = geometry::sample_sphere(s[0], s[1]);
    both += w[2] > std::cos(a) && dot(w, other) > std::cos(b) ? 1 : 0;
  }
  RC_ASSERT(std::abs(both / 16384.0 * 4 * pi - cap_overlap(a, b, apart)) < 0.004 * 4 * pi);
}

TEST(ClosedForms, SmallCapsAreDiscs) {
  for (double x = 0; x < 3; x += 0.1)
    EXPECT_NEAR(cap_behind_cap(1e-3, 1.5e-3, 1e-3 * x), disc_behind_disc(1.5, x), 1e-6);
  EXPECT_NEAR(disc_behind_disc(1e6, 1e6 - 0.3), disc_over_edge(-0.3), 1e-5);  // a large disc is a half-plane
}

}  // namespace
}  // namespace treeline::shading::shadow::test
