// The truth of the task inside: two independent counts agree, and the judge tells what is wrong.
#include <gtest/gtest.h>

#include "accel/signed_distance/winding_tree.hpp"
#include "bench/inside/judge.hpp"
#include "bench/inside/queries.hpp"
#include "datasets_gen/dataset.hpp"
#include "datasets_gen/hard/hard_insides.hpp"
#include "geometry/closedness.hpp"

namespace treeline::bench::inside {
namespace {

using geometry::Mesh3f;
using geometry::Vec3f;

/// Against solid angles, where these are certain: the winding number is then a whole one.
std::size_t expect_agreement(const Mesh3f& mesh, const std::vector<Vec3f>& points) {
  const std::vector<Side> sides = true_sides(mesh, points, 1);
  EXPECT_EQ(sides, true_sides(mesh, points, 3));
  const accel::WindingTree<float> sum(mesh, std::numeric_limits<double>::infinity(), 1);
  std::size_t told = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const accel::WindingNumber w = sum(points[i]);
    if (w.on_surface) {
      EXPECT_EQ(sides[i], Side::surface) << i;
    } else if (std::abs(w.value - std::round(w.value)) < 1e-3) {
      EXPECT_EQ(sides[i], std::round(w.value) != 0 ? Side::inside : Side::outside) << i;
      ++told;
    }
  }
  return told;
}

TEST(InsideTruth, AgreesWithSolidAngles) {
  for (const char* name : {"icosphere", "nested_shells", "torus_knot"}) {
    SCOPED_TRACE(name);
    const auto mesh = datasets::generate(name, 1'000, 3).mesh;
    for (const PointSet& set : make_point_sets(mesh, {300, 200}, false, 4)) {
      SCOPED_TRACE(set.name);
      EXPECT_GT(expect_agreement(mesh, set.points), set.points.size() * 9 / 10);
    }
  }
}

TEST(InsideTruth, AgreesWithSolidAnglesOnHardCases) {
  for (const auto& c : datasets::hard_insides()) {
    if (c.expect != datasets::Expect::answers) continue;
    SCOPED_TRACE(c.name);
    const geometry::Closedness closedness = geometry::closedness(c.mesh);
    EXPECT_TRUE(closedness.closed && closedness.oriented);
    std::vector<Vec3f> some;
    for (std::size_t i = 0; i < c.points.size(); i += c.points.size() / 200 + 1) some.push_back(c.points[i]);
    expect_agreement(c.mesh, some);
  }
}

TEST(InsideTruth, FindsPointsOnTheSurface) {
  const auto mesh = datasets::generate("icosphere", 1'000, 1).mesh;
  for (const Side side : true_sides(mesh, mesh.vertices, 1)) EXPECT_EQ(side, Side::surface);
}

Errors judged(Claim claim, std::vector<Side> truth, std::vector<std::uint8_t> answers, bool whole = true,
              float z = 5) {
  Mesh3f mesh;  // far from the points, or near
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.faces = {{0, 1, 2}};
  const std::vector<Vec3f> points(truth.size(), Vec3f{0.25f, 0.25f, z});
  return judge(mesh, points, truth, answers, {claim, whole});
}

TEST(InsideJudge, CountsWrongAnswersBySide) {
  const auto in = Side::inside, out = Side::outside, on = Side::surface;
  const Errors e = judged(Claim::exact, {in, in, out, out, on}, {1, 0, 1, 1, 1});
  EXPECT_DOUBLE_EQ(*e.error, 0.6);
  EXPECT_DOUBLE_EQ(*e.bias, 0.2);
  EXPECT_FALSE(e.max);  // one wrong answer is as wrong as any
  EXPECT_EQ(e.extra.at("inside_false_inside"), 2);
  EXPECT_EQ(e.extra.at("inside_false_outside"), 1);
  EXPECT_FALSE(e.within_claim);
  EXPECT_NE(e.reason.find("point 1"), std::string::npos) << e.reason;
  const Errors right = judged(Claim::exact, {in, out}, {1, 0});
  EXPECT_TRUE(right.within_claim);
  EXPECT_EQ(*right.error, 0);
}

TEST(InsideJudge, HoldsMethodsToTheirClaims) {
  const auto in = Side::inside, on = Side::surface;
  // On the surface: exact methods must say so.
  EXPECT_FALSE(judged(Claim::exact, {on}, {0}).within_claim);
  EXPECT_TRUE(judged(Claim::bounded, {on}, {0}).within_claim);
  // Within rounding of the surface: bounded ones may be wrong.
  EXPECT_FALSE(judged(Claim::bounded, {in}, {0}).within_claim);
  EXPECT_TRUE(judged(Claim::bounded, {in}, {0}, true, 1e-6f).within_claim);
  EXPECT_FALSE(judged(Claim::exact, {in}, {0}, true, 1e-6f).within_claim);
  // One in a hundred: approximate ones may be wrong.
  std::vector<Side> truth(200, in);
  std::vector<std::uint8_t> answers(200, 1);
  answers[0] = answers[1] = 0;
  EXPECT_TRUE(judged(Claim::approximate, truth, answers).within_claim);
  answers[2] = 0;
  EXPECT_FALSE(judged(Claim::approximate, truth, answers).within_claim);
  // On a damaged mesh nobody promises anything.
  EXPECT_TRUE(judged(Claim::exact, {in}, {0}, false).within_claim);
}

}  // namespace
}  // namespace treeline::bench::inside
