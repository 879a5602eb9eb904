// Crossings of triangles against clipping in rational arithmetic: one triangle cut down to what lies in the
// other.
#include "geometry/exact/triangle_triangle.hpp"

#include <gtest/gtest.h>

#include "geometry/predicates.hpp"
#include "tests/geometry/meshes.hpp"
#include "tests/geometry/witness.hpp"

namespace treeline::test {
namespace {

using Point = std::array<Rational, 3>;

Point operator-(const Point& a, const Point& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Point cross(const Point& a, const Point& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Rational dot(const Point& a, const Point& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Point point(const Vec3f& p) { return {Rational(p[0]), Rational(p[1]), Rational(p[2])}; }

/// The part of a convex polygon with n · (x - o) >= 0 (Sutherland and Hodgman 1974).
std::vector<Point> clipped(const std::vector<Point>& polygon, const Point& o, const Point& n) {
  std::vector<Point> r;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Point &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
    const Rational s = dot(n, p - o), t = dot(n, q - o);
    if (s >= 0) r.push_back(p);
    if ((s < 0 && t > 0) || (s > 0 && t < 0)) {
      const Rational share = s / (s - t);
      r.push_back({p[0] + share * (q[0] - p[0]), p[1] + share * (q[1] - p[1]), p[2] + share * (q[2] - p[2])});
    }
  }
  return r;
}

bool witness_crosses(const Triangle3f& first, const Triangle3f& second) {
  const std::array<Point, 3> s{point(first.a), point(first.b), point(first.c)};
  const std::vector<Point> t{point(second.a), point(second.b), point(second.c)};
  const Point normal = cross(s[1] - s[0], s[2] - s[0]), back{-normal[0], -normal[1], -normal[2]};
  std::vector<Point> common = clipped(clipped(t, s[0], normal), s[0], back);
  for (std::size_t i = 0; i < 3; ++i) common = clipped(common, s[i], cross(normal, s[(i + 1) % 3] - s[i]));
  std::vector<Point> shared;
  for (const Point& p : s)
    if (std::ranges::find(t, p) != t.end()) shared.push_back(p);
  if (shared.size() == 3) return false;
  return std::ranges::any_of(common, [&](const Point& p) {
    if (shared.size() == 2) return cross(p - shared[0], shared[1] - shared[0]) != Point{0, 0, 0};
    return shared.empty() || p != shared[0];
  });
}

/// Both orders, all turns of one, and both ways around must agree.
void check(const Triangle3f& s, const Triangle3f& t) {
  const bool expected = witness_crosses(s, t);
  for (const Triangle3f& turned : {s, Triangle3f{s.b, s.c, s.a}, Triangle3f{s.c, s.b, s.a}}) {
    ASSERT_EQ(cross_each_other(turned, t), expected);
    ASSERT_EQ(cross_each_other(t, turned), expected);
    ASSERT_EQ(cross_each_other(Triangle3d(turned), Triangle3d(t)), expected);
  }
}

Vec3f grid_point(Pcg32& random, std::uint32_t n) {
  return {float(random.below(n)), float(random.below(n)), float(random.below(n))};
}

TEST(TriangleTriangle, AgreesWithRationalClippingOnACoarseGrid) {
  // On so few points most pairs touch, share corners or lie in one plane.
  Pcg32 random(1);
  std::size_t crossing[4] = {}, apart[4] = {};
  for (int i = 0; i < 6000; ++i) {
    const std::uint32_t n = 2 + random.below(3);
    Triangle3f s{grid_point(random, n), grid_point(random, n), grid_point(random, n)};
    Triangle3f t{grid_point(random, n), grid_point(random, n), grid_point(random, n)};
    if (i % 3 == 1) t.a = s.b;
    if (i % 3 == 2) t.a = s.b, t.b = s.c;
    if (i % 4 == 0) t.a[2] = t.b[2] = t.c[2] = s.a[2] = s.b[2] = s.c[2];  // in one plane
    if (is_degenerate(s) || is_degenerate(t)) continue;
    check(s, t);
    const SharedCorners shared(s, t);
    ++(witness_crosses(s, t) ? crossing : apart)[shared.count];
  }
  for (int shared = 0; shared < 3; ++shared) {
    EXPECT_GT(crossing[shared], 100u) << shared;
    EXPECT_GT(apart[shared], 100u) << shared;
  }
}

TEST(TriangleTriangle, AgreesWithRationalClippingByOneUlp) {
  // A corner of one in the plane of the other, give or take the last digit.
  Pcg32 random(2);
  std::size_t crossing = 0, apart = 0;
  for (int i = 0; i < 1500; ++i) {
    const Triangle3f s{random_vec<float>(random), random_vec<float>(random), random_vec<float>(random)};
    const float u = random.uniform<float>(), v = random.uniform<float>() * (1 - u);
    Vec3f p = s.a * (1 - u - v) + s.b * u + s.c * v;
    p[int(random.below(3))] = std::nextafter(p[0], 2.f * float(random.below(2)));
    const Vec3f up = random_vec<float>(random);
    const Triangle3f t{p, p + up, p + up + random_vec<float>(random) * 0.5f};
    check(s, t);
    ++(witness_crosses(s, t) ? crossing : apart);
  }
  EXPECT_GT(crossing, 100u);
  EXPECT_GT(apart, 100u);
}

TEST(TriangleTriangle, KeepsItsAnswerUnderScalesOfTwo) {
  Pcg32 random(3);
  for (int i = 0; i < 300; ++i) {
    const Triangle3f s{grid_point(random, 4), grid_point(random, 4), grid_point(random, 4)},
        t{grid_point(random, 4), grid_point(random, 4), grid_point(random, 4)};
    if (is_degenerate(s) || is_degenerate(t)) continue;
    for (const float scale : {0x1p-140f, 0x1p-70f, 0x1p100f})
      EXPECT_EQ(cross_each_other(Triangle3f{s.a * scale, s.b * scale, s.c * scale},
                                 Triangle3f{t.a * scale, t.b * scale, t.c * scale}),
                cross_each_other(s, t));
  }
}

}  // namespace
}  // namespace treeline::test
