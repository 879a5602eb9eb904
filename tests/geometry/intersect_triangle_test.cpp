// Both ray tests against exact arithmetic: equal where the arithmetic is exact, and elsewhere wrong only
// within a bound derived from the roundings made.
#include "geometry/intersect_triangle.hpp"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "tests/geometry/meshes.hpp"
#include "tests/geometry/witness.hpp"

namespace treeline::test {
namespace {

template <class T>
Vec<T, 3> small_integers(int reach) {
  Vec<T, 3> r;
  for (int i = 0; i < 3; ++i) r[i] = static_cast<T>(*rc::gen::inRange(-reach, reach + 1));
  return r;
}

template <class Test, class T>
std::optional<TriangleHit<T>> hit(const Ray<T>& ray, const Triangle<T>& triangle) {
  return typename Test::template Prepared<T>(ray)(triangle, ray.t_min, ray.t_max);
}

template <class T>
class RayTriangle : public testing::Test {};
using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(RayTriangle, Scalars);

// With integer corners and slopes of -1, 0 and 1 every step of the watertight test is exact, so edges,
// corners, edge-on and degenerate triangles must come out exactly as rational arithmetic says.
TYPED_TEST(RayTriangle, WatertightEqualsRationalOnIntegers) {
  using T = TypeParam;
  const bool ok = rc::check([] {
    Ray<T> ray{small_integers<T>(4), small_integers<T>(1), T(-100), T(100)};
    RC_PRE(length2(ray.direction) > 0);
    const Triangle<T> triangle{small_integers<T>(4), small_integers<T>(4), small_integers<T>(4)};
    const auto exact = witness_hit<Rational>(ray, triangle);
    const auto found = hit<Watertight>(ray, triangle);
    RC_ASSERT(found.has_value() == exact.has_value());
    if (!exact) return;
    // Weights are quotients of small integers, rounded once; t a mean of small integers.
    RC_ASSERT(abs(Rational(found->u) - exact->u) <= Rational(tolerance::gamma<T>(2)));
    RC_ASSERT(abs(Rational(found->v) - exact->v) <= Rational(tolerance::gamma<T>(2)));
    RC_ASSERT(abs(Rational(found->t) - exact->t) <= Rational(tolerance::gamma<T>(6) * T(8 * 3)));
  });
  EXPECT_TRUE(ok);
}

/// How far, across the ray and in 113 bits, the ray passes inside the closed triangle's outline (positive) or
/// outside it (negative), in coordinates sheared along the major axis; and the bound on the roundings of a
/// shear.
template <class T>
std::pair<Quad, Quad> depth_and_bound(const Ray<T>& ray, const Triangle<T>& triangle) {
  const int z = largest_axis(ray.direction), x = (z + 1) % 3, y = (z + 2) % 3;
  Quad p[3][2], reach = 0;
  const Vec<T, 3>* corners[3] = {&triangle.a, &triangle.b, &triangle.c};
  for (int i = 0; i < 3; ++i) {
    Quad d[3];
    for (int k = 0; k < 3; ++k) {
      d[k] = Quad((*corners[i])[k]) - Quad(ray.origin[k]);
      reach = std::max(reach, Quad(abs(d[k])));
    }
    p[i][0] = d[x] - d[z] * Quad(ray.direction[x]) / Quad(ray.direction[z]);
    p[i][1] = d[y] - d[z] * Quad(ray.direction[y]) / Quad(ray.direction[z]);
  }
  Quad inside = 1e300, outside = 1e300;
  int positive = 0, negative = 0;
  for (int i = 0; i < 3; ++i) {
    const Quad *a = p[i], *b = p[(i + 1) % 3];
    const Quad ex = b[0] - a[0], ey = b[1] - a[1], whole = ex * ex + ey * ey;
    const Quad side = a[0] * b[1] - a[1] * b[0];
    positive += side >= 0, negative += side <= 0;
    Quad s = whole > 0 ? Quad(-(a[0] * ex + a[1] * ey) / whole) : Quad(0);
    s = std::min(std::max(s, Quad(0)), Quad(1));
    const Quad qx = a[0] + s * ex, qy = a[1] + s * ey;
    outside = std::min(outside, Quad(sqrt(qx * qx + qy * qy)));
    if (whole > 0) inside = std::min(inside, Quad(abs(side) / sqrt(whole)));
  }
  const bool in = positive == 3 || negative == 3;
  // 2u |x| + 4u |z| per coordinate (see intersect_box.hpp), times sqrt(2) for two of them.
  const Quad bound = Quad(tolerance::gamma<T>(6)) * reach * Quad(1.5);
  return {in ? inside : -outside, bound};
}

TYPED_TEST(RayTriangle, WatertightIsWrongOnlyWithinTheShearsRounding) {
  using T = TypeParam;
  Pcg32 random(11);
  int close = 0, inside = 0, outside = 0;
  for (int n = 0; n < 20000; ++n) {
    const T far = std::pow(T(10), static_cast<T>(random.below(5))),
            size = std::pow(T(10), -T(random.below(7)));
    const Vec<T, 3> at = random_vec<T>(random) * far;
    Triangle<T> tri{at, at + random_vec<T>(random) * size, at + random_vec<T>(random)};  // down to needles
    Vec<T, 3> w = sample_triangle(random.uniform<T>(), random.uniform<T>());
    if (n % 3 == 0) w = {w[0], 0, T(1) - w[0]};  // at an edge
    const T push = far * std::pow(T(10), T(random.below(6))) * std::numeric_limits<T>::epsilon() * T(n % 4);
    const Vec<T, 3> target = tri.a * w[0] + tri.b * w[1] + tri.c * w[2] + random_vec<T>(random) * push;
    const Vec<T, 3> origin = random_vec<T>(random) * far;
    const Ray<T> ray{origin, target - origin, T(-1e30), T(1e30)};
    const auto [depth, bound] = depth_and_bound(ray, tri);
    const auto found = hit<Watertight>(ray, tri);
    ++(depth > bound ? inside : depth < -bound ? outside : close);
    if (depth > bound) {
      EXPECT_TRUE(found) << n << ": lost, inside by " << depth << " > " << bound;
    }
    if (depth < -bound) {
      EXPECT_FALSE(found) << n << ": invented, outside by " << -depth << " > " << bound;
    }
  }
  EXPECT_GT(close, 1000);
  EXPECT_GT(inside, 1000);
  EXPECT_GT(outside, 1000);
}

// A triangle far beside the ray, and narrower than rounding: its edge functions round to zero, yet no hit.
TYPED_TEST(RayTriangle, NoHitIsInventedForNeedlesThatPointAtTheRay) {
  using T = TypeParam;
  Pcg32 random(5);
  constexpr T u = std::numeric_limits<T>::epsilon();
  for (int n = 0; n < 20000; ++n) {
    const Vec<T, 3> axis = sample_sphere(random.uniform<T>(), random.uniform<T>());
    const Vec<T, 3> side = normalized(cross(axis, random_vec<T>(random)));
    const T reach = T(1) + random.uniform<T>();
    const Triangle<T> tri{side * reach + axis, side * (reach + T(0.5)) + axis + random_vec<T>(random) * u,
                          side * (reach + T(1)) + axis + random_vec<T>(random) * u};
    EXPECT_FALSE((hit<Watertight>(Ray<T>{{}, axis}, tri))) << n;
  }
}

template <class Test, class T>
void check_benign() {
  Pcg32 random(3);
  T worst = 0;
  for (int n = 0; n < 20000; ++n) {
    const Triangle<T> tri{random_vec<T>(random), random_vec<T>(random), random_vec<T>(random)};
    Ray<T> ray{random_vec<T>(random, -2, 2), {}, T(-1e30), T(1e30)};
    const Vec<T, 3> w = sample_triangle(random.uniform<T>(), random.uniform<T>());
    const Vec<T, 3> n0 = tri.area_normal();
    ray.direction = tri.a * w[0] + tri.b * w[1] + tri.c * w[2] - ray.origin;
    if (std::abs(dot(n0, ray.direction)) < T(0.1) * length(ray.direction)) continue;  // not near edge-on
    const auto exact = witness_hit<Quad>(ray, tri);
    if (!exact || std::min({w[0], w[1], w[2]}) < T(1e-3)) continue;
    const auto found = hit<Test>(ray, tri);
    ASSERT_TRUE(found) << n;
    const Quad errors[] = {abs(Quad(found->t) - exact->t), abs(Quad(found->u) - exact->u),
                           abs(Quad(found->v) - exact->v)};
    for (const Quad& e : errors) worst = std::max(worst, static_cast<T>(e));
  }
  // Coordinates to 2·sqrt(3), area normal along the ray at least 0.1: condition numbers to about 100.
  EXPECT_LT(worst, T(1000) * tolerance::unit_roundoff<T>);
}
TYPED_TEST(RayTriangle, BenignHitsAreAccurate) {
  check_benign<Watertight, TypeParam>();
  check_benign<MollerTrumbore, TypeParam>();
}

template <class Test, class T>
void check_common_law() {
  // Two-sided, closed in t, and the corners' weights in their order.
  const Triangle<T> tri{{0, 0, 2}, {4, 0, 2}, {0, 4, 2}}, back{tri.a, tri.c, tri.b};
  const Vec<T, 3> o{1, 2, 0}, d{0, 0, 1};
  const auto h = hit<Test>(Ray<T>{o, d}, tri), g = hit<Test>(Ray<T>{o, d}, back);
  ASSERT_TRUE(h && g);
  EXPECT_EQ(h->t, T(2));
  EXPECT_EQ(h->u, T(0.25));
  EXPECT_EQ(h->v, T(0.5));
  EXPECT_EQ(g->u, T(0.5));
  EXPECT_EQ(g->v, T(0.25));
  EXPECT_TRUE((hit<Test>(Ray<T>{o, d, T(2), T(2)}, tri)));
  EXPECT_FALSE((hit<Test>(Ray<T>{o, d, T(0), std::nextafter(T(2), T(0))}, tri)));
  EXPECT_FALSE((hit<Test>(Ray<T>{o, d, std::nextafter(T(2), T(3)), T(9)}, tri)));
  EXPECT_FALSE((hit<Test>(Ray<T>{o, -d}, tri)));
  EXPECT_TRUE((hit<Test>(Ray<T>{o, -d, T(-3), T(0)}, tri)));
  EXPECT_FALSE((hit<Test>(Ray<T>{{1, 2, 2}, {1, 0, 0}}, tri))) << "a ray in the plane";
  const T nan = std::numeric_limits<T>::quiet_NaN();
  EXPECT_FALSE((hit<Test>(Ray<T>{o, d}, Triangle<T>{{nan, 0, 2}, tri.b, tri.c})))
      << "a corner that is not a number";
}
TYPED_TEST(RayTriangle, CommonLaw) {
  check_common_law<Watertight, TypeParam>();
  check_common_law<MollerTrumbore, TypeParam>();
}

template <class Test, class T>
void check_degenerate_never_hit() {
  // Corners exactly on a line in any direction: a + s d for small integers a, d and s.
  const bool ok = rc::check([] {
    const Vec<T, 3> a = small_integers<T>(1000), d = small_integers<T>(1000);
    const auto on_line = [&] { return a + d * static_cast<T>(*rc::gen::inRange(-9, 10)); };
    const Triangle<T> tri{on_line(), on_line(), on_line()};
    Pcg32 random(*rc::gen::arbitrary<std::uint64_t>());
    const Vec<T, 3> o = random_vec<T>(random, -2000, 2000);
    const T s = random.uniform<T>();
    RC_ASSERT(!(hit<Test>(Ray<T>{o, tri.a + (tri.b - tri.a) * s - o}, tri)));
    RC_ASSERT(!(hit<Test>(Ray<T>{o, tri.b - o}, tri)));
  });
  EXPECT_TRUE(ok);
}
TYPED_TEST(RayTriangle, DegenerateTrianglesAreNeverHit) {
  check_degenerate_never_hit<Watertight, TypeParam>();
  check_degenerate_never_hit<MollerTrumbore, TypeParam>();
}

// Rays that graze needles: t stays where the exact ray crosses the triangle's box, give or take the padding.
template <class Test, class T>
void check_t_stays_in_the_box() {
  Pcg32 random(23);
  int found_any = 0;
  for (int n = 0; n < 50000; ++n) {
    const Vec<T, 3> along = sample_sphere(random.uniform<T>(), random.uniform<T>());
    const Vec<T, 3> at = along * random.uniform<T>(T(50), T(550));
    const T tilt = std::pow(T(10), -random.uniform<T>(T(1), T(5)));
    const Triangle<T> tri{at, at + along + random_vec<T>(random) * tilt,
                          at + along * T(2) + random_vec<T>(random) * tilt};
    const Vec<T, 3> w = sample_triangle(random.uniform<T>(), random.uniform<T>());
    const Ray<T> ray{{}, tri.a * w[0] + tri.b * w[1] + tri.c * w[2]};
    const auto found = hit<Test>(ray, tri);
    if (!found) continue;
    ++found_any;
    const Box<T, 3> box = tri.box();
    const Quad t(found->t);
    for (int k = 0; k < 3; ++k) {
      const Quad x = t * Quad(ray.direction[k]);
      const Quad slack = Quad(tolerance::slab_padding<T> * T(2)) * T(2 * 560);
      EXPECT_GE(x, Quad(box.low[k]) - slack) << n;
      EXPECT_LE(x, Quad(box.high[k]) + slack) << n;
    }
  }
  EXPECT_GT(found_any, 1000);
}
TYPED_TEST(RayTriangle, GrazingHitsStayInTheTrianglesBox) {
  check_t_stays_in_the_box<Watertight, TypeParam>();
  check_t_stays_in_the_box<MollerTrumbore, TypeParam>();
}

TYPED_TEST(RayTriangle, ExactDegeneracy) {
  using T = TypeParam;
  EXPECT_TRUE(is_degenerate(Triangle<T>{{1, 2, 3}, {1, 2, 3}, {4, 5, 6}}));
  EXPECT_TRUE(is_degenerate(Triangle<T>{{0, 0, 0}, {1, 1, 1}, {3, 3, 3}}));
  const T next = std::nextafter(T(3), T(4));
  EXPECT_FALSE(is_degenerate(Triangle<T>{{0, 0, 0}, {1, 1, 1}, {3, 3, next}}));
  EXPECT_FALSE(is_degenerate(
      Triangle<T>{{1000, 1000, 1000}, {1001, 1001, 1001}, {1003, 1003, std::nextafter(T(1003), T(0))}}));
  const bool ok = rc::check([] {
    // Corners near a line, off by units in the last place: rational arithmetic decides.
    const Vec<T, 3> a = small_integers<T>(3), d = small_integers<T>(3);
    const auto near_line = [&] {
      Vec<T, 3> p = a + d * static_cast<T>(*rc::gen::inRange(-3, 4));
      const int k = *rc::gen::inRange(0, 6);
      if (k < 3 && p[k] != 0) p[k] = std::nextafter(p[k], T(10));
      return p;
    };
    const Triangle<T> t{near_line(), near_line(), near_line()};
    bool flat = true;
    for (int x = 0; x < 3; ++x) {
      const int y = (x + 1) % 3;
      const auto r = [](T v) { return Rational(v); };
      flat &= (r(t.b[x]) - r(t.a[x])) * (r(t.c[y]) - r(t.a[y])) ==
              (r(t.b[y]) - r(t.a[y])) * (r(t.c[x]) - r(t.a[x]));
    }
    RC_ASSERT(is_degenerate(t) == flat);
  });
  EXPECT_TRUE(ok);
}

}  // namespace
}  // namespace treeline::test
