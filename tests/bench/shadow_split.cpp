// What taking visibility out of the integral does, beside sums over the whole light and its limits.
#include <gtest/gtest.h>

#include <numbers>

#include "bench/shadow/closed_form.hpp"
#include "bench/shadow/split.hpp"
#include "bench/shadow/truth.hpp"
#include "datasets_gen/scenes/scene.hpp"
#include "geometry/random.hpp"

namespace treeline::bench::shadow {
namespace {

/// GGX as books have it: by angles, with Smith's correlated masking.
double textbook_ggx(const Vec3d& l, const Vec3d& v, const Vec3d& n, double alpha) {
  const Vec3d h = normalized(l + v);
  const double a2 = alpha * alpha, nh = dot(n, h), nl = dot(n, l), nv = dot(n, v);
  const double q = nh * nh * (a2 - 1) + 1, d = a2 / (std::numbers::pi * q * q);
  const auto lambda = [&](double c) { return (std::sqrt(1 + a2 * (1 - c * c) / (c * c)) - 1) / 2; };
  return d / (1 + lambda(nl) + lambda(nv)) / (4 * nl * nv);
}

/// A floor under an edge, seen by few pixels, and what the light's size leaves of it.
struct Edge {
  shading::Scene scene = datasets::make_scene("half_plane_edge", 200, 1);
  std::vector<Receiver> receivers;
  Truth truth;

