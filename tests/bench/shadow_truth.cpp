// What the task shadow takes for true: light samples, closed forms, rays; each beside a second witness.
#include <gtest/gtest.h>

#include <numbers>

#include "bench/shadow/closed_form.hpp"
#include "bench/shadow/truth.hpp"
#include "datasets_gen/scenes/scene.hpp"
#include "geometry/intersect_triangle.hpp"
#include "geometry/random.hpp"
#include "geometry/sobol.hpp"

namespace treeline::bench::shadow {
namespace {

constexpr double pi = std::numbers::pi;

shading::Light light_of(LightKind kind) {
  shading::Light light;
  light.kind = kind;
  light.position = {0.3, 4, -0.2}, light.direction = normalized(Vec3d{0.2, -1, 0.1});
  if (kind == LightKind::rectangle || kind == LightKind::disc) {
    const geometry::Frame<double> frame(light.direction);
    light.u = frame.x * 0.7, light.v = frame.y * (kind == LightKind::disc ? 0.7 : 0.4);
  }
  if (kind == LightKind::directional) light.angle = 0.3;
  return light;
}
constexpr LightKind soft[] = {LightKind::directional, LightKind::rectangle, LightKind::disc};

/// Where an even grid of samples goes past the half-plane: the sum by which the closed form is known.
double summed(const datasets::HalfPlane& plane, const shading::Light& light, const Vec3d& from) {
  constexpr int n = 400;
  const Vec3d normal = cross(plane.along, plane.into);
  int free = 0;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const ToLight to = to_light(light, from, (i + 0.5) / n, (j + 0.5) / n);
      const double t = dot(plane.point - from, normal) / dot(to.direction, normal);
      const Vec3d at = from + to.direction * t;
      free += !(t > 0 && t < to.distance && dot(at - plane.point, plane.into) > 0);
    }
  return double(free) / (n * n);
}

TEST(ShadowLights, SamplesLieOnTheLightAndKeepAreas) {
  for (const LightKind kind : soft) {
    const shading::Light light = light_of(kind);
    const Vec3d from{1, 0, 2};
    double inner = 0;  // the share in the middle quarter of the area
    constexpr int n = 256;
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) {
        const ToLight to = to_light(light, from, (i + 0.5) / n, (j + 0.5) / n);
        EXPECT_NEAR(length(to.direction), 1, 1e-12);
        if (kind == LightKind::directional) {
          const double cosine = -dot(to.direction, light.direction);
          EXPECT_GE(cosine, std::cos(light.angle) - 1e-12);
          inner += cosine > 1 - 0.25 * (1 - std::cos(light.angle));
          continue;
        }
        const Vec3d d = from + to.direction * to.distance - light.position;
        EXPECT_NEAR(dot(d, light.direction), 0, 1e-12);
        const double x = dot(d, light.u) / length2(light.u), y = dot(d, light.v) / length2(light.v);
        if (kind == LightKind::rectangle) {
          EXPECT_LE(std::max(std::abs(x), std::abs(y)), 1 + 1e-12);
          inner += std::abs(x) < 0.25;
        } else {
          EXPECT_LE(std::hypot(x, y), 1 + 1e-12);
          inner += x * x + y * y < 0.25;
        }
      }
    EXPECT_NEAR(inner / (n * n), 0.25, 0.003);
  }
}

/// Against its samples: all above the surface, or some not.
TEST(ShadowLights, OnlyWhatSeesTheWholeLightIsAReceiver) {
  geometry::Pcg32 random(4);
  int lit = 0, tried = 0;
  for (int k = 0; k < 3000; ++k) {
    const shading::Light light = light_of(soft[k % 3]);
    Vec3d at, normal;
    for (int a = 0; a < 3; ++a) at[a] = random.uniform(-5.0, 5.0), normal[a] = random.uniform(-1.0, 1.0);
    normal = normalized(normal);
    double low = 1;
    for (int i = 0; i < 64; ++i)
      for (int j = 0; j < 64; ++j)
        low = std::min(low, dot(to_light(light, at, i / 63.0, j / 63.0).direction, normal));
    const bool behind =
        light.kind != LightKind::directional && dot(at - light.position, light.direction) <= 0;
    if (std::abs(low) < 0.02) continue;  // the samples do not reach the very border
    ++tried;
    const bool told = lights(light, at, normal, 0);
    EXPECT_EQ(told, low > 0 && !behind) << k;
    lit += told;
  }
  EXPECT_GT(lit, tried / 20);
}

TEST(ShadowClosedForm, IsTheSumOverTheLight) {
  geometry::Pcg32 random(5);
  int between = 0;
  for (int k = 0; k < 150; ++k) {
    const shading::Light light = light_of(soft[k % 3]);
    datasets::HalfPlane plane{{random.uniform(-0.5, 0.5), random.uniform(1.0, 2.5), 0}, {}, {}};
    plane.along = normalized(Vec3d{random.uniform(-1.0, 1.0), random.uniform(-0.2, 0.2), 1});
    plane.into = normalized(cross(plane.along, Vec3d{0, random.uniform() < 0.5 ? 1.0 : -1.0, 0.1}));
    const Vec3d from{random.uniform(-1.0, 1.0), random.uniform(-1.0, 0.0), random.uniform(-1.0, 1.0)};
    const double is = 1 - blocked_by(plane, light, from), sum = summed(plane, light, from);
    EXPECT_NEAR(is, sum, 4e-3) << k;
    between += sum > 0.01 && sum < 0.99;
  }
  EXPECT_GT(between, 30);
}

