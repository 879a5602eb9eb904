// Meshes, rays and queries of any size against a computation of our own in long double, whose range no
// product here leaves.
#include "tests/accel/triangles_common.hpp"

namespace treeline::accel::test {
namespace {

using Wide = long double;
using V = Vec<Wide, 3>;

template <class T>
std::vector<T> scales() {
  std::vector<T> all{T(1e-25), T(1e-12), T(1), T(1e10), T(1e15), T(1e25)};
  if (sizeof(T) > 4) all.insert(all.end(), {T(1e-200), T(1e-100), T(1e100), T(1e200)});
  return all;
}

Wide distance_to_segment(const V& p, const V& a, const V& b) {
  const V along = b - a;
  const Wide whole = length2(along);
  return distance(p, a + along * (whole > 0 ? std::clamp(dot(p - a, along) / whole, Wide(0), Wide(1)) : 0));
}
Wide wide_distance(const V& p, const V& a, const V& b, const V& c) {
  const V n = cross(b - a, c - a);
  if (dot(cross(b - a, p - a), n) > 0 && dot(cross(c - b, p - b), n) > 0 && dot(cross(a - c, p - c), n) > 0)
    return std::abs(dot(p - a, n)) / length(n);
  return std::min({distance_to_segment(p, a, b), distance_to_segment(p, b, c), distance_to_segment(p, c, a)});
}
template <class T>
Wide wide_distance(const Vec<T, 3>& p, const Triangle<T>& t) {
  return wide_distance(V(p), V(t.a), V(t.b), V(t.c));
}

struct WideHit {
  Wide t = std::numeric_limits<Wide>::infinity();
  std::size_t id = 0;
  bool sure = true;  // no triangle is grazed, met near an edge, or met near the ends of the range
};

template <class T>
WideHit wide_hit(const std::vector<Triangle<T>>& triangles, const Ray<T>& ray) {
  WideHit best;
  const V o(ray.origin), d(ray.direction);
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const V a = V(triangles[i].a) - o, ab = V(triangles[i].b) - V(triangles[i].a),
            ac = V(triangles[i].c) - V(triangles[i].a), n = cross(ab, ac);
    const Wide across = dot(n, d), t = dot(n, a) / across;
    const V p = d * t - a;
    const Wide u = dot(cross(p, ac), n) / length2(n), v = dot(cross(ab, p), n) / length2(n);
    const Wide inner = std::min({u, v, 1 - u - v});
    if (!(inner > -0.01L)) continue;
    const auto near = [&](Wide end) { return std::abs(t - end) < 1e-3L * std::abs(end); };
    if (inner < 0.01L || std::abs(across) < 0.03L * length(n) * length(d) || near(ray.t_min) ||
        near(ray.t_max)) {
      best.sure = false;
      continue;
    }
    if (t < ray.t_min || t > ray.t_max || t > best.t) continue;
    best.t = t, best.id = i;
  }
  return best;
}

template <class Tree>
class TriangleScales : public testing::Test {};
TYPED_TEST_SUITE(TriangleScales, AllTrees);

TYPED_TEST(TriangleScales, ClosestPoints) {
  using T = typename TypeParam::Scalar;
  for (const T scale : scales<T>()) {
    SCOPED_TRACE(scale);
    const auto triangles = soup<T>(60, T(0.4), 211, {}, scale);
    const TypeParam tree(triangles);
    const Brute<TypeParam> brute(triangles);
    Pcg32 random(212);
    std::vector<Vec<T, 3>> queries;
    for (int i = 0; i < 60; ++i) queries.push_back(in_cube(random, i % 3 ? T(1.2) : T(50)) * scale);
    expect_same_closest<TypeParam>(tree, brute, queries);
    for (const auto& q : queries) {
      Wide expected = std::numeric_limits<Wide>::infinity();
      for (const auto& t : triangles) expected = std::min(expected, wide_distance(q, t));
      const auto found = tree.closest_point(q);
      ASSERT_TRUE(found);
      const Wide rounding = 400 * std::numeric_limits<T>::epsilon() * static_cast<Wide>(scale);
      EXPECT_NEAR(distance(V(q), V(found.point)), expected, rounding);
      EXPECT_NEAR(wide_distance(q, triangles[found.primitive]), expected, rounding);
      const Wide expected2 = expected * expected;
      if (expected2 > std::numeric_limits<T>::max()) {
        EXPECT_EQ(found.distance2, std::numeric_limits<T>::infinity());
      } else if (expected2 > std::numeric_limits<T>::min()) {
        EXPECT_NEAR(std::sqrt(static_cast<Wide>(found.distance2)), expected, rounding);
      }
      EXPECT_TRUE(tree.closest_point(q, T(expected * 1.01L)));
      if (expected > rounding * 100) {
        EXPECT_FALSE(tree.closest_point(q, T(expected * 0.99L)));
      }
    }
  }
}

TYPED_TEST(TriangleScales, Rays) {
  using T = typename TypeParam::Scalar;
  for (const T scale : scales<T>())
    for (const T speed : {T(1), scale, T(1) / scale}) {
      SCOPED_TRACE(testing::Message() << "scale " << scale << ", speed " << speed);
      const auto triangles = soup<T>(60, T(0.4), 221, {}, scale);
      const TypeParam tree(triangles);
      Pcg32 random(222);
      std::vector<Ray<T>> rays;
      for (int i = 0; i < 80; ++i) {
        const Vec<T, 3> from = in_cube(random, T(2)), to = in_cube(random, T(1));
        Ray<T> ray{from * scale, (to - from) * speed};
        const Wide unit = static_cast<Wide>(scale) / static_cast<Wide>(speed);  // t that crosses the soup
        if (i % 4 == 1) ray.t_min = T(unit * 0.8L);
        if (i % 4 == 2) ray.t_max = T(unit * 0.8L);
        if (i % 4 == 3) ray.t_min = -std::numeric_limits<T>::infinity();
        rays.push_back(ray);
      }
      expect_same_hits<TypeParam>(tree, Brute<TypeParam>(triangles), rays);
      int sure = 0, hits = 0;
      const Wide unit = static_cast<Wide>(scale) / static_cast<Wide>(speed);
      if (unit > 1e-3L * std::numeric_limits<T>::max() || unit < 1e6L * std::numeric_limits<T>::min())
        continue;  // no T could tell such a t
      for (const auto& ray : rays) {
        const WideHit expected = wide_hit(triangles, ray);
        if (!expected.sure) continue;
        ++sure;
        const auto found = tree.closest_hit(ray);
        ASSERT_EQ(static_cast<bool>(found), std::isfinite(expected.t));
        if (!found) continue;
        ++hits;
        EXPECT_EQ(found.primitive, expected.id);
        EXPECT_NEAR(static_cast<Wide>(found.t), expected.t,
                    unit * 400 * static_cast<Wide>(std::numeric_limits<T>::epsilon()));
        EXPECT_TRUE(ray.t_min <= found.t && found.t <= ray.t_max);
      }
      EXPECT_GT(sure, 30);
      EXPECT_GT(hits, 15);
    }
}

TYPED_TEST(TriangleScales, ContainmentBoundsAndSlices) {
  using T = typename TypeParam::Scalar;
  for (const T scale : scales<T>()) {
    SCOPED_TRACE(scale);
    const Mesh<T> mesh = sphere<T>(2, {}, scale);
    const TypeParam tree(mesh);
    EXPECT_EQ(tree.bounds().low, (Vec<T, 3>::filled(-scale)));
    EXPECT_EQ(tree.bounds().high, (Vec<T, 3>::filled(scale)));
    Pcg32 random(231);
    for (int i = 0; i < 100; ++i) {
      const Vec<T, 3> p = in_cube(random, T(1.2));
      if (length(p) < T(0.9)) {
        EXPECT_TRUE(tree.contains(p * scale));
      }
      if (length(p) > T(1.01)) {
        EXPECT_FALSE(tree.contains(p * scale));
      }
    }
    const auto cells = tree.slice(2, static_cast<double>(scale) * 0.1);
    ASSERT_FALSE(cells.empty());
    double widest = 0;
    for (const auto& cell : cells)
      for (const auto& p : cell.outline) widest = std::max({widest, std::abs(p[0]), std::abs(p[1])});
    EXPECT_NEAR(widest / static_cast<double>(scale), 1, 1e-5);
  }
}

TYPED_TEST(TriangleScales, QueriesFarBeyondATinyMeshAndTinyTrianglesInALargeOne) {
  using T = typename TypeParam::Scalar;
  const TypeParam tiny(soup<T>(20, T(0.4), 241, {}, T(1e-25)));
  const auto far = tiny.closest_point({T(3), T(0), T(4)});
  ASSERT_TRUE(far);
  EXPECT_NEAR(far.distance2, T(25), T(1e-4));
  EXPECT_TRUE(tiny.closest_point({T(3), T(0), T(4)}, T(5.01)));
  EXPECT_FALSE(tiny.closest_point({T(3), T(0), T(4)}, T(4.99)));

  // A wide triangle right below the query and a small one farther away, among triangles of size 1.
  for (const T s : {T(1e-10), T(1e-12), T(1e9), T(1e10)}) {
    std::vector<Triangle<T>> triangles(5, {{1, 2, 3}, {2, 2, 3}, {1, 3, 4}});
    if (s > T(1))
      for (auto& t : triangles) t = {t.a * s, t.b * s, t.c * s};
    triangles.push_back({{-s, -s, 0}, {3 * s, -s, 0}, {-s, 3 * s, 0}});
    triangles.push_back({{s / 2, 0, s}, {s * T(0.6), 0, s}, {s / 2, s / 10, s}});
    const auto found = TypeParam(triangles).closest_point({T(0), T(0), s / 10});
    EXPECT_EQ(found.primitive, 5u) << s;
    EXPECT_EQ(found.feature, Feature::face) << s;
  }
}

}  // namespace
}  // namespace treeline::accel::test
