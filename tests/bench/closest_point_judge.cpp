// The judge of the task closest_point on answers made by hand: each kind of wrong answer is told from the
// others, and from answers that are right within the rounding of the arithmetic.
#include <gtest/gtest.h>

#include "bench/closest_point/judge.hpp"

namespace treeline::bench::closest_point {
namespace {

using geometry::Mesh3f;
using geometry::Vec3d;
using geometry::Vec3f;

constexpr double u = geometry::tolerance::unit_roundoff<float>;

/// Faces 0, 1: the unit square in z = 0. Face 2: a triangle in z = 4. Face 3 is not finite.
const Mesh3f mesh{{{0, 0, 0},
                   {1, 0, 0},
                   {1, 1, 0},
                   {0, 1, 0},
                   {0, 0, 4},
                   {1, 0, 4},
                   {1, 1, 4},
                   {std::numeric_limits<float>::quiet_NaN(), 0, 0}},
                  {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}, {4, 5, 7}}};
const double diagonal = std::sqrt(18.0);
const Promise exact{Claim::exact, u, true}, bounded{Claim::bounded, u, true},
    in_double{Claim::bounded, geometry::tolerance::unit_roundoff<double>, true},
    approximate{Claim::approximate, u, true}, of_its_own{Claim::approximate, u, false};

Answer answer(const Vec3d& point, accel::Id primitive, const Vec3f& query) {
  return {geometry::length2(Vec3d(query) - point), primitive, accel::Feature::face, point};
}
Judged judged(const Vec3f& query, const Answer& a, const Promise& promise) {
  return Judge(mesh)(query, true_closest(mesh, std::vector{query}, 1)[0], a, promise);
}

const Vec3f above{0.75f, 0.25f, 1};
const Vec3f over_diagonal{0.5f, 0.5f, 1};

TEST(ClosestPointJudge, MeasuresByTheFiniteTriangles) {
  EXPECT_DOUBLE_EQ(Judge(mesh).diagonal(), diagonal);
  EXPECT_DOUBLE_EQ(Judge(mesh).floor(), u);
  EXPECT_DOUBLE_EQ(Judge(Mesh3f{}).diagonal(), 1);
  EXPECT_DOUBLE_EQ(Judge(Mesh3f{{{3, -5, 0}}, {{0, 0, 0}}}).diagonal(), 5) << "a point has no extent";
}

TEST(ClosestPointJudge, TakesWhatIsRightAndBothSidesOfATie) {
  for (const Promise& promise : {exact, bounded, in_double, approximate}) {
    const Judged j = judged(above, answer({0.75, 0.25, 0}, 0, above), promise);
    EXPECT_EQ(j.verdict, Verdict::right);
    EXPECT_EQ(j.error, 0);
    for (const accel::Id face : {0u, 1u}) {
      const Judged tied = judged(over_diagonal, answer({0.5, 0.5, 0}, face, over_diagonal), promise);
      EXPECT_EQ(tied.verdict, Verdict::right);
      EXPECT_FALSE(tied.farther);
    }
  }
}

TEST(ClosestPointJudge, HoldsABoundToItsArithmetic) {
  // The largest coordinate is 1: 64 roundings are allowed.
  const Answer a_bit_off = answer({0.75, 0.25, 60 * u}, 0, above),
               off = answer({0.75, 0.25, 70 * u}, 0, above);
  EXPECT_EQ(judged(above, a_bit_off, bounded).verdict, Verdict::right);
  EXPECT_EQ(judged(above, a_bit_off, exact).verdict, Verdict::off_triangle);
  EXPECT_EQ(judged(above, a_bit_off, in_double).verdict, Verdict::off_triangle);
  EXPECT_EQ(judged(above, off, bounded).verdict, Verdict::off_triangle);
  EXPECT_NEAR(judged(above, off, bounded).error, 70 * u / diagonal, 1e-12);
  EXPECT_NEAR(judged(above, off, bounded).signed_error, -70 * u / diagonal, 1e-12) << "nearer than the mesh";
}

TEST(ClosestPointJudge, TellsAFartherTriangleAndAFartherPoint) {
  const Judged other = judged(above, answer({0.75, 0.25, 4}, 2, above), bounded);
  EXPECT_EQ(other.verdict, Verdict::wrong_distance);
  EXPECT_TRUE(other.farther && other.much_farther);
  EXPECT_NEAR(other.error, 2 / diagonal, 1e-12);
  EXPECT_EQ(judged(above, answer({0.75, 0.25, 4}, 2, above), exact).verdict, Verdict::wrong_distance);
  // A point of the right triangle, but not the nearest.
  const Judged beside = judged(above, answer({0.875, 0.25, 0}, 0, above), bounded);
  EXPECT_EQ(beside.verdict, Verdict::wrong_distance);
  EXPECT_FALSE(beside.farther);
  EXPECT_NEAR(beside.relative, std::sqrt(1 + 1 / 64.0) - 1, 1e-12);
  EXPECT_GT(beside.signed_error, 0);
}

TEST(ClosestPointJudge, ExactMethodsMustNameANearestTriangle) {
  // Two parallel squares, the query nearer to one by less than float can tell.
  const Mesh3f two{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 2}, {1, 0, 2}, {0, 1, 2}},
                   {{0, 1, 2}, {3, 4, 5}}};
  const Vec3f query{0.25f, 0.25f, std::nextafter(1.0f, 2.0f)};  // nearer to the upper one
  const TrueClosest truth = true_closest(two, std::vector{query}, 1)[0];
  EXPECT_EQ(truth.primitive, 1u);
  const Answer lower = answer({0.25, 0.25, 0}, 0, query);
  EXPECT_EQ(Judge(two)(query, truth, lower, exact).verdict, Verdict::farther_triangle);
  const Judged j = Judge(two)(query, truth, lower, bounded);
  EXPECT_EQ(j.verdict, Verdict::right);
  EXPECT_TRUE(j.farther);
  EXPECT_FALSE(j.much_farther);
}

