// The two truths of the task ray, brute force with exact signs and CGAL's exact kernel, must agree: on random
// rays, on rays aimed exactly at vertices and edges, and on all hard cases.
#include <gtest/gtest.h>

#include "bench/ray/oracle.hpp"
#include "bench/ray/queries.hpp"
#include "bench/ray/truth.hpp"
#include "datasets_gen/dataset.hpp"
#include "datasets_gen/hard/hard_case.hpp"
#include "geometry/random.hpp"

namespace treeline::bench::ray {
namespace {

using geometry::Mesh3f;
using geometry::Rayd;
using geometry::Rayf;
using geometry::Vec3d;
using geometry::Vec3f;

/// t equal up to the last roundings to double; ids equal unless the other id is hit at the same t, too.
void expect_agreement(const Mesh3f& mesh, const std::vector<Rayf>& rays) {
  const auto truth = true_closest(mesh, rays, 1);
  const auto oracle = oracle_closest(mesh, rays);
  if (!oracle) GTEST_SKIP() << "built without CGAL";
  ASSERT_EQ(truth.size(), rays.size());
  ASSERT_EQ(oracle->size(), rays.size());
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const TrueHit& a = truth[i];
    const TrueHit& b = (*oracle)[i];
    ASSERT_EQ(static_cast<bool>(a), static_cast<bool>(b)) << "ray " << i;
    if (!a) continue;
    ASSERT_NEAR(a.t, b.t, 4e-16 * std::abs(b.t)) << "ray " << i;
    if (a.primitive == b.primitive) continue;
    const Rayd ray{Vec3d(rays[i].origin), Vec3d(rays[i].direction), rays[i].t_min, rays[i].t_max};
    const auto tied = exact_closest(mesh, std::span(&b.primitive, 1), ray);
    ASSERT_TRUE(tied) << "ray " << i;
    ASSERT_NEAR(tied.t, a.t, 4e-16 * std::abs(a.t)) << "ray " << i;
  }
}

TEST(RayTruth, AgreesWithTheOracleOnRaysThatARendererCasts) {
  for (const char* name : {"icosphere", "forest", "architecture"}) {
    const auto dataset = datasets::generate(name, 1000, 3);
    for (const auto& set : make_ray_sets(dataset.mesh, 64, 5, 1)) {
      SCOPED_TRACE(std::string(name) + " " + set.name);
      expect_agreement(dataset.mesh, set.rays);
    }
  }
}

TEST(RayTruth, AgreesWithTheOracleOnRaysAimedAtVerticesAndEdges) {
  const auto mesh = datasets::generate("icosphere", 1000, 3).mesh;
  const Vec3f centre = mesh.box().centre();
  std::vector<Rayf> rays;
  for (std::size_t f = 0; f < 60; ++f) {
    const auto t = mesh.triangle(f * 7 % mesh.size());
    rays.push_back({centre, t.a - centre});
    rays.push_back({centre, (t.a + t.b) * 0.5f - centre});
    rays.push_back({t.b, t.c - t.b});  // along an edge
    rays.push_back({t.a, centre - t.a, 0.0f, 1.0f});
  }
  expect_agreement(mesh, rays);
}

TEST(RayTruth, AgreesWithTheOracleOnAllHardCases) {
  for (const auto& c : datasets::hard_cases()) {
    if (!c.for_rays()) continue;
    SCOPED_TRACE(c.name);
    // The exact kernel is slow where nothing can be told apart by intervals: an even selection will do there.
    std::vector<Rayf> rays;
    const std::size_t least = c.mesh.size() > 30'000 ? 1 : 10;
    const std::size_t most = std::max(least, 80'000 / std::max<std::size_t>(c.mesh.size(), 1));
    const std::size_t step = std::max<std::size_t>(1, c.rays.size() / most);
    for (std::size_t i = 0; i < c.rays.size(); i += step) rays.push_back(c.rays[i]);
    for (const auto& out : c.outward) rays.push_back(out.rays.front());
    expect_agreement(c.mesh, rays);
  }
}

// A unit square in two triangles, in the plane z = 0.
const Mesh3f square{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}};

TrueHit shoot(const Mesh3f& mesh, const Rayf& ray) { return true_closest(mesh, std::vector{ray}, 1)[0]; }

TEST(RayTruth, KeepsItsConventions) {
  EXPECT_EQ(shoot(square, {{0.75f, 0.25f, 2}, {0, 0, -1}}), (TrueHit{2, 0}));
  EXPECT_EQ(shoot(square, {{0.5f, 0.5f, 2}, {0, 0, -1}}), (TrueHit{2, 0})) << "shared edge: lowest id";
  EXPECT_EQ(shoot(square, {{0, 1, 2}, {0, 0, -2}}), (TrueHit{1, 1})) << "a corner belongs to its triangle";
  EXPECT_EQ(shoot(square, {{0.25f, 0.75f, -2}, {0, 0, 1}}), (TrueHit{2, 1})) << "from behind";
  EXPECT_FALSE(shoot(square, {{-1, 0.5f, 0}, {1, 0, 0}})) << "a ray in the plane";
  EXPECT_TRUE(shoot(square, {{0.75f, 0.25f, 2}, {0, 0, -1}, 0, 2})) << "t_max belongs to the ray";
  EXPECT_TRUE(shoot(square, {{0.75f, 0.25f, 2}, {0, 0, -1}, 2, 3})) << "t_min belongs to the ray";
  EXPECT_FALSE(shoot(square, {{0.75f, 0.25f, 2}, {0, 0, -1}, 0, std::nextafter(2.0f, 0.0f)}));
  EXPECT_FALSE(shoot(square, {{0.75f, 0.25f, 2}, {0, 0, 1}})) << "behind the origin";
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(shoot(square, {{nan, 0.25f, 2}, {0, 0, -1}}));
  Mesh3f broken = square;
  broken.vertices[3][0] = nan;
  EXPECT_FALSE(shoot(broken, {{0.25f, 0.75f, 2}, {0, 0, -1}})) << "a broken triangle is left out";
  EXPECT_TRUE(shoot(broken, {{0.75f, 0.25f, 2}, {0, 0, -1}})) << "the others stay";
  const Mesh3f flat{{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 1, 2}}};
  EXPECT_FALSE(shoot(flat, {{1, 0, 2}, {0, 0, -1}})) << "no area, no hit";
}

