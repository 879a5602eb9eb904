// The judge of the task ray on answers made by hand: each kind of wrong answer is told from the others, and
// from answers that are right within the rounding of float.
#include <gtest/gtest.h>

#include "bench/ray/judge.hpp"
#include "geometry/tolerances.hpp"

namespace treeline::bench::ray {
namespace {

using geometry::Mesh3f;
using geometry::Rayf;

constexpr double u = geometry::tolerance::unit_roundoff<float>;

/// Faces 0, 1: the unit square in z = 0. Faces 2, 3: the same square in z = -1. Face 4 lies aside, in z = 0.
const Mesh3f mesh{{{0, 0, 0},
                   {1, 0, 0},
                   {1, 1, 0},
                   {0, 1, 0},
                   {0, 0, -1},
                   {1, 0, -1},
                   {1, 1, -1},
                   {0, 1, -1},
                   {3, 0, 0},
                   {4, 0, 0},
                   {4, 1, 0}},
                  {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}, {4, 6, 7}, {8, 9, 10}}};

RayAnswer hit(float t, accel::Id primitive) {
  RayAnswer a;
  a.t = t, a.primitive = primitive;
  return a;
}

Judged closest(const Rayf& ray, const RayAnswer& answer) {
  Judge judge(mesh, u);
  return judge.closest(0, ray, true_closest(mesh, std::vector{ray}, 1)[0], answer);
}
Judged any(const Rayf& ray, bool answer) {
  Judge judge(mesh, u);
  return judge.any(0, ray, true_closest(mesh, std::vector{ray}, 1)[0], answer);
}

const Rayf inside{{0.75f, 0.25f, 2}, {0, 0, -1}};
const Rayf aside{{2, 0.5f, 2}, {0, 0, -1}};
const Rayf at_diagonal{{0.5f, 0.5f, 2}, {0, 0, -1}};
const Rayf at_rim{{1, 0.5f, 2}, {0, 0, -1}};

TEST(RayJudge, TakesWhatIsRight) {
  EXPECT_EQ(closest(inside, hit(2, 0)).verdict, Verdict::right);
  EXPECT_EQ(closest(inside, hit(2, 0)).error, 0);
  EXPECT_EQ(closest(aside, {}).verdict, Verdict::right);
  EXPECT_EQ(any(inside, true).verdict, Verdict::right);
  EXPECT_EQ(any(aside, false).verdict, Verdict::right);
}

TEST(RayJudge, TakesBothSidesOfATie) {
  EXPECT_EQ(closest(at_diagonal, hit(2, 0)).verdict, Verdict::right);
  EXPECT_EQ(closest(at_diagonal, hit(2, 1)).verdict, Verdict::right);
}

TEST(RayJudge, MeasuresTheErrorOfT) {
  const float t = std::nextafter(2.0f, 3.0f);
  const Judged j = closest(inside, hit(t, 0));
  EXPECT_EQ(j.verdict, Verdict::right);
  EXPECT_DOUBLE_EQ(j.error, (double(t) - 2) / 2);
  EXPECT_DOUBLE_EQ(j.signed_error, j.error);
  EXPECT_LT(closest(inside, hit(std::nextafter(2.0f, 1.0f), 0)).signed_error, 0);
}

TEST(RayJudge, TellsAFalseHit) {
  for (const accel::Id face : {0u, 2u, 4u}) {
    const Judged j = closest(aside, hit(2, face));
    EXPECT_EQ(j.verdict, Verdict::false_hit);
    EXPECT_EQ(j.error, 1);
    EXPECT_FALSE(j.excused);
  }
  EXPECT_EQ(closest(inside, hit(1, 0)).verdict, Verdict::wrong_t);
  EXPECT_EQ(closest(inside, hit(1, 4)).verdict, Verdict::false_hit)
      << "in front of the surface there is nothing";
  EXPECT_EQ(any(aside, true).verdict, Verdict::false_hit);
}

TEST(RayJudge, TellsAFalseMiss) {
  const Judged missed = closest(inside, {});
  EXPECT_EQ(missed.verdict, Verdict::false_miss);
  EXPECT_EQ(missed.error, 1);
  EXPECT_FALSE(missed.excused);
  const Judged through = closest(inside, hit(3, 2));
  EXPECT_EQ(through.verdict, Verdict::false_miss) << "went through the upper square";
  EXPECT_EQ(through.error, 1);
  EXPECT_EQ(any(inside, false).verdict, Verdict::false_miss);
}

TEST(RayJudge, TellsAWrongT) {
  const Judged j = closest(inside, hit(2.001f, 0));
  EXPECT_EQ(j.verdict, Verdict::wrong_t);
  EXPECT_NEAR(j.error, 0.0005, 1e-6);
  EXPECT_FALSE(j.excused);
}

TEST(RayJudge, TellsAWrongPrimitive) {
  EXPECT_EQ(closest(inside, hit(2, 1)).verdict, Verdict::wrong_primitive);
  EXPECT_EQ(closest(inside, hit(2, 4)).verdict, Verdict::wrong_primitive);
  EXPECT_EQ(closest(inside, hit(2, 1000)).verdict, Verdict::wrong_primitive) << "no such triangle";
}

TEST(RayJudge, LetsASilhouetteGoEitherWay) {
  // Exactly over the rim of both squares: hitting the upper, the lower or neither is right for a ray moved by
  // less than float can tell.
  EXPECT_EQ(closest(at_rim, hit(2, 0)).verdict, Verdict::right);
  EXPECT_EQ(closest(at_rim, hit(3, 2)).verdict, Verdict::borderline);
  EXPECT_EQ(closest(at_rim, {}).verdict, Verdict::borderline);
  EXPECT_EQ(any(at_rim, false).verdict, Verdict::borderline);
  // One thousandth inside or outside of it, it may not.
  const Rayf in{{0.999f, 0.5f, 2}, {0, 0, -1}}, out{{1.001f, 0.5f, 2}, {0, 0, -1}};
  EXPECT_EQ(closest(in, {}).verdict, Verdict::false_miss);
  EXPECT_EQ(closest(out, hit(2, 0)).verdict, Verdict::false_hit);
  EXPECT_EQ(any(out, true).verdict, Verdict::false_hit);
}

TEST(RayJudge, DrawsTheLineAtEps) {
  const double eps = 32 * u * 2;  // the largest coordinate is the origin's 2
  for (const double share : {0.5, 2.0}) {
    const Rayf out{{static_cast<float>(1 + share * eps), 0.5f, 2}, {0, 0, -1}};
    const bool within = share < 1;
    EXPECT_EQ(closest(out, hit(2, 0)).counts_as_right(), within);
    EXPECT_EQ(any(out, true).counts_as_right(), within);
    const Rayf in{{static_cast<float>(1 - share * eps), 0.5f, 2}, {0, 0, -1}};
    EXPECT_EQ(closest(in, {}).counts_as_right(), within);
    EXPECT_EQ(any(in, false).counts_as_right(), within);
  }
}

TEST(RayJudge, TakesTheScaleFromTheTrianglesInvolved) {
  const Judge judge(mesh, u);
  EXPECT_DOUBLE_EQ(judge.eps(inside, {}), 32 * u * 2) << "the ray's origin";
  EXPECT_DOUBLE_EQ(judge.eps(inside, std::vector<accel::Id>{0, 4}), 32 * u * 4) << "face 4 reaches to x = 4";
  EXPECT_DOUBLE_EQ(judge.eps(inside, std::vector<accel::Id>{0, 1000, accel::no_id}), 32 * u * 2)
      << "no faces";
}

/// The same with a triangle far away, face 5, which no ray here comes near, and one that reaches from the
/// origin to there, far below both squares, face 6.
Mesh3f with_strays() {
  Mesh3f far = mesh;
  far.vertices.insert(far.vertices.end(),
                      {{1e6f, 1e6f, 1e6f}, {1e6f, 1e6f + 1, 1e6f}, {1e6f, 1e6f, 1e6f + 1}});
  far.vertices.insert(far.vertices.end(), {{-1, -1, -20}, {1e6f, -1, -20}, {-1, 1e6f, -20}});
  far.faces.push_back({11, 12, 13}), far.faces.push_back({14, 15, 16});
  return far;
}

TEST(RayJudge, AStrayTriangleFarAwayExcusesNothing) {
  const Mesh3f far = with_strays();
  Judge judge(far, u);
  std::size_t number = 0;
  const auto verdict = [&](const Rayf& ray, const RayAnswer& answer) {
    return judge.closest(number++, ray, true_closest(far, std::vector{ray}, 1)[0], answer).verdict;
  };
  const auto any_verdict = [&](const Rayf& ray, bool answer) {
    return judge.any(number++, ray, true_closest(far, std::vector{ray}, 1)[0], answer).verdict;
  };
  // A thousand times what a ray test may be off by, and a thousandth of what the far corners would allow.
  const auto off = static_cast<float>(1000 * 32 * u * 2);
  ASSERT_LT(off, 32 * u * 1e6 / 100);
  EXPECT_EQ(verdict(inside, hit(2 + off, 0)), Verdict::wrong_t);
  EXPECT_EQ(verdict(inside, hit(2 - off, 0)), Verdict::wrong_t);
  Rayf out = at_rim, in = at_rim;
  out.origin[0] += off, in.origin[0] -= off;
  for (Rayf* ray : {&out, &in}) ray->t_max = 2.5f;  // before the lower square
  EXPECT_EQ(verdict(out, hit(2, 0)), Verdict::false_hit);
  EXPECT_EQ(verdict(in, {}), Verdict::false_miss);
  EXPECT_EQ(any_verdict(out, true), Verdict::false_hit);
  EXPECT_EQ(any_verdict(in, false), Verdict::false_miss);
  // A ray that meets nothing else than face 6 may be wrong by its size.
  const Rayf below{{0.75f, 0.25f, -19.5f}, {0, 0, -1}};
  EXPECT_EQ(verdict(below, hit(0.5f + off, 6)), Verdict::right);
}

TEST(RayJudge, TakesTheScaleFromWhatTheRayMeetsOnItsWay) {
  // The ray passes just inside the rim of face 0, well inside the rim of face 1, and ends on face 2. Whether
  // a ray test may miss face 1 hangs on how far that face reaches.
  for (const float reach : {1.0f, 1e4f}) {
    const Mesh3f stack{{{0, -1, -1},
                        {0, 1, -1},
                        {1, 0, -1},
                        {-0.001f, -1, -2},
                        {-0.001f, 1, -2},
                        {reach, 0, -2},
                        {-1, -1, -3},
                        {-1, 1, -3},
                        {1, 0, -3}},
                       {{0, 1, 2}, {3, 4, 5}, {6, 7, 8}}};
    const Rayf ray{{1e-7f, 0, 0}, {0, 0, -1}};
    const Judged j = Judge(stack, u).closest(0, ray, true_closest(stack, std::vector{ray}, 1)[0], hit(3, 2));
    EXPECT_EQ(j.verdict, reach == 1 ? Verdict::false_miss : Verdict::borderline);
  }
}

TEST(RayJudge, CountsALeakAtAnInnerEdgeAsFalseButExcusesApproximateMethods) {
  for (const RayAnswer& answer : {RayAnswer{}, hit(3, 2)}) {
    const Judged j = closest(at_diagonal, answer);
    EXPECT_EQ(j.verdict, Verdict::false_miss) << "however it is moved, the ray meets one of the two";
    EXPECT_EQ(j.error, 1);
  }
  EXPECT_TRUE(closest(at_diagonal, hit(3, 2)).excused);
  EXPECT_TRUE(any(at_diagonal, false).excused);
  EXPECT_FALSE(any(inside, false).excused);
}

TEST(RayJudge, ExcusesTheTOfAThinTriangleByItsThinness) {
  const Mesh3f needle{{{-4, -0.005f, 0}, {4, -0.005f, 0}, {0, 0.005f, 0}}, {{0, 1, 2}}};
  const Rayf ray{{0.5f, 0, 2}, {0, 0, -1}};
  const double eps = 32 * u * 4, thinness = 8 / 0.01;
  const auto judged = [&](double off) {
    Judge judge(needle, u);
    return judge.closest(0, ray, true_closest(needle, std::vector{ray}, 1)[0],
                         hit(static_cast<float>(2 + off), 0));
  };
  EXPECT_EQ(judged(0.5 * eps).verdict, Verdict::right);
  for (const double share : {0.1, 0.9, 2.0}) {
    const Judged j = judged(share * thinness * eps);
    EXPECT_EQ(j.verdict, Verdict::wrong_t);
    EXPECT_EQ(j.excused, share < 1) << share;
  }
}

TEST(RayJudge, IsStricterWithExactMethods) {
  Judge exact(mesh, geometry::tolerance::unit_roundoff<double>);
  const Rayf in{{std::nextafter(1.0f, 0.0f), 0.5f, 2}, {0, 0, -1}};
  const TrueHit truth = true_closest(mesh, std::vector{in}, 1)[0];
  EXPECT_EQ(exact.closest(0, in, truth, {}).verdict, Verdict::false_miss);
  EXPECT_EQ(closest(in, {}).verdict, Verdict::borderline);
}

TEST(RayJudge, LetsNoAnswerToABrokenRayCountAsAHit) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const Rayf broken{{nan, 0, 0}, {0, 0, 1}};
  EXPECT_EQ(closest(broken, {}).verdict, Verdict::right);
  EXPECT_EQ(closest(broken, hit(1, 0)).verdict, Verdict::false_hit);
  EXPECT_EQ(closest(inside, hit(nan, 0)).verdict, Verdict::false_hit);
}

}  // namespace
}  // namespace treeline::bench::ray