TEST(ClosestPointJudge, ExactMethodsTellTheDistanceToTheLastDigit) {
  Answer a = answer({0.75, 0.25, 0}, 0, above);
  EXPECT_EQ(judged(above, a, exact).verdict, Verdict::right);
  a.distance2 = 1 + 0x1p-52;
  EXPECT_EQ(judged(above, a, exact).verdict, Verdict::wrong_distance) << "the next double";
  a.distance2 = 1 - 0x1p-53;
  EXPECT_EQ(judged(above, a, exact).verdict, Verdict::wrong_distance) << "the one before";
  EXPECT_EQ(judged(above, a, bounded).verdict, Verdict::right) << "of others the point is judged";
}

TEST(ClosestPointJudge, HoldsTheDistanceThatIsTold) {
  for (const Promise& promise : {bounded, in_double, approximate}) {
    Answer a = answer({0.75, 0.25, 0}, 0, above);
    for (const double wrong : {1.5, 0.25, 0.0, double(INFINITY), double(NAN)}) {
      a.distance2 = wrong;
      EXPECT_EQ(judged(above, a, promise).verdict, Verdict::wrong_distance) << wrong;
    }
  }
  // Far away squares leave the range of float, and near by: then float alone may say infinity, or nothing.
  const Promise in_float{Claim::bounded, u, true, true};
  for (const auto& [scale, square] : {std::pair{1e25f, double(INFINITY)}, std::pair{1e-25f, 0.0}}) {
    const Mesh3f one{{{0, 0, 0}, {scale, 0, 0}, {0, scale, 0}}, {{0, 1, 2}}};
    const Vec3f query{scale / 4, scale / 4, scale};
    const TrueClosest truth = true_closest(one, std::vector{query}, 1)[0];
    const Answer a{square, 0, accel::Feature::face, {double(query[0]), double(query[1]), 0}};
    EXPECT_EQ(Judge(one)(query, truth, a, in_float).verdict, Verdict::right) << scale;
    EXPECT_EQ(Judge(one)(query, truth, a, bounded).verdict, Verdict::wrong_distance) << scale;
  }
}

// A triangle of large coordinates that is named instead of the nearest allows no more.
TEST(ClosestPointJudge, AFarTriangleIsNoExcuse) {
  const Mesh3f two{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 3}, {1e9f, 0, 3}, {0, 1e9f, 3}},
                   {{0, 1, 2}, {3, 4, 5}}};
  const Vec3f query{0.25f, 0.25f, 1};
  const TrueClosest truth = true_closest(two, std::vector{query}, 1)[0];
  EXPECT_EQ(Judge(two)(query, truth, answer({0.25, 0.25, 3}, 1, query), bounded).verdict,
            Verdict::wrong_distance);
}

/// What a method makes of queries that knows the right points and names any large triangle for them.
Answer naming(accel::Id primitive, const TrueClosest& truth, const Vec3d& point) {
  return {truth.distance2, primitive, accel::Feature::face, point};
}

