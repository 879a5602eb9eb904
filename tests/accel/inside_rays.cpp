// Inside and outside by rays: the wide tree's exact crossings against the exact oracle.
#include "accel/bvh/build_spatial.hpp"
#include "accel/bvh/wide_compact.hpp"
#include "accel/signed_distance.hpp"
#include "tests/accel/inside_meshes.hpp"

namespace treeline::accel::test {
namespace {

using WideTree = Bvh<Triangles<float>, Wide>;
using FirstCrossings = wide::Crossings<WideTree>;

template <class Sign>
class InsideByRays : public testing::Test {};
using RaySigns = testing::Types<FirstHit, RayParity>;
TYPED_TEST_SUITE(InsideByRays, RaySigns);

template <class Sign, class Tree = WideTree>
void expect_truth(const Mesh3f& mesh, std::size_t n, std::uint64_t seed) {
  const SignedDistance<Tree, Sign> body(mesh);
  EXPECT_TRUE(body.closed() && body.oriented());
  const std::vector<Point3f> points = points_about(mesh, n, seed);
  std::vector<std::uint8_t> inside(n), again(n);
  body.inside(points, inside, 1), body.inside(points, again, 3);
  EXPECT_EQ(inside, again);
  std::size_t in = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const Truth truth = truth_of(mesh, points[i]);
    ASSERT_TRUE(truth.on || truth.winding == 0 || truth.winding == 1);
    ASSERT_EQ(inside[i] != 0, truth.inside()) << "point " << i << ", on the surface: " << truth.on;
    ASSERT_EQ(body.inside(points[i]), truth.inside()) << "point " << i;
    in += inside[i];
  }
  EXPECT_GT(in, n / 10);
  EXPECT_LT(in, n - n / 10);
}

TYPED_TEST(InsideByRays, IsExactOnRoughSpheres) { expect_truth<TypeParam>(bumpy(3, 1), 3000, 11); }
TYPED_TEST(InsideByRays, IsExactOnNestedShells) { expect_truth<TypeParam>(shells(), 3000, 12); }
TYPED_TEST(InsideByRays, IsExactFarFromTheOrigin) {
  expect_truth<TypeParam>(bumpy(3, 1, {4096, -2048, 1024}), 2000, 13);
}
TYPED_TEST(InsideByRays, IsExactAtExtremeSizes) {
  const Mesh3f mesh = bumpy(2, 1);
  for (const float scale : {0x1p-100f, 0x1p60f}) {  // exact: the truth is the unscaled mesh's
    Mesh3f scaled = mesh;
    for (Point3f& p : scaled.vertices) p = p * scale;
    const SignedDistance<WideTree, TypeParam> body(scaled);
    for (const Point3f& p : points_about(mesh, 300, 14))
      ASSERT_EQ(body.inside(p * scale), truth_of(mesh, p).inside());
  }
}
TYPED_TEST(InsideByRays, IsExactOnNeedles) {
  Mesh3f mesh = bumpy(3, 1);
  for (Point3f& p : mesh.vertices) p[0] *= 0x1p-14f, p[1] *= 0x1p9f;
  expect_truth<TypeParam>(mesh, 2000, 15);
}
TYPED_TEST(InsideByRays, IsExactOnAlignedBoxes) {
  Mesh3f mesh;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const auto x = static_cast<float>(2 * i), y = static_cast<float>(2 * j);
      add_box(mesh, Box<float, 3>{{x, y, 0}, {x + 1, y + 1, 1}});
    }
  const SignedDistance<WideTree, TypeParam> body(mesh);
  for (int x = -1; x < 24; ++x)
    for (int y = -1; y < 24; ++y)
      for (int z = -1; z < 6; ++z) {
        const Point3f p{0.25f * static_cast<float>(x), 0.25f * static_cast<float>(y),
                        0.25f * static_cast<float>(z)};
        const auto within = [](float v) { return v >= 0 && v <= 5 && std::fmod(v, 2.f) <= 1; };
        ASSERT_EQ(body.inside(p), within(p[0]) && within(p[1]) && p[2] >= 0 && p[2] <= 1)
            << p[0] << " " << p[1] << " " << p[2];
      }
}

TYPED_TEST(InsideByRays, OtherLayoutsAndBuildsAgree) {
  using Sixteen = Bvh<Triangles<float>, WideOf<16, 4>>;
  using Compact = Bvh<Triangles<float, geometry::Exact>, WideCompact<16>>;
  expect_truth<TypeParam, Sixteen>(shells(), 500, 16);
  expect_truth<TypeParam, Compact>(shells(), 500, 17);
  // Spatial splits keep a triangle in several leaves, where it must count once.
  Mesh3f mesh;  // thin bars across the axes
  for (int i = 0; i < 36; ++i) {
    const auto x = static_cast<float>(i % 6), y = static_cast<float>(i / 6);
    add_box(mesh, {{x, y, 0}, {x + 0.125f, y + 0.125f, 8}});
  }
  for (Point3f& p : mesh.vertices) p[0] += p[2], p[1] += p[2];
  const auto spatial = [](std::span<const Triangle<float>> triangles, const BinaryBuildOptions& options) {
    SpatialBuildOptions eager{options};
    eager.references = 2, eager.alpha = eager.overlap = 0;
    return build_spatial(triangles, eager);
  };
  WideTree tree(mesh, {}, spatial);
  ASSERT_GT(tree.stats().references, mesh.size());
  const SignedDistance<WideTree, TypeParam> body(mesh, std::move(tree));
  for (const Point3f& p : points_about(mesh, 1000, 18)) ASSERT_EQ(body.inside(p), truth_of(mesh, p).inside());
}

