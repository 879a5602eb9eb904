// No ray from inside a closed mesh escapes, by brute force over all faces. Compiled with contraction to fused
// multiply-add forbidden, and again with it forced, because the promise must hold under any user's flags.
#include <gtest/gtest.h>

#include "geometry/intersect_triangle.hpp"
#include "tests/geometry/meshes.hpp"

namespace treeline::test {
namespace {

bool machine_can_run_this() {
#ifdef __FMA__
  return __builtin_cpu_supports("fma");
#else
  return true;
#endif
}

template <class Test, class T>
bool hits(const std::vector<Triangle<T>>& faces, const Ray<T>& ray) {
  const typename Test::template Prepared<T> test(ray);
  for (const auto& f : faces)
    if (test(f, ray.t_min, ray.t_max)) return true;
  return false;
}

/// Directions at each vertex, along each edge in uneven places, and anywhere.
template <class T>
std::vector<Vec<T, 3>> targets(const Mesh<T>& mesh) {
  std::vector<Vec<T, 3>> r = mesh.vertices;
  Pcg32 random(7);
  for (const auto& f : mesh.faces)
    for (int i = 0; i < 3; ++i) {
      const Vec<T, 3>&a = mesh.vertices[f[i]], &b = mesh.vertices[f[(i + 1) % 3]];
      r.push_back(a + (b - a) * random.uniform<T>());
    }
  for (std::size_t i = 0; i < mesh.size(); ++i) r.push_back(mesh.vertices[0] + random_vec<T>(random, -2, 2));
  return r;
}

template <class T>
std::size_t escapes(const Mesh<T>& mesh, const std::vector<Vec<T, 3>>& origins) {
  const auto faces = triangles_of(mesh);
  std::size_t count = 0;
  for (const auto& origin : origins)
    for (const auto& target : targets(mesh)) {
      const Vec<T, 3> direction = target - origin;
      if (direction != Vec<T, 3>{} && !hits<Watertight>(faces, Ray<T>{origin, direction})) ++count;
    }
  return count;
}

template <class T>
class WatertightTest : public testing::Test {
  void SetUp() override {
    if (!machine_can_run_this()) GTEST_SKIP() << "this machine has no fused multiply-add";
  }
};
using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(WatertightTest, Scalars);

TYPED_TEST(WatertightTest, Sphere) {
  using T = TypeParam;
  EXPECT_EQ(escapes(sphere<T>(4), {{0, 0, 0}, {T(0.3), T(-0.2), T(0.6)}}), 0u);
}
TYPED_TEST(WatertightTest, SphereFarAway) {
  using T = TypeParam;
  for (T distance : {T(1e2), T(1e3), T(1e4)}) {
    const Vec<T, 3> c{distance, -distance, distance / 3};
    EXPECT_EQ(escapes(moved(sphere<T>(3), c), {c}), 0u) << distance;
  }
}
TYPED_TEST(WatertightTest, VerySmallAndVeryLarge) {
  using T = TypeParam;
  // Products of coordinates underflow and overflow at these scales, coordinates themselves do not.
  const T tiny = std::is_same_v<T, float> ? T(1e-25) : T(1e-200);
  const T huge = std::is_same_v<T, float> ? T(1e25) : T(1e200);
  for (T scale : {tiny, huge}) EXPECT_EQ(escapes(moved(sphere<T>(3), {}, scale), {{}}), 0u) << scale;
}
TYPED_TEST(WatertightTest, CoplanarGrid) {
  using T = TypeParam;
  EXPECT_EQ(escapes(cube<T>(2), {{0, 0, 0}, {T(0.5), T(0.25), T(-0.125)}, {T(0.1), T(0.2), T(0.3)}}), 0u);
}
TYPED_TEST(WatertightTest, Needles) {
  using T = TypeParam;
  EXPECT_EQ(escapes(spiky<T>(4, 3), {{0, 0, 0}}), 0u);
  EXPECT_EQ(escapes(sheet<T>(4, T(1e-5)), {{0, 0, 0}, {T(0.3), T(0.3), T(1e-6)}}), 0u);
}
TYPED_TEST(WatertightTest, Torus) {
  using T = TypeParam;
  EXPECT_EQ(escapes(torus<T>(60, 24), {{1, 0, 0}, {0, T(-1), T(0.1)}}), 0u);
}
TYPED_TEST(WatertightTest, DirectionsOfAnyLength) {
  using T = TypeParam;
  const auto faces = triangles_of(sphere<T>(3));
  const T denormal = std::numeric_limits<T>::denorm_min();
  std::size_t count = 0;
  for (T scale : {std::numeric_limits<T>::min() * 64, std::numeric_limits<T>::max() / 8})
    for (const auto& target : targets(sphere<T>(3)))
      count += !hits<Watertight>(faces, Ray<T>{{}, target * scale});
  EXPECT_EQ(count, 0u);
  for (T small : {T(0), -T(0), denormal, -denormal, std::numeric_limits<T>::min()})
    for (int k = 0; k < 3; ++k) {
      Vec<T, 3> d = Vec<T, 3>::filled(small);
      d[k] = -1;
      EXPECT_TRUE(hits<Watertight>(faces, Ray<T>{{}, d})) << small << " " << k;
      d[k] = 64 * denormal;
      EXPECT_TRUE(hits<Watertight>(faces, Ray<T>{{}, d})) << small << " " << k;
    }
}

}  // namespace
}  // namespace treeline::test