  /// light: its size over the scene's own; or a sun of that angle.
  explicit Edge(double light, bool sun = false) {
    scene.light.u = scene.light.u * light, scene.light.v = scene.light.v * light;
    if (sun) {
      scene.light = {};
      scene.light.kind = LightKind::directional, scene.light.angle = light;
      scene.light.direction = normalized(Vec3d{0.1, -1, 0.05});
    }
    scene.camera.width = 80, scene.camera.height = 60;
    const auto known = datasets::known_shadows("half_plane_edge");
    for (const Receiver& r : receivers_of(scene, Tree(scene.mesh), 1).list)
      if (const double v = visible_past(known.blockers, scene.light, r.position); v > 0 && v < 1)
        receivers.push_back(r), truth.visibility.push_back(v);
  }
  std::array<double, split_roughness.size()> errors(const SplitOptions& options = {}) const {
    return split_errors(scene, Tree(scene.mesh), receivers, truth, options, 1);
  }
  /// Whether a ray passes the edge, by its plane.
  bool lit(const Vec3d& from, const ToLight& to) const {
    const datasets::HalfPlane plane = datasets::known_shadows("half_plane_edge").blockers.planes.at(0);
    const Vec3d normal = cross(plane.along, plane.into);
    const double t = dot(plane.point - from, normal) / dot(to.direction, normal);
    return !(t > 0 && t < to.distance && dot(from + to.direction * t - plane.point, plane.into) > 0);
  }
};

TEST(ShadowSplit, WeightsAreTheTextbooks) {
  geometry::Pcg32 random(8);
  shading::Light light;
  light.kind = LightKind::rectangle, light.direction = {0, -1, 0}, light.position = {0, 3, 0};
  light.u = {1, 0, 0}, light.v = {0, 0, 1};
  for (int k = 0; k < 200; ++k) {
    const Vec3d normal = normalized(Vec3d{random.uniform(-0.3, 0.3), 1, random.uniform(-0.3, 0.3)});
    const Receiver r{{random.uniform(-1.0, 1.0), 0, random.uniform(-1.0, 1.0)}, normal};
    const ToLight to = to_light(light, r.position, random.uniform(), random.uniform());
    const Vec3d eye = mirrored_light(light, r), middle = to_light(light, r.position).direction;
    EXPECT_NEAR(length(eye + middle - normal * (2 * dot(normal, middle))), 0, 1e-12);
    const double geometry = dot(to.direction, normal) * to.direction[1] / (to.distance * to.distance);
    for (const double alpha : split_roughness) {
      const double f = std::isinf(alpha) ? 1 : textbook_ggx(to.direction, eye, normal, alpha);
      const double told = split_weight(light, to, normal, eye, alpha);
      EXPECT_NEAR(told / (f * geometry), 1, 1e-9) << alpha;
    }
  }
}

void expect_sums(const Edge& edge) {
  ASSERT_GT(edge.receivers.size(), 100u);
  constexpr int n = 96;
  std::array<double, split_roughness.size()> squares{};
  for (std::size_t i = 0; i < edge.receivers.size(); ++i) {
    const Receiver& r = edge.receivers[i];
    const Vec3d eye = mirrored_light(edge.scene.light, r);
    std::array<double, split_roughness.size()> seen{}, all{};
    int free = 0;
    for (int a = 0; a < n; ++a)
      for (int b = 0; b < n; ++b) {
        const ToLight to = to_light(edge.scene.light, r.position, (a + 0.5) / n, (b + 0.5) / n);
        const bool lit = edge.lit(r.position, to);
        free += lit;
        for (std::size_t k = 0; k < all.size(); ++k) {
          const double w = split_weight(edge.scene.light, to, r.normal, eye, split_roughness[k]);
          all[k] += w, seen[k] += lit ? w : 0;
        }
      }
    for (std::size_t k = 0; k < all.size(); ++k) {
      const double off = seen[k] / all[k] - double(free) / (n * n);  // so the grid's own steps cancel
      squares[k] += off * off;
    }
  }
  SplitOptions options;
  options.samples = 256;
  const auto told = edge.errors(options);
  for (std::size_t k = 0; k < told.size(); ++k) {
    const double sum = std::sqrt(squares[k] / double(edge.receivers.size()));
    EXPECT_NEAR(told[k], sum, 0.04 * sum + 3e-4) << split_roughness[k];
  }
}

TEST(ShadowSplit, ErrorsAreThoseOfSumsOverTheLight) {
  expect_sums(Edge(1));
  expect_sums(Edge(0.15, true));
}

/// Noise of few samples does not pass for an error.
TEST(ShadowSplit, FewSamplesTellTheSame) {
  const Edge edge(1);
  SplitOptions few, many;
  few.samples = 8, many.samples = 512;
  const auto a = edge.errors(few), b = edge.errors(many);
  for (std::size_t k = 0; k < a.size(); ++k)
    EXPECT_NEAR(a[k], b[k], 0.12 * b[k] + 2e-4) << split_roughness[k];
}

/// The larger the light, and the narrower a lobe, the worse; a mirror sees the middle of the light alone.
TEST(ShadowSplit, GrowsWithLightAndSmoothness) {
  double diffuse = 0;
  for (const double light : {0.25, 1.0, 6.0}) {
    const Edge edge(light);
    SplitOptions options;
    options.samples = 512;
    const auto off = edge.errors(options);
    EXPECT_GT(off[0], 1.5 * diffuse) << light;
    diffuse = off[0];
    for (std::size_t k = 3; k < off.size(); ++k)  // lobes wider than the light make no difference
      EXPECT_GT(off[k], off[k - 1]) << light << ' ' << split_roughness[k];
    double sum = 0;
    for (std::size_t i = 0; i < edge.receivers.size(); ++i) {
      const Receiver& r = edge.receivers[i];
      const double d =
          edge.lit(r.position, to_light(edge.scene.light, r.position)) - edge.truth.visibility[i];
      sum += d * d;
    }
    const double mirror = std::sqrt(sum / double(edge.receivers.size()));
    EXPECT_LT(off.back(), mirror) << light;
    if (light == 6.0) {
      EXPECT_GT(off.back(), 0.5 * mirror);
    }
  }
}

/// Receivers in full light and in full shadow have no error, but they count.
TEST(ShadowSplit, IsOverTheWholeImage) {
  Edge edge(1);
  const auto penumbra = edge.errors();
  const std::size_t n = edge.receivers.size();
  for (std::size_t i = 0; i < 3 * n; ++i)
    edge.receivers.push_back(edge.receivers[i % n]), edge.truth.visibility.push_back(i % 2 == 0 ? 0 : 1);
  const auto image = edge.errors();
  for (std::size_t k = 0; k < image.size(); ++k) EXPECT_NEAR(image[k], penumbra[k] / 2, 1e-12);
}

/// So many as are asked for, from all of them.
TEST(ShadowSplit, FewerReceiversAreTakenEvenly) {
  Edge edge(1);
  SplitOptions one;
  one.most = 1;
  Edge first = edge;
  first.receivers.resize(1), first.truth.visibility.resize(1);
  EXPECT_EQ(edge.errors(one), first.errors());
  EXPECT_NE(edge.errors(one), edge.errors());

  // Before them as many without an error: told to be in penumbra, but all light.
  const auto alone = edge.errors();
  const std::size_t n = edge.receivers.size();
  const Receiver lit{{3.5, 0, 0}, {0, 1, 0}};
  ASSERT_EQ(visible_past(datasets::known_shadows("half_plane_edge").blockers, edge.scene.light, lit.position),
            1);
  edge.receivers.insert(edge.receivers.begin(), n, lit);
  edge.truth.visibility.insert(edge.truth.visibility.begin(), n, 0.5);
  SplitOptions half;
  half.most = n;
  const auto both = edge.errors(half);
  for (std::size_t k = 0; k < both.size(); ++k)
    EXPECT_NEAR(both[k], alone[k] * std::sqrt(0.5), 0.15 * alone[k]);
}

}  // namespace
}  // namespace treeline::bench::shadow