// A ray through an edge or a corner tells nothing, whatever is behind; and the rules try another.
TEST(Crossings, EdgesAndCornersAreUnclear) {
  Mesh3f mesh;
  add_box(mesh, {{-1, -1, -1}, {1, 1, 1}});
  const WideTree tree(mesh);
  const FirstCrossings crossings(tree);
  EXPECT_EQ(crossings.first({{0, 0, 0}, {1, 1, 1}}), FirstCrossing::unclear);
  EXPECT_EQ(crossings.first({{0, 0, 0}, {1, 0.25f, 1}}), FirstCrossing::unclear);
  EXPECT_EQ(crossings.first({{0, 0, 0}, {1, 0.5f, 0.25f}}), FirstCrossing::outward);
  EXPECT_EQ(crossings.first({{-3, 0.125f, 0.25f}, {1, 0, 0}}), FirstCrossing::inward);
  EXPECT_EQ(crossings.first({{-3, 1, 0.25f}, {1, 0, 0}}), FirstCrossing::unclear);  // along a side
  EXPECT_EQ(crossings.first({{-3, 2, 0.25f}, {1, 0, 0}}), FirstCrossing::none);
  EXPECT_EQ(crossings.first({{1, 0.125f, 0.25f}, {1, 0.25f, 0}}), FirstCrossing::surface);
  const CrossingCount through = crossings.count({{-3, 0.125f, 0.25f}, {1, 0, 0}});
  EXPECT_EQ(through.inward, 1u);
  EXPECT_EQ(through.outward, 1u);
  EXPECT_FALSE(through.unclear);
  EXPECT_TRUE(crossings.count({{0, 0, 0}, {1, 1, 1}}).unclear);
}

// The first direction of a point that is chosen to meet a corner: it must be tried again.
TEST(Crossings, TheFirstDirectionMeetsACorner) {
  const Point3f corner{1, 1, 1};
  const ProbeDirections directions(Point3f{0, 0, 0});
  const Point3f d = directions({0.5f, 0.5f, 0.5f}, 0);
  Mesh3f mesh;  // an octahedron about the origin, moved so that its corner is on the ray
  const Point3f from = corner - d;
  add_box(mesh, {{-1, -1, -1}, corner});
  const WideTree tree(mesh);
  ASSERT_EQ(FirstCrossings(tree).first({from, directions(from, 0)}), FirstCrossing::unclear);
  EXPECT_TRUE((SignedDistance<WideTree>(mesh).inside(from)));
  EXPECT_TRUE((SignedDistance<WideTree, RayParity>(mesh).inside(from)));
}

// Two walls so close that their times round to one float: which is first decides.
TEST(Crossings, SheetsOneStepApart) {
  Mesh3f mesh;
  const float low = 1, high = std::nextafter(1.0f, 2.0f);
  add_box(mesh, {{-1, -1, low}, {1, 1, high}});
  const WideTree tree(mesh);
  const FirstCrossings crossings(tree);
  for (int i = 0; i < 50; ++i) {
    const float x = 0.01f * static_cast<float>(i);
    EXPECT_NE(crossings.first({{x, 0.1f, -3}, {0.01f, 0.02f, 1}}), FirstCrossing::outward);
    EXPECT_NE(crossings.first({{x, 0.1f, 5}, {0.01f, 0.02f, -1}}), FirstCrossing::outward);
  }
  const SignedDistance<WideTree> body(mesh);
  EXPECT_FALSE(body.inside({0.1f, 0.1f, std::nextafter(low, 0.0f)}));
  EXPECT_TRUE(body.inside({0.1f, 0.1f, low}));
  EXPECT_TRUE(body.inside({0.1f, 0.1f, high}));
  EXPECT_FALSE(body.inside({0.1f, 0.1f, std::nextafter(high, 2.0f)}));
}

// Two boxes with a wall in common, there twice and facing both ways: every ray to it is unclear, and beside
// it the union is inside.
TEST(Crossings, AWallThatIsThereTwice) {
  Mesh3f mesh;
  add_box(mesh, {{0, 0, 0}, {1, 1, 1}}), add_box(mesh, {{1, 0, 0}, {2, 1, 1}});
  const SignedDistance<WideTree> first(mesh);
  const SignedDistance<WideTree, RayParity> parity(mesh);
  Pcg32 random(21);
  for (int i = 0; i < 500; ++i) {
    const Point3f p{random.uniform<float>(-0.5f, 2.5f), random.uniform<float>(-0.5f, 1.5f),
                    random.uniform<float>(-0.5f, 1.5f)};
    const bool in = Box<float, 3>{{0, 0, 0}, {2, 1, 1}}.contains(p);
    ASSERT_EQ(first.inside(p), in);
    ASSERT_EQ(parity.inside(p), in);
  }
  EXPECT_TRUE(first.inside({1, 0.5f, 0.25f}) && parity.inside({1, 0.5f, 0.25f}));
}

// What each rule makes of a mesh inside out: parity does not mind.
TEST(Crossings, InsideOut) {
  Mesh3f mesh = bumpy(2, 1);
  turn_around(mesh);
  const SignedDistance<WideTree> first(mesh);
  const SignedDistance<WideTree, RayParity> parity(mesh);
  EXPECT_TRUE(first.closed() && first.oriented());
  EXPECT_FALSE(first.inside({0, 0, 0}));
  EXPECT_TRUE(parity.inside({0, 0, 0}));
}

}  // namespace
}  // namespace treeline::accel::test
