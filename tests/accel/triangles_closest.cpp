// Closest points and containment: against brute force bit by bit, a computation of our own in long double,
// and shapes known in closed form.
#include "tests/accel/triangles_common.hpp"

namespace treeline::accel::test {
namespace {

template <class Tree>
class TriangleClosest : public testing::Test {};
TYPED_TEST_SUITE(TriangleClosest, AllTrees);

template <class T>
std::vector<Vec<T, 3>> queries(std::size_t n, std::uint64_t seed, Vec<T, 3> centre = {}, T scale = T(1)) {
  Pcg32 random(seed, 2);
  std::vector<Vec<T, 3>> points;
  for (std::size_t i = 0; i < n; ++i)
    points.push_back(in_cube(random, i % 3 ? T(1.2) : T(5)) * scale + centre);
  return points;
}

/// Distance to a triangle in long double by Voronoi regions (Ericson 2005, section 5.1.5).
template <class T>
long double region_distance(const Vec<T, 3>& point, const Triangle<T>& triangle) {
  using V = Vec<long double, 3>;
  const V p(point), a(triangle.a), b(triangle.b), c(triangle.c), ab = b - a, ac = c - a;
  const long double d1 = dot(ab, p - a), d2 = dot(ac, p - a), d3 = dot(ab, p - b), d4 = dot(ac, p - b);
  const long double d5 = dot(ab, p - c), d6 = dot(ac, p - c);
  if (d1 <= 0 && d2 <= 0) return distance(p, a);
  if (d3 >= 0 && d4 <= d3) return distance(p, b);
  if (d6 >= 0 && d5 <= d6) return distance(p, c);
  const long double vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return distance(p, a + ab * (d1 / (d1 - d3)));
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return distance(p, a + ac * (d2 / (d2 - d6)));
  if (va <= 0 && d4 >= d3 && d5 >= d6)
    return distance(p, b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6))));
  return std::abs(dot(p - a, normalized(cross(ab, ac))));
}

TYPED_TEST(TriangleClosest, EqualsBruteForce) {
  using T = typename TypeParam::Scalar;
  struct Place {
    T centre, scale, size;
  };
  for (const Place& p : {Place{T(0), T(1), T(0.1)}, Place{T(0), T(1), T(1)}, Place{T(1e5), T(1), T(0.1)},
                         Place{T(0), T(1e-10), T(0.1)}, Place{T(0), T(1e10), T(0.1)}}) {
    const Vec<T, 3> centre{p.centre, p.centre * T(0.7), -p.centre};
    const auto triangles = soup<T>(500, p.size, 61, centre, p.scale);
    expect_same_closest<TypeParam>(TypeParam(triangles), Brute<TypeParam>(triangles),
                                   queries<T>(300, 62, centre, p.scale));
  }
}

TYPED_TEST(TriangleClosest, EqualsAnIndependentComputation) {
  using T = typename TypeParam::Scalar;
  const auto triangles = soup<T>(300, T(0.2), 71);
  const TypeParam tree(triangles);
  for (const auto& q : queries<T>(200, 72)) {
    long double expected = std::numeric_limits<long double>::infinity();
    for (const auto& t : triangles) expected = std::min(expected, region_distance(q, t));
    const auto found = tree.closest_point(q);
    const long double rounding = 40 * std::numeric_limits<T>::epsilon();  // of coordinates up to 5
    EXPECT_NEAR(std::sqrt(static_cast<long double>(found.distance2)), expected, rounding);
    EXPECT_NEAR(distance(Vec<long double, 3>(q), Vec<long double, 3>(found.point)), expected, rounding);
    EXPECT_NEAR(region_distance(q, triangles[found.primitive]), expected, rounding);
  }
}

TYPED_TEST(TriangleClosest, SegmentsAndPointsAreNear) {
  using T = typename TypeParam::Scalar;
  const std::vector<Triangle<T>> triangles{{{0, 0, 0}, {4, 0, 0}, {2, 0, 0}},
                                           {{0, 5, 0}, {0, 5, 0}, {0, 5, 0}}};
  const TypeParam tree(triangles);
  const auto on_segment = tree.closest_point({T(3), T(2), T(0)});
  EXPECT_EQ(on_segment.primitive, 0u);
  EXPECT_EQ(on_segment.distance2, T(4));
  EXPECT_EQ(on_segment.point, (Vec<T, 3>{3, 0, 0}));
  EXPECT_EQ(tree.closest_point({T(0), T(6), T(0)}).primitive, 1u);
}

