// Distances against closed forms, dense sampling, and the conditions that mark a nearest point.
#include "geometry/distance.hpp"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "geometry/exact/triangle_distance.hpp"
#include "geometry/sobol.hpp"
#include "geometry/tolerances.hpp"
#include "tests/geometry/meshes.hpp"

namespace treeline::test {
namespace {

TEST(BoxDistance, ClosedForms) {
  const Box3d box{{0, 0, 0}, {1, 2, 3}};
  EXPECT_EQ(distance2(Vec3d{0.5, 1, 2}, box), 0);
  EXPECT_EQ(distance2(Vec3d{1, 2, 3}, box), 0);
  EXPECT_EQ(distance2(Vec3d{4, 1, 1}, box), 9);
  EXPECT_EQ(distance2(Vec3d{-3, -4, 1}, box), 25);
  EXPECT_EQ(distance2(Vec3d{2, 4, 5}, box), 9);
  EXPECT_EQ(distance2(Vec2f{5, 6}, Box2f{{1, 1}, {2, 2}}), 25);
}

// What compilers may make of two sums of squares by fusing products and sums, relative; see distance.hpp.
constexpr float fused = 1 + tolerance::gamma<float>(6);

TEST(BoxDistance, NeverAboveThatToAPointInside) {
  Pcg32 random(1);
  for (int n = 0; n < 200000; ++n) {
    Box3f box;
    box.grow(random_vec<float>(random)), box.grow(random_vec<float>(random));
    Vec3f q;
    for (int k = 0; k < 3; ++k)
      q[k] = std::min(std::max(random.uniform<float>(box.low[k], box.high[k]), box.low[k]), box.high[k]);
    const Vec3f p = random_vec<float>(random, -3, 3);
    ASSERT_LE(distance2(p, box), distance2(p, q) * fused);
  }
}

struct Case {
  Vec3d p;
  int feature;
  double distance2;
  Vec3d point;
};

TEST(TriangleDistance, EveryFeature) {
  const Triangle3d t{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};
  const Case cases[] = {
      {{1, 1, 2}, 0, 4, {1, 1, 0}},  {{1, 1, 0}, 0, 0, {1, 1, 0}},  {{2, -3, 0}, 1, 9, {2, 0, 0}},
      {{3, 3, 1}, 2, 3, {2, 2, 0}},  {{-2, 1, 2}, 3, 8, {0, 1, 0}}, {{-1, -2, 2}, 4, 9, {0, 0, 0}},
      {{6, -1, 2}, 5, 9, {4, 0, 0}}, {{-2, 6, 1}, 6, 9, {0, 4, 0}}, {{4, 0, 0}, 5, 0, {4, 0, 0}}};
  for (const Case& c : cases) {
    const auto r = closest_point_on_triangle(c.p, t);
    EXPECT_EQ(r.feature, c.feature);
    EXPECT_EQ(r.distance2, c.distance2);
    EXPECT_EQ(r.point, c.point);
  }
}

TEST(TriangleDistance, SegmentsAndPoints) {
  const Vec3d a{0, 0, 0}, b{2, 0, 0}, c{4, 0, 0};
  for (const Triangle3d& t :
       {Triangle3d{a, b, c}, Triangle3d{b, c, a}, Triangle3d{c, a, b}, Triangle3d{a, c, c}}) {
    EXPECT_EQ(closest_point_on_triangle({3, 3, 4}, t).distance2, 25);
    EXPECT_EQ(closest_point_on_triangle({-3, 4, 0}, t).distance2, 25);
    EXPECT_EQ(closest_point_on_triangle({6, 0, 0}, t).distance2, 4);
  }
  const auto r = closest_point_on_triangle({3, 4, 0}, Triangle3d{a, a, a});
  EXPECT_EQ(r.distance2, 25);
  EXPECT_GE(r.feature, 4);
}

// The nearest point q of a convex set is the one with (p - q)·(x - q) ≤ 0 for every x in the set; for a
// triangle its corners decide. That needs no other way to find q.
TEST(TriangleDistance, MeetsTheConditionOfANearestPoint) {
  const bool ok = rc::check([] {
    Pcg32 random(*rc::gen::arbitrary<std::uint64_t>());
    const double thin = std::pow(10.0, -*rc::gen::inRange(0, 12));
    const Vec3d a = random_vec<double>(random), d = random_vec<double>(random);
    const Triangle3d t{a, a + d + random_vec<double>(random) * thin, a + d * random.uniform(-2.0, 2.0)};
    const Vec3d p = random_vec<double>(random, -3, 3);
    const auto r = closest_point_on_triangle(p, t);
    RC_ASSERT(std::abs(r.distance2 - distance2(p, r.point)) <= 1e-14 * r.distance2);
    for (const Vec3d& x : {t.a, t.b, t.c}) RC_ASSERT(dot(p - r.point, x - r.point) <= 1e-13 * 100);
  });
  EXPECT_TRUE(ok);
}

TEST(TriangleDistance, DenseSamplingIsNeverNearer) {
  Pcg32 random(4);
  constexpr int samples = 4096;
  for (int n = 0; n < 200; ++n) {
    const Triangle3d t{random_vec<double>(random), random_vec<double>(random), random_vec<double>(random)};
    const Vec3d p = random_vec<double>(random, -2, 2);
    const double found = std::sqrt(closest_point_on_triangle(p, t).distance2);
    double best = INFINITY;
    for (int i = 0; i < samples; ++i) {
      const Vec3d w = sample_triangle(sobol_owen(i, 0, 1), sobol_owen(i, 1, 1));
      best = std::min(best, distance(p, t.a * w[0] + t.b * w[1] + t.c * w[2]));
    }
    EXPECT_LE(found, best * (1 + 1e-14));
    // The samples cover the triangle: none of its points is farther than its longest edge / 16 from one.
    const double edge = std::max({distance(t.a, t.b), distance(t.b, t.c), distance(t.c, t.a)});
    EXPECT_GE(found, best - edge / 16);
  }
}

TEST(TriangleDistance, BoundedBelowByTheBoxInFloatToo) {
  Pcg32 random(6);
  for (int n = 0; n < 100000; ++n) {
    const Vec3f far = random_vec<float>(random, -1000, 1000) * float(n % 3);
    const Triangle3f t{far + random_vec<float>(random), far + random_vec<float>(random),
                       far + random_vec<float>(random)};
    const Vec3f p = far + random_vec<float>(random, -3, 3);
    const auto r = closest_point_on_triangle(p, t);
    ASSERT_TRUE(t.box().contains(r.point));
    ASSERT_LE(distance2(p, t.box()), r.distance2 * fused);
  }
}

// Float's own cross product tells nothing of a sliver's face, and double's little of where along it a point
// is nearest; against distances in exact arithmetic.
TEST(TriangleDistance, KeepsSlivers) {
  Pcg32 random(8);
  const float bound = 64 * tolerance::unit_roundoff<float>;  // of coordinates up to 2
  const double fine = 64 * tolerance::unit_roundoff<double>;
  for (int n = 0; n < 100000; ++n) {
    const float thin = std::pow(10.0f, -random.uniform<float>(0, 6));
    const Vec3f a = random_vec<float>(random), d = random_vec<float>(random);
    // A needle or a cap, thin at any of its corners.
    const float share = n % 2 == 0 ? 1.0f : random.uniform<float>(0, 1);
    const Vec3f corners[] = {a, a + d, a + d * share + random_vec<float>(random) * thin};
    const Triangle3f t{corners[n % 3], corners[(n + 1) % 3], corners[(n + 2) % 3]};
    const Vec3d w = sample_triangle(random.uniform(), random.uniform());
    const float offset = std::pow(10.0f, -random.uniform<float>(0, 8));
    const Vec3f p =
        Vec3f(Vec3d(t.a) * w[0] + Vec3d(t.b) * w[1] + Vec3d(t.c) * w[2]) + random_vec<float>(random) * offset;
    const auto r = closest_point_on_triangle(p, t);
    const double truth = std::sqrt(exact_distance2(Vec3d(p), Triangle3d(t)));
    ASSERT_NEAR(length(Vec3d(p) - Vec3d(r.point)), truth, bound) << "thinness " << thin << ", try " << n;
    ASSERT_LE(std::sqrt(exact_distance2(Vec3d(r.point), Triangle3d(t))), bound);
    ASSERT_TRUE(t.box().contains(r.point));
    const auto wide = closest_point_on_triangle(Vec3d(p), Triangle3d(t));
    ASSERT_NEAR(length(Vec3d(p) - wide.point), truth, fine) << "thinness " << thin << ", try " << n;
    ASSERT_LE(std::sqrt(exact_distance2(wide.point, Triangle3d(t))), fine);
  }
}

}  // namespace
}  // namespace treeline::test
