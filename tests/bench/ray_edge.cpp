// The rays of the set `edge`: they meet the mesh at its edges and vertices, could not miss it if moved a
// little, and tell ray tests that leak from those that do not.
#include <gtest/gtest.h>

#include <set>

#include "bench/ray/block.hpp"
#include "bench/ray/edge_rays.hpp"
#include "bench/ray/task.hpp"
#include "datasets_gen/dataset.hpp"
#include "geometry/tolerances.hpp"

namespace treeline::bench::ray {
namespace {

using geometry::Mesh3f;
using geometry::Rayd;
using geometry::Rayf;
using geometry::Triangle3d;
using geometry::Vec3d;

std::vector<Rayf> edge_set(const Mesh3f& mesh, std::size_t count, std::uint64_t seed = 5) {
  return make_ray_sets(mesh, count, seed, 1).back().rays;
}

Rayd wide(const Rayf& r) { return {Vec3d(r.origin), Vec3d(r.direction), double(r.t_min), double(r.t_max)}; }

double distance_to_segment(const Vec3d& p, const Vec3d& a, const Vec3d& b) {
  const Vec3d along = b - a;
  const double s = std::clamp(geometry::dot(p - a, along) / geometry::length2(along), 0.0, 1.0);
  return geometry::distance(p, a + along * s);
}

/// How far a ray may come out beside what it was aimed at: half an ulp along each axis, of its own
/// coordinates.
double aim_error(const Rayf& r) {
  return geometry::tolerance::unit_roundoff<float> * geometry::length(Vec3d(r.direction)) * std::sqrt(3.0);
}

/// The same triangles without shared indices, as files of loose triangles have them: closed all the same.
Mesh3f loose(const Mesh3f& mesh) {
  Mesh3f out;
  for (std::size_t f = 0; f < mesh.size(); ++f) {
    const auto t = mesh.triangle(f);
    const auto first = static_cast<std::uint32_t>(out.vertices.size());
    out.vertices.insert(out.vertices.end(), {t.a, t.b, t.c});
    out.faces.push_back({first, first + 1, first + 2});
  }
  return out;
}

TEST(RayEdge, MeetsEdgesAndVerticesByTurns) {
  for (const char* name : {"icosphere", "terrain", "architecture"}) {
    SCOPED_TRACE(name);
    const Mesh3f mesh = datasets::generate(name, 1000, 3).mesh;
    const auto rays = edge_set(mesh, 400);
    const auto truth = true_closest(mesh, rays, 1);
    ASSERT_EQ(rays.size(), 400u);
    std::size_t aside = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      ASSERT_TRUE(truth[i]) << i;
      aside += !(std::abs(truth[i].t - 1) < 1e-5);
      if (name == std::string("architecture")) continue;  // its beams end in the middle of others' faces
      const Vec3d at = wide(rays[i]).at(truth[i].t);
      const Triangle3d t(mesh.triangle(truth[i].primitive));
      const double to_edge = std::min({distance_to_segment(at, t.a, t.b), distance_to_segment(at, t.b, t.c),
                                       distance_to_segment(at, t.c, t.a)});
      const double to_vertex =
          std::min({geometry::distance(at, t.a), geometry::distance(at, t.b), geometry::distance(at, t.c)});
      // A plane that the ray crosses at a slant draws its error out, ten times at most (the cosine allowed).
      EXPECT_LE(i % 2 == 1 ? to_vertex : to_edge, 11 * aim_error(rays[i])) << i;
    }
    EXPECT_LE(aside, 8u) << "aimed at what cannot be seen, among beams that hide each other";
  }
}

TEST(RayEdge, CannotMissIfMovedByARounding) {
  const Mesh3f sphere = datasets::generate("icosphere", 1000, 3).mesh;
  for (const Mesh3f& mesh : {sphere, loose(sphere), datasets::generate("terrain", 1000, 3).mesh}) {
    std::vector<accel::Id> all(mesh.size());
    for (std::size_t f = 0; f < all.size(); ++f) all[f] = static_cast<accel::Id>(f);
    std::size_t missed = 0, cast = 0;
    for (const Rayf& ray : edge_set(mesh, 100)) {
      const double far = 8 * aim_error(ray);
      for (int axis = 0; axis < 3; ++axis)
        for (const double side : {-far, far}) {
          Rayd moved = wide(ray);
          moved.origin[axis] += side;
          missed += !exact_closest(mesh, all, moved), ++cast;
        }
    }
    EXPECT_EQ(missed, 0u) << "of " << cast;
  }
}

TEST(RayEdge, TellsMethodsThatLeakFromThoseThatDoNot) {
  const RayTask task;
  RunContext context;  // the quick profile: 4096 rays
  const auto block = task.open(BlockSpec{"icosphere", 1000}, context);
  const auto& sets = block->query_sets();
  const auto edge = static_cast<std::size_t>(
      std::find_if(sets.begin(), sets.end(), [](const QuerySet& s) { return s.name == "edge"; }) -
      sets.begin());
  ASSERT_LT(edge, sets.size());
  std::set<std::string> tried;
  for (std::size_t m = 0; m < task.methods().size(); ++m) {
    const MethodInfo& info = task.methods()[m];
    if (info.source != Source::ours || info.hard_cases_only) continue;
    tried.insert(info.name);
    const auto subject = block->build(m, info.build_knobs[0], 1);
    subject->run(edge, Knobs::object(), 1);
    const Errors errors = block->check(m, *subject, edge, Knobs::object());
    EXPECT_TRUE(errors.within_claim) << info.name << ": " << errors.reason;
    EXPECT_EQ(errors.extra.at("ray_hit_share"), 1.0);
    const auto misses = errors.extra.at("ray_false_misses").get<std::size_t>();
    if (info.claim == Claim::approximate) {
      // Edges as Möller and Trumbore compute them leak by the percent at vertices.
      EXPECT_GT(misses, 40u) << info.name;
      EXPECT_EQ(errors.max, 1) << info.name;
    } else {
      EXPECT_EQ(misses, 0u) << info.name;
      EXPECT_EQ(errors.extra.at("ray_false_hits"), 0) << info.name;
      EXPECT_LT(errors.max.value(), 1e-5) << info.name;
    }
  }
  EXPECT_TRUE(tried.contains("bvh") && tried.contains("bvh_fast"));
}

TEST(RayEdge, IsTheSameForTheSameSeed) {
  const Mesh3f mesh = datasets::generate("icosphere", 1000, 3).mesh;
  EXPECT_EQ(hash_of(edge_set(mesh, 256, 7)), hash_of(edge_set(mesh, 256, 7)));
  EXPECT_NE(hash_of(edge_set(mesh, 256, 7)), hash_of(edge_set(mesh, 256, 8)));
}

TEST(RayEdge, EverySetOfAPoorMeshHasRays) {
  const Mesh3f triangle{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
  Mesh3f mostly_flat = triangle;
  mostly_flat.vertices.push_back({2, 0, 0});
  for (int i = 0; i < 10000; ++i) mostly_flat.faces.push_back({0, 1, 3});
  Mesh3f broken = triangle;
  broken.vertices.push_back({std::numeric_limits<float>::quiet_NaN(), 0, 0});
  for (int i = 0; i < 100; ++i) broken.faces.push_back({0, 1, 3});
  for (const Mesh3f& mesh : {triangle, mostly_flat, broken}) {
    for (const RaySet& set : make_ray_sets(mesh, 256, 5, 1)) EXPECT_GT(set.rays.size(), 0u) << set.name;
    EXPECT_EQ(edge_set(mesh, 256).size(), 256u);
  }
}

}  // namespace
}  // namespace treeline::bench::ray