TYPED_TEST(TriangleClosest, MaxDistanceIsInclusiveAndLimits) {
  using T = typename TypeParam::Scalar;
  const std::vector<Triangle<T>> triangles{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
                                           {{0, 0, 9}, {1, 0, 9}, {0, 1, 9}}};
  const TypeParam tree(triangles);
  const Vec<T, 3> q{T(0.25), T(0.25), T(2)};
  EXPECT_EQ(tree.closest_point(q, T(2)).primitive, 0u);
  EXPECT_EQ(tree.closest_point(q, T(2)).feature, Feature::face);
  EXPECT_FALSE(tree.closest_point(q, T(1.999)));
  EXPECT_EQ(tree.closest_point({T(0.25), T(0.25), T(0)}, T(0)).distance2, T(0));
}

TYPED_TEST(TriangleClosest, ContainsWhatASphereContains) {
  using T = typename TypeParam::Scalar;
  const Vec<T, 3> centre{T(3), T(-2), T(1)};
  const Mesh<T> mesh = sphere<T>(3, centre, T(2));
  long double inscribed = 2;
  for (const auto& t : triangles_of(mesh)) inscribed = std::min(inscribed, region_distance(centre, t));
  const TypeParam tree(mesh);
  Pcg32 random(81);
  int inside = 0, outside = 0;
  for (int i = 0; i < 500; ++i) {
    const Vec<T, 3> p = centre + in_cube(random, T(2));
    const T r = distance(p, centre);
    const bool within = r<T(inscribed) * T(0.9999), beyond = r> T(2.0001);
    if (!within && !beyond) continue;
    ASSERT_EQ(tree.contains(p), within) << "point " << i << " at " << r;
    (within ? inside : outside)++;
  }
  EXPECT_GT(inside, 100);
  EXPECT_GT(outside, 100);
  EXPECT_TRUE(tree.contains(centre));
  for (std::size_t i = 0; i < mesh.vertices.size(); i += 5) {
    EXPECT_TRUE(tree.contains(mesh.vertices[i])) << "corner " << i;  // the surface is inside
    // On the line through the centre and a corner rays meet edges and corners often.
    EXPECT_TRUE(tree.contains(centre + (mesh.vertices[i] - centre) * T(0.9))) << "below corner " << i;
    EXPECT_FALSE(tree.contains(centre + (mesh.vertices[i] - centre) * T(1.1))) << "above corner " << i;
  }
}

TYPED_TEST(TriangleClosest, ContainsWhatAHollowBoxContains) {
  using T = typename TypeParam::Scalar;
  Mesh<T> mesh;
  add_box<T>(mesh, {{-2, -2, -2}, {2, 2, 2}});
  const std::size_t outer = mesh.size();
  add_box<T>(mesh, {{-1, -1, -1}, {1, 1, 1}});
  for (std::size_t i = outer; i < mesh.size(); ++i) std::swap(mesh.faces[i][1], mesh.faces[i][2]);
  const TypeParam tree(mesh);
  for (int x = -5; x <= 5; ++x)
    for (int y = -5; y <= 5; ++y)
      for (int z = -5; z <= 5; ++z) {
        const int r =
            std::max({std::abs(x), std::abs(y), std::abs(z)});  // halves; 2 and 4 are on the surfaces
        EXPECT_EQ(tree.contains({T(x) / 2, T(y) / 2, T(z) / 2}), 2 <= r && r <= 4)
            << x << ' ' << y << ' ' << z;
      }
}

TYPED_TEST(TriangleClosest, ContainsIsNotBlurredByWhatLiesFarAway) {
  using T = typename TypeParam::Scalar;
  Mesh<T> mesh = sphere<T>(3);
  const T far = std::is_same_v<T, float> ? T(1e6) : T(1e14);
  add_box<T>(mesh, {{far, far, far}, {far * 2, far * 2, far * 2}});
  const TypeParam tree(mesh);
  for (std::size_t i = 0; i < mesh.vertices.size() - 8; i += 5) {
    EXPECT_TRUE(tree.contains(mesh.vertices[i])) << "corner " << i;
    EXPECT_FALSE(tree.contains(mesh.vertices[i] * T(1.001))) << "above corner " << i;
  }
}

}  // namespace
}  // namespace treeline::accel::test
