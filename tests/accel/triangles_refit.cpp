// A refitted wide tree answers as one built over the moved triangles, bit by bit.
#include "accel/bvh/build_spatial.hpp"
#include "accel/bvh/wide_compact.hpp"
#include "accel/bvh/wide_triangles.hpp"
#include "tests/accel/triangles_wide.hpp"

namespace treeline::accel::test {
namespace {

template <class Tree>
class WideRefit : public testing::Test {};
using Trees = testing::Types<Bvh<Triangles<float, Watertight>, accel::Wide>,
                             Bvh<Triangles<float, Watertight>, WideOf<4, 4>>,
                             Bvh<Triangles<float, geometry::Exact>, WideOf<16, 8>>>;
TYPED_TEST_SUITE(WideRefit, Trees);

template <class Tree>
concept HasRefit = requires(Tree& tree, const Mesh<float>& mesh) {
  tree.refit(mesh);
};
static_assert(!HasRefit<Bvh<Triangles<float, Watertight>, WideCompact<8>>>);

template <class Tree>
void expect_alike(const Tree& tree, const Tree& built, const std::vector<R>& rays) {
  ASSERT_EQ(tree.size(), built.size());
  ASSERT_EQ(tree.stats().dropped, built.stats().dropped);
  ASSERT_EQ(tree.bounds(), built.bounds());
  std::vector<Hit<float>> hits(rays.size()), expected(rays.size());
  std::vector<std::uint8_t> any(rays.size()), any_expected(rays.size());
  tree.closest_hit(rays, hits, 1), tree.any_hit(rays, any, 1);
  built.closest_hit(rays, expected, 1), built.any_hit(rays, any_expected, 1);
  ASSERT_TRUE(hits == expected);
  ASSERT_EQ(any, any_expected);
  std::vector<Hit<float>> all, all_expected;
  for (std::size_t i = 0; i < rays.size(); i += 9) {
    tree.all_hits(rays[i], all), built.all_hits(rays[i], all_expected);
    ASSERT_TRUE(all == all_expected);
  }
}

V swirled(const V& p, float turn) {
  const float angle = turn * p[2], c = std::cos(angle), s = std::sin(angle);
  return {c * p[0] - s * p[1], s * p[0] + c * p[1], p[2] * (1 + turn)};
}

TYPED_TEST(WideRefit, AnswersAsIfBuiltAnew) {
  const Mesh<float> mesh = sphere<float>(5);
  TypeParam tree(mesh);
  const auto rays = random_rays(1000, 11);
  for (const float turn : {0.0f, 0.5f, 5.0f, 0.0f}) {
    Mesh<float> moved = mesh;
    for (V& p : moved.vertices) p = swirled(p, turn);
    for (const int threads : {1, 2}) {
      tree.refit(moved, threads);
      expect_alike(tree, TypeParam(moved), rays);
    }
  }
  // To a place, and a size, where another centre and another scale are kept.
  for (const float scale : {1.0f, 1e-9f, 1e12f}) {
    Mesh<float> moved = mesh;
    const V centre = V{1e3f, 0, -2e3f} * scale;
    for (V& p : moved.vertices) p = swirled(p, 1) * scale + centre;
    tree.refit(moved);
    expect_alike(tree, TypeParam(moved), random_rays(500, 12, centre, scale));
  }
}

TYPED_TEST(WideRefit, TakesTreesOfSpatialSplitsAndSingleTriangles) {
  auto triangles = soup<float>(2000, 0.4f, 13);
  TypeParam tree(triangles, {}, [](std::span<const Triangle<float>> t, const BinaryBuildOptions& options) {
    return build_spatial(t, {options});
  });
  ASSERT_GT(tree.stats().references, triangles.size());
  for (auto& t : triangles) t = {swirled(t.a, 0.7f), swirled(t.b, 0.7f), swirled(t.c, 0.7f)};
  tree.refit(triangles);
  expect_alike(tree, TypeParam(triangles), random_rays(700, 14));
  std::vector<Triangle<float>> one{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}};
  TypeParam small(one);
  one[0].c = {0, 0, 1};
  small.refit(one);
  expect_alike(small, TypeParam(one), random_rays(700, 15));
}

TYPED_TEST(WideRefit, TrianglesMayVanishAndComeBack) {
  const auto triangles = soup<float>(500, 0.3f, 16);
  TypeParam tree(triangles, {.non_finite = NonFinite::drop});
  const auto rays = random_rays(700, 17);
  const auto built = [](const auto& t) { return TypeParam(t, {.non_finite = NonFinite::drop}); };
  auto moved = triangles;
  for (std::size_t i = 0; i < moved.size(); i += 3) moved[i].c = moved[i].b;
  for (std::size_t i = 1; i < moved.size(); i += 7) moved[i].a[1] = std::numeric_limits<float>::infinity();
  tree.refit(moved);
  EXPECT_LT(tree.size(), 400u);
  expect_alike(tree, built(moved), rays);
  for (auto& t : moved) t = {{1, 2, 3}, {1, 2, 3}, {1, 2, 3}};
  tree.refit(moved);
  EXPECT_EQ(tree.size(), 0u);
  for (const R& ray : rays) ASSERT_FALSE(tree.any_hit(ray) || tree.closest_hit(ray));
  tree.refit(triangles);
  expect_alike(tree, built(triangles), rays);
}

TYPED_TEST(WideRefit, RefusesWhatIsNotTheSameAndStaysAsItIs) {
  auto triangles = soup<float>(300, 0.3f, 18);
  triangles[7].c = triangles[7].a;
  TypeParam tree(triangles);
  const TypeParam before(triangles);
  const auto rays = random_rays(300, 19);
  auto other = triangles;
  for (auto& t : other) t.a[0] += 0.5f;
  const auto refuses = [&](const std::vector<Triangle<float>>& moved, const char* why) {
    try {
      tree.refit(moved);
      FAIL() << "not refused: " << why;
    } catch (const InvalidInput& error) {
      EXPECT_NE(std::string(error.what()).find(why), std::string::npos) << error.what();
    }
    expect_alike(tree, before, rays);
  };
  refuses({other.begin(), other.end() - 1}, "299");
  other[7].c[1] += 1;
  refuses(other, "triangle 7 ");
  other[7] = triangles[7], other[9].b[2] = std::numeric_limits<float>::quiet_NaN();
  refuses(other, "triangle 9 ");
  TypeParam none{std::vector<Triangle<float>>{}};
  none.refit(std::vector<Triangle<float>>{});
  EXPECT_FALSE(none.any_hit({{}, {1, 0, 0}}));
  EXPECT_THROW(none.refit(triangles), InvalidInput);
  EXPECT_THROW(tree.refit(triangles, 0), InvalidInput);
}

}  // namespace
}  // namespace treeline::accel::test
