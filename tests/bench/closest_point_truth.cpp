// The two truths of the task closest_point, brute force measured without an error and CGAL's exact kernel,
// must agree: on all query sets, on slivers and on all hard cases.
#include <gtest/gtest.h>

#include "bench/closest_point/oracle.hpp"
#include "bench/closest_point/queries.hpp"
#include "bench/closest_point/truth.hpp"
#include "datasets_gen/dataset.hpp"
#include "datasets_gen/hard/hard_case.hpp"

namespace treeline::bench::closest_point {
namespace {

using geometry::Mesh3f;
using geometry::Vec3d;
using geometry::Vec3f;

std::vector<Vec3f> some(const std::vector<Vec3f>& all, std::size_t most) {
  std::vector<Vec3f> out;
  for (std::size_t i = 0; i < all.size(); i += std::max<std::size_t>(1, all.size() / most))
    out.push_back(all[i]);
  return out;
}

void expect_agreement(const Mesh3f& mesh, const std::vector<Vec3f>& queries) {
  const auto truth = true_closest(mesh, queries, 1);
  const auto oracle = oracle_closest(mesh, queries);
  if (!oracle) GTEST_SKIP() << "built without CGAL";
  for (std::size_t i = 0; i < queries.size(); ++i) {
    ASSERT_EQ(static_cast<bool>(truth[i]), static_cast<bool>((*oracle)[i])) << "query " << i;
    if (!truth[i]) continue;
    // CGAL's conversion to double may be off by an ulp. Ties in the rounded square need not be exact ones.
    ASSERT_NEAR(truth[i].distance2, (*oracle)[i].distance2, 0x1p-52 * truth[i].distance2) << "query " << i;
    if (truth[i].primitive != (*oracle)[i].primitive) {
      const Vec3f& q = queries[i];
      Mesh3f alone{mesh.vertices, {mesh.faces[(*oracle)[i].primitive]}};
      ASSERT_EQ(true_closest(alone, std::vector{q}, 1)[0].distance2, truth[i].distance2) << "query " << i;
    }
  }
}

TEST(ClosestPointTruth, AgreesWithTheOracleOnAllQuerySets) {
  for (const char* name : {"icosphere", "forest", "architecture", "needles", "caps"}) {
    const auto dataset = datasets::generate(name, 1000, 3);
    for (const auto& set : make_point_sets(dataset.mesh, {6, 3, 3}, 5)) {
      SCOPED_TRACE(std::string(name) + " " + set.name);
      expect_agreement(dataset.mesh, set.points.floats);
    }
  }
}

TEST(ClosestPointTruth, AgreesWithTheOracleOnAllHardCases) {
  for (const auto& c : datasets::hard_cases()) {
    if (!c.for_closest_points()) continue;
    SCOPED_TRACE(c.name);
    expect_agreement(
        c.mesh, some(c.probes, std::max<std::size_t>(3, 8000 / std::max<std::size_t>(c.mesh.size(), 1))));
  }
}

TEST(ClosestPointTruth, FindsTheDistanceToABall) {
  // Closed form: from outside, a point is nearer to the ball's surface than to its inscribed mesh, by at most
  // the sagitta of a face; from the centre, the mesh's nearest face is as far as its height.
  for (const auto& c : datasets::hard_cases()) {
    if (c.name != "closest_middle_of_a_ball") continue;
    const std::vector<Vec3f> queries{{2, 0, 0}, {0, -3, 0}, {0.5f, 0.5f, 4}, {0, 0, 0}};
    const auto truth = true_closest(c.mesh, queries, 1);
    double longest = 0;
    for (std::size_t f = 0; f < c.mesh.size(); ++f) {
      const geometry::Triangle3d t(c.mesh.triangle(f));
      longest = std::max({longest, length(t.b - t.a), length(t.c - t.b), length(t.a - t.c)});
    }
    const double sagitta =
        1 - std::sqrt(1 - longest * longest / 3);  // of a face's circumscribed circle at most
    for (std::size_t i = 0; i < queries.size(); ++i) {
      const double to_ball = std::abs(length(Vec3d(queries[i])) - 1);
      const double d = std::sqrt(truth[i].distance2);
      EXPECT_LE(std::abs(d - to_ball), sagitta + 1e-6) << i;
      EXPECT_GE(i < 3 ? d - to_ball : to_ball - d, -1e-6) << i;
    }
    return;
  }
  FAIL() << "the case is gone";
}

TEST(ClosestPointTruth, KeepsItsConventions) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const Mesh3f square{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {nan, 0, 0}},
                      {{0, 1, 2}, {0, 2, 3}, {0, 1, 4}}};
  const auto ask = [&](const Mesh3f& mesh, const Vec3f& q) {
    return true_closest(mesh, std::vector{q}, 1)[0];
  };
  EXPECT_EQ(ask(square, {0.75f, 0.25f, 2}), (TrueClosest{4, 0}));
  EXPECT_EQ(ask(square, {0.5f, 0.5f, 2}), (TrueClosest{4, 0})) << "shared edge: lowest id";
  EXPECT_EQ(ask(square, {0.25f, 0.75f, 0}), (TrueClosest{0, 1})) << "closed sets";
  EXPECT_EQ(ask(square, {4, 5, 0}), (TrueClosest{25, 0})) << "a corner";
  EXPECT_FALSE(ask(square, {nan, 0.25f, 2}));
  EXPECT_FALSE(ask({{{nan, 0, 0}}, {{0, 0, 0}}}, {0, 0, 0})) << "no finite triangle";
  EXPECT_FALSE(ask({}, {0, 0, 0}));
  const Mesh3f flat{{{0, 0, 0}, {4, 0, 0}, {2, 0, 0}}, {{0, 1, 2}}};
  EXPECT_EQ(ask(flat, {3, 0, 2}), (TrueClosest{4, 0})) << "no area: the segment that it covers";
}

TEST(ClosestPointTruth, IsTheSameOnSeveralThreads) {
  const auto mesh = datasets::generate("forest", 2000, 3).mesh;
  const auto queries = make_point_sets(mesh, {700, 1, 1}, 5)[0].points.floats;
  EXPECT_EQ(true_closest(mesh, queries, 1), true_closest(mesh, queries, 2));
}

}  // namespace
}  // namespace treeline::bench::closest_point
