// Rays through triangle trees: against brute force bit by bit, and against a computation of our own in long
// double.
#include "tests/accel/triangles_common.hpp"

namespace treeline::accel::test {
namespace {

template <class Tree>
class TriangleRays : public testing::Test {};
TYPED_TEST_SUITE(TriangleRays, AllTrees);

template <class T>
std::vector<Ray<T>> random_rays(std::size_t n, std::uint64_t seed, Vec<T, 3> centre = {}, T scale = T(1)) {
  Pcg32 random(seed, 1);
  std::vector<Ray<T>> rays;
  for (std::size_t i = 0; i < n; ++i) {
    Ray<T> ray{in_cube(random, T(2)) * scale + centre, in_cube(random, T(1))};
    if (i % 4 == 1) ray.direction[static_cast<int>(i / 4 % 3)] = i % 8 == 1 ? T(0) : -T(0);
    if (i % 16 == 2) ray.direction = {T(0), T(0), T(i % 32 == 2 ? 1 : -1)};
    if (i % 16 == 3) ray.direction[0] = std::numeric_limits<T>::denorm_min() * T(3);
    if (i % 5 == 0) ray.t_min = scale * T(0.5), ray.t_max = scale * T(1.5);
    if (i % 7 == 0) ray.t_min = -scale * T(2);
    if (i % 11 == 0) ray.direction = ray.direction * T(1e-3);
    rays.push_back(ray);
  }
  return rays;
}

TYPED_TEST(TriangleRays, EqualBruteForceOnSoups) {
  using T = typename TypeParam::Scalar;
  for (const T size : {T(0.02), T(0.2), T(1.5)}) {
    const auto triangles = soup<T>(700, size, 11);
    expect_same_hits<TypeParam>(TypeParam(triangles), Brute<TypeParam>(triangles), random_rays<T>(600, 12));
  }
}

TYPED_TEST(TriangleRays, EqualBruteForceFarFromTheOriginAndAtAnyScale) {
  using T = typename TypeParam::Scalar;
  struct Place {
    T centre, scale;
  };
  for (const Place& p : {Place{T(1e5), T(1)}, Place{T(-3e3), T(1e-2)}, Place{T(0), T(1e-12)},
                         Place{T(0), T(1e12)}, Place{T(1e7), T(1e5)}}) {
    const Vec<T, 3> centre{p.centre, -p.centre, p.centre * T(0.5)};
    const auto triangles = soup<T>(400, T(0.2), 21, centre, p.scale);
    const TypeParam tree(triangles);
    const Brute<TypeParam> brute(triangles);
    expect_same_hits<TypeParam>(tree, brute, random_rays<T>(300, 22, centre, p.scale));
    expect_same_hits<TypeParam>(tree, brute, random_rays<T>(100, 23, centre, p.scale * T(1e4)));
  }
}

TYPED_TEST(TriangleRays, EqualBruteForceOnNeedlesSeenEdgeOn) {
  using T = typename TypeParam::Scalar;
  Pcg32 random(31);
  std::vector<Triangle<T>> triangles;
  std::vector<Ray<T>> rays;
  for (int i = 0; i < 500; ++i) {
    const Vec<T, 3> a = in_cube(random, T(1)), along = in_cube(random, T(1));
    triangles.push_back({a, a + along, a + along * random.uniform<T>() + in_cube(random, T(1e-5))});
    const Vec<T, 3> target = a + along * random.uniform<T>();
    const Vec<T, 3> from = i % 2 ? a + along * T(3) + in_cube(random, T(1e-4)) : in_cube(random, T(3));
    rays.push_back({from, target - from});
  }
  expect_same_hits<TypeParam>(TypeParam(triangles), Brute<TypeParam>(triangles), rays);
}

/// Where the line of a ray meets the plane of a triangle, in long double by scalar triple products.
struct Meeting {
  long double t, weight[3];
  long double least() const { return std::min({weight[0], weight[1], weight[2]}); }
};
template <class T>
Meeting meeting(const Ray<T>& ray, const Triangle<T>& triangle) {
  using V = Vec<long double, 3>;
  const V o(ray.origin), d(ray.direction);
  const V a = V(triangle.a) - o, b = V(triangle.b) - o, c = V(triangle.c) - o;
  const long double wa = dot(d, cross(b, c)), wb = dot(d, cross(c, a)), wc = dot(d, cross(a, b));
  const long double sum = wa + wb + wc;
  return {dot(a, cross(b, c)) / sum, {wa / sum, wb / sum, wc / sum}};
}

TYPED_TEST(TriangleRays, EqualAnIndependentComputation) {
  using T = typename TypeParam::Scalar;
  const auto triangles = soup<T>(500, T(0.3), 41);
  const TypeParam tree(triangles);
  Pcg32 random(42);
  int hits = 0, misses = 0;
  constexpr long double doubt = 1000 * std::numeric_limits<T>::epsilon();  // of weights, for these shapes
  for (int i = 0; i < 400; ++i) {
    const Ray<T> ray{in_cube(random, T(2)), in_cube(random, T(1))};
    long double nearest = std::numeric_limits<long double>::infinity();
    bool doubtful = false;
    Id primitive = no_id;
    for (std::size_t k = 0; k < triangles.size(); ++k) {
      const Meeting m = meeting(ray, triangles[k]);
      if (std::abs(m.least()) < doubt || std::abs(m.t) < doubt) doubtful = true;
      if (m.least() >= 0 && m.t >= 0 && m.t < nearest) nearest = m.t, primitive = static_cast<Id>(k);
    }
    if (doubtful) continue;
    const auto hit = tree.closest_hit(ray);
    ASSERT_EQ(hit.primitive, primitive) << "ray " << i;
    (hit ? hits : misses)++;
    if (!hit) continue;
    const Meeting m = meeting(ray, triangles[primitive]);
    const auto normal = normalized(triangles[primitive].area_normal());
    const long double cosine = std::abs(dot(normal, normalized(ray.direction)));
    EXPECT_NEAR(hit.t, m.t, doubt / cosine) << "ray " << i;
    EXPECT_NEAR(hit.u, m.weight[1], doubt / cosine / 0.01) << "ray " << i;
    EXPECT_NEAR(hit.v, m.weight[2], doubt / cosine / 0.01) << "ray " << i;
  }
  EXPECT_GT(hits, 50);
  EXPECT_GT(misses, 50);
}

TYPED_TEST(TriangleRays, AxisRaysInFacePlanesEqualBruteForce) {
  using T = typename TypeParam::Scalar;
  Mesh<T> mesh;
  std::vector<Box<T, 3>> boxes;
  for (int x = 0; x < 4; ++x)
    for (int y = 0; y < 4; ++y)
      for (int z = 0; z < 4; ++z) {
        const T top = T(z) + (x % 2 ? T(1) : T(0.5));
        boxes.push_back({{T(x), T(y), T(z)}, {T(x + 1), T(y + 1), top}});
        add_box<T>(mesh, boxes.back());
      }
  std::vector<Ray<T>> rays;
  for (int axis = 0; axis < 3; ++axis)
    for (int i = 0; i <= 8; ++i)
      for (int j = 0; j <= 8; ++j)
        for (const T sign : {T(1), T(-1)}) {
          Ray<T> ray;
          ray.origin[axis] = sign > 0 ? T(-1) : T(5);
          ray.origin[(axis + 1) % 3] = T(i) / T(2), ray.origin[(axis + 2) % 3] = T(j) / T(2);
          ray.direction = {T(0), -T(0), T(0)};
          ray.direction[axis] = sign;
          rays.push_back(ray);
          ray.origin[axis] = T(2);  // starts on a face
          rays.push_back(ray);
          ray.origin[axis] = T(1.25);
          rays.push_back(ray);
        }
  const TypeParam tree(mesh);
  expect_same_hits<TypeParam>(tree, Brute<TypeParam>(mesh), rays);
  // From outside, a ray meets the face at its near end of every closed box that its line touches.
  constexpr bool watertight = std::is_same_v<Brute<TypeParam>, BruteForce<Triangles<T, Watertight>>>;
  for (std::size_t i = 0; watertight && i < rays.size(); i += 3) {
    bool touches = false;
    for (Box<T, 3> box : boxes) {
      const int axis = largest_axis(rays[i].direction);
      box.low[axis] = T(-1), box.high[axis] = T(5);
      touches = touches || box.contains(rays[i].origin);
    }
    ASSERT_EQ(tree.any_hit(rays[i]), touches) << "ray " << i;
  }
}

TYPED_TEST(TriangleRays, EndsOfTheIntervalCount) {
  using T = typename TypeParam::Scalar;
  const std::vector<Triangle<T>> wall{{{-1, -1, 2}, {1, -1, 2}, {0, 1, 2}}};
  const TypeParam tree(wall);
  const Vec<T, 3> ahead{0, 0, 1};
  EXPECT_TRUE(tree.any_hit({{}, ahead, 2, 2}));
  EXPECT_TRUE(tree.any_hit({{}, ahead, 0, 2}));
  EXPECT_TRUE(tree.any_hit({{}, ahead, 2, 9}));
  EXPECT_TRUE(tree.any_hit({{0, 0, 2}, ahead}));
  EXPECT_FALSE(tree.any_hit({{}, ahead, 0, T(1.999)}));
  EXPECT_FALSE(tree.any_hit({{}, ahead, T(2.001), 9}));
  EXPECT_FALSE(tree.any_hit({{}, ahead, 3, 1}));  // an empty interval
  EXPECT_FALSE(tree.any_hit({{}, -ahead}));
  EXPECT_EQ(tree.closest_hit({{}, ahead * T(4)}).t, T(0.5));
}

TYPED_TEST(TriangleRays, TiesGoToTheLowerIdAndDegenerateTrianglesAreNeverHit) {
  using T = typename TypeParam::Scalar;
  const Triangle<T> wall{{-1, -1, 1}, {1, -1, 1}, {0, 1, 1}};
  std::vector<Triangle<T>> triangles(40, wall);
  for (int i = 0; i < 10; ++i) {
    triangles.insert(triangles.begin(), Triangle<T>{{0, 0, T(0.5)}, {0, 0, T(0.5)}, {0, 0, T(0.5)}});
    triangles.insert(triangles.begin(), Triangle<T>{{-1, 0, T(0.5)}, {0, 0, T(0.5)}, {1, 0, T(0.5)}});
  }
  const TypeParam tree(triangles);
  const auto hit = tree.closest_hit({{}, {0, 0, 1}});
  EXPECT_EQ(hit.primitive, 20u);
  EXPECT_EQ(hit.t, T(1));
}

template <class Tree>
class WatertightRays : public testing::Test {};
TYPED_TEST_SUITE(WatertightRays, WatertightTrees);

TYPED_TEST(WatertightRays, NoneEscapesAClosedSphereAtVerticesAndEdges) {
  using T = typename TypeParam::Scalar;
  struct Place {
    Vec<T, 3> centre;
    T radius;
  };
  for (const Place& place : {Place{{}, T(1)}, Place{{T(1e3), T(2e3), T(-5e2)}, T(1)}, Place{{}, T(1e-3)}}) {
    const Mesh<T> mesh = sphere<T>(4, place.centre, place.radius);
    const TypeParam tree(mesh);
    Pcg32 random(51);
    std::vector<Ray<T>> rays;
    for (int i = 0; i < 34000; ++i) {
      const auto& face = mesh.faces[random.below(static_cast<std::uint32_t>(mesh.size()))];
      const Vec<T, 3> p = mesh.vertices[face[0]], q = mesh.vertices[face[1]];
      const Vec<T, 3> target = i % 2 ? p : p + (q - p) * random.uniform<T>();
      const Vec<T, 3> origin =
          i % 8 < 2 ? place.centre : place.centre + in_cube(random, place.radius * T(0.5));
      rays.push_back({origin, target - origin});
    }
    std::vector<Hit<T>> hits(rays.size());
    tree.closest_hit(rays, hits, 1);
    for (std::size_t i = 0; i < rays.size(); ++i) ASSERT_TRUE(hits[i]) << "ray " << i << " escapes";
  }
}

}  // namespace
}  // namespace treeline::accel::test