TEST(ShadowClosedForm, KnownValues) {
  EXPECT_NEAR(disc_share(0), 0.5, 1e-15);
  EXPECT_NEAR(disc_share(0.25) - disc_share(-0.25), 0.315, 5e-4);  // the slit of two quarters of the radius
  EXPECT_NEAR(cap_share(0.2, 0), 0.5, 1e-12);
  EXPECT_NEAR(cap_share(1e-3, std::sin(2.5e-4)), disc_share(0.25), 1e-6);  // a small cap is a disc
  EXPECT_EQ(square_share(1, 0, -0.5), 0.25);
  EXPECT_NEAR(square_share(1, 1, 0), 0.5, 1e-15);
}

TEST(ShadowClosedForm, NothingIsBlockedBeforeTheBlocker) {
  const datasets::HalfPlane plane{{0, 1, 0}, {0, 0, 1}, {-1, 0, 0}};
  for (const LightKind kind : soft)
    for (const double y : {1.0, 1.5, 3.0}) EXPECT_EQ(blocked_by(plane, light_of(kind), {-1, y, 0}), 0);
}

/// Every triangle tried, in double.
bool lit_by_brute_force(const shading::Scene& scene, const Receiver& r) {
  const ToLight to = to_light(scene.light, r.position);
  const geometry::Rayd ray{r.position, to.direction, 1e-6, to.distance};  // doubles know it from its own face
  const geometry::MollerTrumbore::Prepared<double> meets(ray);
  for (std::size_t f = 0; f < scene.mesh.size(); ++f)
    if (meets(geometry::Triangle3d(scene.mesh.triangle(f)), ray.t_min, ray.t_max)) return false;
  return true;
}

TEST(ShadowTruth, HardShadowsAgreeWithBruteForce) {
  for (const char* name : {"wall_on_floor", "open_casters", "city"}) {
    shading::Scene scene = datasets::make_scene(name, 2000, 1);
    scene.light.angle = 0;
    scene.camera.width = 40, scene.camera.height = 30;
    const Tree tree(scene.mesh);
    const Receivers seen = receivers_of(scene, tree, 1);
    const Truth truth = traced_truth(scene, tree, seen.list, seen.pixel, seen.width, {}, 1);
    std::size_t off = 0, dark = 0;
    for (std::size_t i = 0; i < seen.list.size(); ++i) {
      const bool lit = lit_by_brute_force(scene, seen.list[i]);
      off += (truth.visibility[i] == 1) != lit, dark += !lit;
    }
    EXPECT_LE(off, seen.list.size() / 500)
        << name;  // rays through an edge, which double and float see otherwise
    EXPECT_GT(dark, seen.list.size() / 50) << name;
  }
}

TEST(ShadowTruth, HalvesTellHowFarItIsFromTheFormula) {
  shading::Scene scene = datasets::make_scene("half_plane_edge", 200, 1);
  scene.camera.width = 64, scene.camera.height = 48;
  const auto known = datasets::known_shadows("half_plane_edge");
  const Tree tree(scene.mesh);
  const Receivers seen = receivers_of(scene, tree, 1);
  double before = 1;
  for (const int most : {64, 256, 1024}) {
    TruthOptions options;
    options.first = 64, options.most = most, options.wanted = 0;
    const Truth truth = traced_truth(scene, tree, seen.list, seen.pixel, seen.width, options, 1);
    double sum = 0;
    for (std::size_t i = 0; i < seen.list.size(); ++i) {
      const double off =
          truth.visibility[i] - visible_past(known.blockers, scene.light, seen.list[i].position);
      sum += off * off;
    }
    const double rms = std::sqrt(sum / double(seen.list.size()));
    EXPECT_GT(truth.halves, 0);
    EXPECT_LT(rms, truth.halves) << most;        // the mean of both is nearer than they are to each other
    EXPECT_GT(rms, 0.2 * truth.halves) << most;  // of independent halves, half as far
    EXPECT_LT(truth.halves, 0.6 * before);       // four times the samples: 2.8 times nearer
    before = truth.halves;
  }
}

TEST(ShadowTruth, NoMoreSamplesWhereAllAgree) {
  shading::Scene scene = datasets::make_scene("half_plane_edge", 200, 1);
  scene.camera.width = 64, scene.camera.height = 48;
  const Tree tree(scene.mesh);
  const Receivers seen = receivers_of(scene, tree, 1);
  TruthOptions options;
  options.wanted = 0;
  const Truth truth = traced_truth(scene, tree, seen.list, seen.pixel, seen.width, options, 1);
  EXPECT_LT(truth.samples, 1000);  // of 2048
  EXPECT_GT(truth.samples, 128);
}

TEST(ShadowTruth, HashKnowsLightReceiversAndOptions) {
  shading::Scene scene = datasets::make_scene("half_plane_edge", 200, 1);
  std::vector<Receiver> receivers{{{0, 0, 0}, {0, 1, 0}}};
  const auto h = truth_hash(scene, receivers, {});
  shading::Scene other = scene;
  other.light.u += other.light.u;
  EXPECT_NE(h, truth_hash(other, receivers, {}));
  TruthOptions more;
  more.most *= 2;
  EXPECT_NE(h, truth_hash(scene, receivers, more));
  receivers[0].position[0] = 1e-9;
  EXPECT_NE(h, truth_hash(scene, receivers, {}));
}

}  // namespace
}  // namespace treeline::bench::shadow
