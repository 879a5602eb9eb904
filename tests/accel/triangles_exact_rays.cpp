// The wide tree that decides exactly, against rationals: rays at corners and edges from far away, whose
// direction's components are of any size, and meshes of any size.
#include <algorithm>

#include "accel/brute_force.hpp"
#include "accel/bsp_tree.hpp"
#include "accel/bvh.hpp"
#include "accel/kd_tree.hpp"
#include "tests/accel/triangles_wide.hpp"
#include "tests/geometry/witness.hpp"

namespace treeline::accel::test {
namespace {

using treeline::test::Rational;
using Exactly = Bvh<Triangles<float, geometry::Exact>, accel::Wide>;

/// To nearest, ties to even; of a magnitude up to about 1e38.
float rounded_to_float(const Rational& x) {
  auto r = static_cast<float>(static_cast<double>(x));
  for (const float to : {-INFINITY, INFINITY}) {
    const float other = std::nextafter(r, to);
    const Rational middle = (Rational(r) + Rational(other)) / 2;
    const bool past = to < 0 ? x < middle : x > middle;
    if (past || (x == middle && std::bit_cast<std::uint32_t>(other) % 2 == 0)) return other;
  }
  return r;
}

struct Tally {
  int hits = 0, misses = 0, borders = 0;
};

void expect_the_truth(const std::vector<Triangle<float>>& triangles, const std::vector<R>& rays,
                      Tally& tally) {
  const Exactly tree(triangles, {.non_finite = NonFinite::refuse});
  std::vector<Hit<float>> hits(rays.size());
  std::vector<std::uint8_t> any(rays.size());
  tree.closest_hit(rays, hits, 1, RayBatch::singly), tree.any_hit(rays, any, 1, RayBatch::singly);
  for (const RayBatch how : {RayBatch::streams, RayBatch::packets}) {
    std::vector<Hit<float>> same(rays.size());
    std::vector<std::uint8_t> same_any(rays.size());
    tree.closest_hit(rays, same, 1, how), tree.any_hit(rays, same_any, 1, how);
    ASSERT_TRUE(same == hits && same_any == any);
  }
  for (std::size_t i = 0; i < rays.size(); ++i) {
    Hit<float> expected;
    treeline::test::WitnessHit<Rational> nearest;
    for (std::size_t k = 0; k < triangles.size(); ++k) {
      const auto hit = treeline::test::witness_hit<Rational>(rays[i], triangles[k]);
      if (!hit || hit->t < Rational(rays[i].t_min)) continue;
      if (std::isfinite(rays[i].t_max) && hit->t > Rational(rays[i].t_max)) continue;
      const float t = rounded_to_float(hit->t);
      if (t < expected.t) expected = {t, static_cast<Id>(k)}, nearest = *hit;
      tally.borders += hit->u == 0 || hit->v == 0 || hit->u + hit->v == 1;
    }
    ASSERT_EQ(any[i] != 0, static_cast<bool>(expected)) << "ray " << i;
    ASSERT_EQ(hits[i].primitive, expected.primitive) << "ray " << i;
    ++(expected ? tally.hits : tally.misses);
    if (!expected) continue;
    ASSERT_EQ(hits[i].t, expected.t) << "ray " << i;
    const auto near = [](float x, const Rational& to) {
      return abs(Rational(x) - to) <= abs(to) * Rational(0x1p-23) + Rational(0x1p-149);
    };
    ASSERT_TRUE(near(hits[i].u, nearest.u) && near(hits[i].v, nearest.v)) << "ray " << i;
  }
}

/// Rounded one by one: a vector's roundings may be left out.
V single(const Vec<double, 3>& p) {
  return {geometry::rounded(static_cast<float>(p[0])), geometry::rounded(static_cast<float>(p[1])),
          geometry::rounded(static_cast<float>(p[2]))};
}

// Corners with all their digits, and origins from near to 1e5 sizes away: what float decides, its errors
// there included, is not wrong.
TEST(ExactRays, FromAfarAtCornersAndEdges) {
  Pcg32 random(201);
  Tally tally;
  for (int round = 0; round < 120; ++round) {
    const double centre = round % 3 == 0 ? 0 : std::ldexp(1.0, round % 17 - 4);
    const V middle = single(in_cube(random, centre));
    auto triangles =
        soup<float>(6, round % 2 ? 0.5f : 0.02f, 300 + static_cast<std::uint64_t>(round), middle);
    std::vector<R> rays;
    for (int i = 0; i < 80; ++i) {
      const double away = std::ldexp(1.0, static_cast<int>(random.below(18)) - 1);
      const Triangle<float>& t = triangles[random.below(6)];
      const Vec<double, 3> a(t.a), b(t.b), c(t.c);
      const double s = random.uniform(0.0, 1.0);
      const V target = i % 4 == 0 ? t.a
                                  : single(i % 4 == 1   ? a + (b - a) * s
                                           : i % 4 == 2 ? c + (a - c) * 0.5
                                                        : b);
      const V origin = single(Vec<double, 3>(target) + in_cube(random, away));
      V direction = single(Vec<double, 3>(target) - Vec<double, 3>(origin));
      if (i % 3 == 0) direction = direction * 0.3f;  // no product of few digits
      if (direction != V{}) rays.push_back({origin, direction});
    }
    expect_the_truth(triangles, rays, tally);
    if (HasFatalFailure()) FAIL() << "round " << round;
  }
  EXPECT_GT(tally.hits, 1000);
  EXPECT_GT(tally.misses, 1000);
}

// Where float's errors add up: diagonal rays from afar at the edges of small triangles in a mesh that was
// moved. A twentieth of the bound on them would lose hits here.
TEST(ExactRays, WhereTheErrorsOfFloatAddUp) {
  Pcg32 random(204);
  Tally tally;
  for (int round = 0; round < 60; ++round) {
    const V middle = single({random.uniform(900.0, 1100.0), random.uniform(-1100.0, -900.0), 1000});
    auto triangles = soup<float>(2, 0.3f, 500 + static_cast<std::uint64_t>(round), middle);
    std::vector<R> rays;
    for (int i = 0; i < 300; ++i) {
      const Triangle<float>& t = triangles[random.below(2)];
      const V target = i % 3 == 0 ? (t.a + t.b) * 0.5f : i % 3 == 1 ? (t.b + t.c) * 0.5f : (t.c + t.a) * 0.5f;
      const double away = std::ldexp(random.uniform(1.0, 2.0), 9 + static_cast<int>(random.below(4)));
      Vec<double, 3> by;
      for (int k = 0; k < 3; ++k) by[k] = away * random.uniform(0.9, 1.0) * (random.below(2) ? 1 : -1);
      const V origin = single(Vec<double, 3>(target) + by);
      rays.push_back({origin, single((Vec<double, 3>(target) - Vec<double, 3>(origin)) / 3.0)});
    }
    expect_the_truth(triangles, rays, tally);
    if (HasFatalFailure()) FAIL() << "round " << round;
  }
  EXPECT_GT(tally.hits, 2000);
  EXPECT_GT(tally.misses, 2000);
}

// What a whole-numbered scene looks like with each axis stretched by a power of two of its own: corners and
// edges are still met exactly, by directions whose components are up to 2^120 apart.
TEST(ExactRays, WhateverTheSizesAlongTheAxes) {
  Pcg32 random(202);
  Tally tally;
  for (int round = 0; round < 200; ++round) {
    int stretch[3];
    for (int& s : stretch) s = static_cast<int>(random.below(round % 2 ? 120u : 60u)) - (round % 2 ? 70 : 30);
    const auto stretched = [&](const Vec<double, 3>& p) {
      Vec<double, 3> r;
      for (int k = 0; k < 3; ++k) r[k] = std::ldexp(p[k], stretch[k]);
      return single(r);
    };
    const auto whole = [&](std::uint32_t half) {
      const auto one = [&] { return static_cast<double>(random.below(2 * half + 1)) - half; };
      const double x = one(), y = one();
      return Vec<double, 3>{x, y, one()};
    };
    std::vector<Triangle<float>> triangles;
    while (triangles.size() < 8) {
      const Vec<double, 3> a = whole(4), b = whole(4);
      const Triangle<float> t{stretched(a), stretched(b), stretched(whole(4))};
      if (!geometry::is_degenerate(t)) triangles.push_back(t);
    }
    std::vector<R> rays;
    for (int i = 0; i < 40; ++i) {
      const V origin = stretched(whole(6)), direction = stretched(whole(i % 2 ? 2 : 5));
      R ray{origin, direction};
      if (i % 5 == 0) ray.t_min = -2, ray.t_max = 1;
      if (direction != V{}) rays.push_back(ray);
    }
    expect_the_truth(triangles, rays, tally);
    if (HasFatalFailure()) FAIL() << "round " << round;
  }
  EXPECT_GT(tally.hits, 500);
  EXPECT_GT(tally.misses, 1000);
  EXPECT_GT(tally.borders, 300);
}

// On a grid whose corners and edges the ray runs along but for the least component of its direction, of a
// size from huge to denormal.
TEST(ExactRays, HoweverSmallTheComponentThatDecides) {
  Pcg32 random(203);
  Tally tally;
  const float sizes[] = {0, 1e-45f, 1e-38f, 1e-30f, 1e-20f, 1e-9f, 0x1p-24f, 0.5f};
  for (int round = 0; round < 200; ++round) {
    // Of the mesh, which is scaled where it is large or small, and of the direction.
    const float unit = std::ldexp(1.0f, round % 4 == 0 ? 40 : round % 4 == 1 ? -40 : 0);
    const float speed = std::ldexp(1.0f, static_cast<int>(random.below(3)) * 63 - 63);
    const auto point = [&](std::uint32_t n) {
      const auto one = [&] { return static_cast<float>(random.below(n)) * unit; };
      const float x = one(), y = one();
      return V{x, y, one()};
    };
    std::vector<Triangle<float>> triangles;
    while (triangles.size() < 8) {
      const V a = point(4), b = point(4);
      const Triangle<float> t{a, b, point(4)};
      if (!geometry::is_degenerate(t)) triangles.push_back(t);
    }
    std::vector<R> rays;
    for (int i = 0; i < 40; ++i) {
      R ray{point(5), {}};
      const auto first = static_cast<int>(random.below(3));
      for (int k = 0; k < 3; ++k) {
        const float size = k == first ? 1 : sizes[random.below(8)];
        ray.direction[k] = random.below(2) ? size * speed : -size * speed;
      }
      if (i % 2) ray.t_min = -std::numeric_limits<float>::max();
      rays.push_back(ray);
    }
    expect_the_truth(triangles, rays, tally);
    if (HasFatalFailure()) FAIL() << "round " << round;
  }
  EXPECT_GT(tally.hits, 500);
  EXPECT_GT(tally.misses, 1000);
  EXPECT_GT(tally.borders, 300);
}

Triangle<float> wall(float z) { return {{-9, -9, z}, {9, -9, z}, {0, 9, z}}; }

template <class Tree>
class RangeOfTimes : public testing::Test {};
using WideAndPlain =
    testing::Types<Exactly, Bvh<Triangles<float>, accel::Wide>, Bvh<Triangles<float>>,
                   KdTree<Triangles<float>>, BspTree<Triangles<float>>, BruteForce<Triangles<float>>>;
TYPED_TEST_SUITE(RangeOfTimes, WideAndPlain);

// Walls 50 and more away met at t = 5e41, by a slow ray or by one from afar.
TYPED_TEST(RangeOfTimes, ATimeBeyondFloatIsNoHit) {
  constexpr float infinity = std::numeric_limits<float>::infinity();
  const std::vector<Triangle<float>> walls{wall(60), wall(50)};
  const TypeParam tree{std::span(walls)};
  const std::vector<R> rays{{{0, 0, 0}, {0, 0, 1e-40f}},
                            {{0, 0, 90}, {0, 0, 1e-40f}, -infinity},
                            {{0, 0, 3e38f}, {0, 0, -1e-9f}},
                            {{0, 0, 3e38f}, {0, 0, 1e-9f}, -infinity}};
  for (const R& ray : rays) {
    EXPECT_FALSE(tree.closest_hit(ray));
    EXPECT_FALSE(tree.any_hit(ray));
    if constexpr (requires(std::vector<Hit<float>> all) { tree.all_hits(ray, all); }) {
      std::vector<Hit<float>> all;
      tree.all_hits(ray, all);
      EXPECT_TRUE(all.empty());
      for (const RayBatch how : {RayBatch::streams, RayBatch::packets}) {
        std::vector<R> same(16, ray);
        std::vector<Hit<float>> hits(16);
        std::vector<std::uint8_t> any(16);
        tree.closest_hit(same, hits, 1, how), tree.any_hit(same, any, 1, how);
        EXPECT_EQ(std::ranges::count(hits, Hit<float>{}), 16);
        EXPECT_EQ(std::ranges::count(any, 0), 16);
      }
    }
  }
  // But the largest float is a t, and so is half of it, where t is off by some units in the last place.
  constexpr bool exact = std::same_as<TypeParam, Exactly>;
  const float largest = std::numeric_limits<float>::max(), far = exact ? largest : largest / 2;
  const std::vector<Triangle<float>> floor{wall(0)};
  const Hit<float> hit =
      TypeParam{std::span(floor)}.closest_hit(R{{0, 0, far * 0x1p-100f}, {0, 0, -0x1p-100f}});
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit.t, far, exact ? 0 : 7 * 0x1p-24 * far);
}

// Two walls that are both told t = 0 (2e-9 / 3e38 underflows) but the nearer of which is known.
TYPED_TEST(RangeOfTimes, WhereTimesUnderflowTheNearerIsFirst) {
  const R ray{{0, 0, 0}, {0, 0, 3e38f}};
  for (const bool near_last : {true, false}) {
    const std::vector<Triangle<float>> walls{wall(near_last ? 2e-9f : 1e-9f),
                                             wall(near_last ? 1e-9f : 2e-9f)};
    const Id near = near_last ? 1 : 0;
    const TypeParam tree{std::span(walls)};
    EXPECT_EQ(tree.closest_hit(ray).t, 0);
    EXPECT_EQ(tree.closest_hit(ray).primitive, near);
    if constexpr (requires(std::vector<Hit<float>> all) { tree.all_hits(ray, all); }) {
      std::vector<Hit<float>> all;
      tree.all_hits(ray, all);
      ASSERT_EQ(all.size(), 2u);
      EXPECT_EQ(all[0], tree.closest_hit(ray));
      EXPECT_EQ(all[1].primitive, 1 - near);
    }
  }
  const std::vector<Triangle<float>> twice{wall(1e-9f), wall(1e-9f)};  // these do tie
  EXPECT_EQ(TypeParam{std::span(twice)}.closest_hit(ray).primitive, 0u);
}

}  // namespace
}  // namespace treeline::accel::test