// Of a triangle with large coordinates every point near by is as good as on it; the triangle itself may still
// be farther away than the nearest.
TEST(ClosestPointJudge, HoldsTheDistanceOfTheTriangleThatIsNamed) {
  const float large = 1e8f;  // 64 roundings of it: 381
  for (const auto& [gap, in_floats, in_doubles] :
       {std::tuple{0x1p-30f, Verdict::right, Verdict::farther_triangle},
        std::tuple{1e-3f, Verdict::farther_triangle, Verdict::off_triangle},
        std::tuple{0.5f, Verdict::farther_triangle, Verdict::off_triangle}}) {
    const Mesh3f two{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, -gap}, {large, 0, -gap}, {0, large, -gap}},
                     {{0, 1, 2}, {3, 4, 5}}};
    const Vec3f query{0.25f, 0.25f, 1};
    const TrueClosest truth = true_closest(two, std::vector{query}, 1)[0];
    ASSERT_EQ(truth.primitive, 0u);
    const Vec3d nearest{0.25, 0.25, 0};
    for (const Promise& promise : {bounded, in_double})
      EXPECT_EQ(Judge(two)(query, truth, naming(0, truth, nearest), promise).verdict, Verdict::right);
    const Judged broken = Judge(two)(query, truth, naming(1, truth, nearest), bounded);
    EXPECT_EQ(broken.verdict, in_floats) << gap;
    EXPECT_TRUE(broken.farther);
    EXPECT_EQ(Judge(two)(query, truth, naming(1, truth, nearest), in_double).verdict, in_doubles) << gap;
  }
}

// Where floats are no nearer to each other, a float may be so many steps off, and a double may not.
TEST(ClosestPointJudge, KnowsTheSpacingOfTheSmallestFloats) {
  const float s = 1e-42f, step = std::numeric_limits<float>::denorm_min();
  const Mesh3f one{{{0, 0, 0}, {s, 0, 0}, {0, s, 0}}, {{0, 1, 2}}};
  const Vec3f query{s / 4, s / 4, s};
  const TrueClosest truth = true_closest(one, std::vector{query}, 1)[0];
  const Promise in_float{Claim::bounded, u, true, true};
  for (const auto& [steps, of_float] :
       {std::pair{10, Verdict::right}, std::pair{100, Verdict::off_triangle}}) {
    const Answer a = answer({double(query[0]), double(query[1]), steps * double(step)}, 0, query);
    EXPECT_EQ(Judge(one)(query, truth, a, in_float).verdict, of_float) << steps;
    EXPECT_EQ(Judge(one)(query, truth, a, bounded).verdict, Verdict::off_triangle) << steps;
  }
}

TEST(ClosestPointJudge, TellsAnswersThatAreNone) {
  EXPECT_EQ(judged(above, {}, approximate).verdict, Verdict::missing);
  EXPECT_EQ(judged(above, {}, approximate).error, 1);
  EXPECT_EQ(judged(above, answer({0.75, 0.25, 0}, 9, above), approximate).verdict, Verdict::no_triangle);
  EXPECT_EQ(judged(above, answer({0.75, 0.25, 0}, 3, above), approximate).verdict, Verdict::no_triangle);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(judged(above, answer({nan, 0, 0}, 0, above), approximate).verdict, Verdict::missing);
}

TEST(ClosestPointJudge, WantsNoAnswerWhereThereIsNone) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  for (const Vec3f& q : {Vec3f{nan, 0, 0}, Vec3f{inf, 0, 0}}) {
    EXPECT_EQ(judged(q, {}, bounded).verdict, Verdict::right);
    EXPECT_EQ(judged(q, {1, 0, accel::Feature::face, {0, 0, 0}}, bounded).verdict, Verdict::surplus);
  }
  const Vec3f far_off{inf, 0, 0};
  EXPECT_EQ(judged(far_off, answer({0, 0, 0}, 0, far_off), bounded).verdict, Verdict::right)
      << "an infinite distance is what it is";
  const Judge empty{Mesh3f{}};
  EXPECT_EQ(empty(above, {}, {}, bounded).verdict, Verdict::right);
  EXPECT_EQ(empty(above, {}, answer({0, 0, 0}, 0, above), bounded).verdict, Verdict::surplus);
}

TEST(ClosestPointJudge, ApproximateIsNoLicence) {
  const Answer close = answer({0.75, 0.25, 0.01}, 0, above), far_off = answer({0.75, 0.25, 0.1}, 0, above);
  EXPECT_EQ(judged(above, close, approximate).verdict, Verdict::right);
  EXPECT_EQ(judged(above, far_off, approximate).verdict, Verdict::off_triangle);
  EXPECT_EQ(judged(above, far_off, of_its_own).verdict, Verdict::right);
  EXPECT_NEAR(judged(above, far_off, of_its_own).error, 0.1 / diagonal, 1e-12);
}

}  // namespace
}  // namespace treeline::bench::closest_point