TEST(RayTruth, FindsEveryFaceNearARay) {
  const auto mesh = datasets::generate("architecture", 1000, 3).mesh;
  std::vector<accel::Id> all(mesh.size());
  for (std::size_t f = 0; f < all.size(); ++f) all[f] = static_cast<accel::Id>(f);
  std::size_t kept = 0, boxes = 0;
  for (const auto& set : make_ray_sets(mesh, 9, 5, 1))
    for (const Rayf& r : set.rays) {
      const Rayd ray{Vec3d(r.origin), Vec3d(r.direction), r.t_min, r.t_max};
      for (const double distance : {0.0, 1e-9, 1e-4, 0.1}) {
        const auto near = faces_near(mesh, RunBoxes(mesh), ray, distance);
        kept += near.size();
        // What a ray moved by the distance hits must be among them.
        for (int axis = 0; axis < 3; ++axis)
          for (const double side : {-distance, distance}) {
            Rayd moved = ray;
            moved.origin[axis] += side;
            const TrueHit hit = exact_closest(mesh, all, moved);
            ASSERT_EQ(exact_closest(mesh, near, moved), hit) << set.name << " " << distance;
            ++boxes;
          }
      }
    }
  EXPECT_LT(kept, boxes * 4) << "few of the thousand";
}

TEST(RayTruth, DoesNotDependOnThreads) {
  const auto mesh = datasets::generate("forest", 2000, 3).mesh;
  for (const auto& set : make_ray_sets(mesh, 256, 5, 1))
    EXPECT_EQ(true_closest(mesh, set.rays, 1), true_closest(mesh, set.rays, 3)) << set.name;
}

}  // namespace
}  // namespace treeline::bench::ray
