// The layouts of the wide tree over triangles against each other: what they answer must not differ by a bit,
// and what the compact one stores must enclose what it stands for.
#include "accel/bvh/wide_compact.hpp"
#include "accel/bvh/wide_triangles.hpp"
#include "tests/accel/triangles_wide.hpp"

namespace treeline::accel::test {
namespace {

template <class Policy, class Name>
struct Case {
  using Tree = Bvh<Triangles<float, Policy>, Name>;
  using Reference = Bvh<Triangles<float, Policy>, accel::Wide>;
};
template <class C>
class WideLayouts : public testing::Test {};
using Cases = testing::Types<Case<Watertight, WideOf<4, 4>>, Case<Watertight, WideOf<16, 8>>,
                             Case<Watertight, WideCompact<8>>, Case<geometry::Exact, WideCompact<16>>>;
TYPED_TEST_SUITE(WideLayouts, Cases);

/// Rays of all kinds, and rays at corners and edges of the triangles.
std::vector<R> rays_at(const std::vector<Triangle<float>>& triangles, std::uint64_t seed, V centre = {}) {
  std::vector<R> rays = random_rays(1500, seed, centre);
  Pcg32 random(seed, 7);
  for (int i = 0; i < 1500; ++i) {
    const auto& t = triangles[random.below(static_cast<std::uint32_t>(triangles.size()))];
    const V target = i % 3 == 0 ? t.a : i % 3 == 1 ? (t.a + t.b) * 0.5f : t.centroid();
    const V origin = in_cube(random, 2.0f) + centre;
    if (origin != target) rays.push_back({origin, target - origin});
  }
  return rays;
}

template <class Tree, class Reference>
void expect_alike(const std::vector<Triangle<float>>& triangles, const std::vector<R>& rays) {
  const Tree tree(triangles);
  const Reference reference(triangles);
  ASSERT_EQ(tree.size(), reference.size());
  ASSERT_EQ(tree.bounds(), reference.bounds());
  std::vector<Hit<float>> hits(rays.size()), expected(rays.size());
  std::vector<std::uint8_t> any(rays.size()), any_expected(rays.size());
  reference.closest_hit(rays, expected, 1), reference.any_hit(rays, any_expected, 1);
  for (const RayBatch how : {RayBatch::singly, RayBatch::streams, RayBatch::packets}) {
    tree.closest_hit(rays, hits, 1, how), tree.any_hit(rays, any, 1, how);
    ASSERT_TRUE(hits == expected);
    ASSERT_EQ(any, any_expected);
  }
  std::size_t met = 0;
  std::vector<Hit<float>> all, all_expected;
  for (std::size_t i = 0; i < rays.size(); i += 7) {
    tree.all_hits(rays[i], all), reference.all_hits(rays[i], all_expected);
    ASSERT_TRUE(all == all_expected) << "ray " << i;
    met += all.size();
  }
  EXPECT_GT(met, rays.size() / 30);  // not a test of misses alone
}

TYPED_TEST(WideLayouts, AnswerAlike) {
  const auto check = [](const std::vector<Triangle<float>>& triangles, std::uint64_t seed, V centre = {}) {
    expect_alike<typename TypeParam::Tree, typename TypeParam::Reference>(triangles,
                                                                          rays_at(triangles, seed, centre));
  };
  const auto triangles_of = [](const Mesh<float>& mesh) {
    std::vector<Triangle<float>> triangles;
    for (std::size_t i = 0; i < mesh.size(); ++i) triangles.push_back(mesh.triangle(i));
    return triangles;
  };
  check(soup<float>(5000, 0.1f, 31), 32);
  check(soup<float>(3, 0.5f, 33), 34);
  check(triangles_of(sphere<float>(4)), 35);
  check(triangles_of(sphere<float>(4, {1e3f, -2e3f, 5e2f}, 1.0f)), 36, {1e3f, -2e3f, 5e2f});
  Mesh<float> boxes;
  for (int i = 0; i < 500; ++i) {
    const V low{float(i % 8) / 4 - 1, float(i / 8 % 8) / 4 - 1, float(i / 64) / 4 - 1};
    add_box<float>(boxes, {low, low + V{0.125f, 0.25f, 0.0625f}});
  }
  check(triangles_of(boxes), 37);
  std::vector<Triangle<float>> spread;  // nodes of very different children
  for (int i = 0; i < 1000; ++i) {
    const float x = std::ldexp(1.0f, i % 40 - 20), s = x * 0.1f;
    spread.push_back({{x, -s, -s}, {x, s, -s}, {x, 0, s}});
  }
  check(spread, 38);
}

/// Neighbours that go the same way, from one point or side by side, some of them at corners.
TYPED_TEST(WideLayouts, AnswerPacketsAlike) {
  Pcg32 random(41);
  for (const bool closed : {false, true}) {
    const Mesh<float> mesh = sphere<float>(4);
    auto triangles = soup<float>(4000, 0.2f, 42);
    if (closed) {
      triangles.clear();
      for (std::size_t i = 0; i < mesh.size(); ++i) triangles.push_back(mesh.triangle(i));
    }
    const typename TypeParam::Tree tree(triangles);
    const typename TypeParam::Reference reference(triangles);
    for (int bundle = 0; bundle < 60; ++bundle) {
      const V eye = in_cube(random, bundle % 3 == 0 ? 0.3f : 3.0f), ahead = in_cube(random, 1.0f);
      const float spread = bundle % 4 == 0 ? 1e-3f : bundle % 4 == 1 ? 0.03f : 0.3f;
      std::vector<R> rays;
      for (int i = 0; i < 100; ++i) {
        const V aside = in_cube(random, spread);
        R ray = bundle % 2 ? R{eye, ahead + aside} : R{eye + aside, ahead};
        if (bundle % 5 == 0 && i % 4 == 0) ray.direction = triangles[random.below(900)].a - eye;
        if (bundle % 7 == 0) ray.t_min = -1, ray.t_max = float(i % 5) - 2;
        if (bundle % 11 == 0 && i % 9 == 0) ray.direction[i % 3] = 0;
        rays.push_back(ray);
      }
      std::vector<Hit<float>> hits(rays.size());
      std::vector<std::uint8_t> any(rays.size());
      tree.closest_hit(rays, hits, 1, RayBatch::packets), tree.any_hit(rays, any, 1, RayBatch::packets);
      for (std::size_t i = 0; i < rays.size(); ++i) {
        ASSERT_TRUE(hits[i] == reference.closest_hit(rays[i])) << bundle << ' ' << i;
        ASSERT_EQ(any[i] != 0, reference.any_hit(rays[i])) << bundle << ' ' << i;
      }
    }
  }
}

TYPED_TEST(WideLayouts, SlicesCoverTheirTriangles) {
  const typename TypeParam::Tree tree(sphere<float>(4));
  double left = 1e9, right = -1e9;
  std::size_t triangles = 0;
  for (const SliceCell& cell : tree.slice(2, 0.0))
    for (const auto& p : (triangles += cell.primitives, cell.outline))
      left = std::min(left, p[0]), right = std::max(right, p[0]);
  EXPECT_NEAR(left, -1, 0.02);
  EXPECT_NEAR(right, 1, 0.02);
  EXPECT_GT(triangles, 100u);
}

template <class Count>
class CompactBoxes : public testing::Test {};
using Counts = testing::Types<std::uint8_t, std::uint16_t>;
TYPED_TEST_SUITE(CompactBoxes, Counts);

/// A coordinate of any size, now and then one of a few that come again.
float any_size(Pcg32& random, int exponents) {
  if (random.below(4) == 0) return static_cast<float>(static_cast<int>(random.below(3)) - 1);
  const int exponent =
      static_cast<int>(random.below(static_cast<std::uint32_t>(2 * exponents + 1))) - exponents;
  const float sign = random.below(2) == 0 ? 1.0f : -1.0f;
  return sign * std::ldexp(1 + random.uniform<float>(), exponent);
}

TYPED_TEST(CompactBoxes, EncloseWhatTheyStandForAtEveryScale) {
  using Layout = wide::CompactLayout<TypeParam>;
  Pcg32 random(91);
  std::size_t tight = 0, sides = 0;
  for (int round = 0; round < 20000; ++round) {
    const std::size_t count = 1 + random.below(8);
    // From one size to all that floats have (a tree's coordinates stay below 2^66).
    const int exponents = round % 4 == 0 ? 0 : round % 4 == 1 ? 3 : round % 4 == 2 ? 30 : 65;
    const int shift = round % 8 < 4 ? 0 : -120;
    std::vector<Box<float, 3>> boxes(count);
    for (auto& box : boxes) {
      const auto point = [&] {
        V p;
        for (int k = 0; k < 3; ++k) p[k] = std::ldexp(any_size(random, exponents), shift);
        return p;
      };
      box.grow(point());
      if (random.below(3) > 0) box.grow(point());  // else flat along every axis
    }
    std::vector<wide::Ref> refs;
    for (std::size_t i = 0; i < count; ++i) refs.push_back(wide::ref_to(1000 + 5 * i, i % 2 == 0));
    typename Layout::Node node;
    Layout::write(node, {boxes, refs});
    ASSERT_EQ(Layout::count(node), static_cast<int>(count));
    const auto children = Layout::children(node);
    Box<float, 3> all;
    for (const auto& box : boxes) all.grow(box);
    for (std::size_t i = 0; i < count; ++i) {
      ASSERT_EQ(Layout::child(node, static_cast<std::uint32_t>(i)), refs[i]);
      ASSERT_EQ(children.ref[i], refs[i]);
      const Box<float, 3> stored = Layout::box(node, static_cast<int>(i));
      for (int k = 0; k < 3; ++k) {
        ASSERT_LE(stored.low[k], boxes[i].low[k]) << round;
        ASSERT_GE(stored.high[k], boxes[i].high[k]) << round;
        // A step is at most 2 / 2^bits of the node's extent, but no less than floats there tell apart.
        const double step =
            4 * (double(all.high[k]) - double(all.low[k])) / std::ldexp(1.0, sizeof(TypeParam) * 8);
        const double floats = std::max(std::abs(double(all.low[k])), std::abs(double(all.high[k]))) * 2e-7;
        const double most = std::max({step, floats, 2.4e-38});
        ASSERT_LE(double(boxes[i].low[k]) - double(stored.low[k]), most) << round;
        ASSERT_LE(double(stored.high[k]) - double(boxes[i].high[k]), most) << round;
        tight += stored.low[k] == boxes[i].low[k], ++sides;
      }
    }
  }
  EXPECT_GT(tight, sides / 10);
}

TYPED_TEST(CompactBoxes, EncloseTheBoundsOfATreeThatIsOneFlatBox) {
  using Tree = Bvh<Triangles<float, Watertight>, WideCompact<static_cast<int>(sizeof(TypeParam) * 8)>>;
  std::vector<Triangle<float>> floor;
  for (int x = 0; x < 30; ++x)
    for (int y = 0; y < 30; ++y) {
      const float fx = float(x) * 0.3f, fy = float(y) * 0.3f;
      floor.push_back({{fx, fy, 0.7f}, {fx + 0.3f, fy, 0.7f}, {fx, fy + 0.3f, 0.7f}});
    }
  const Tree tree(floor);
  const Bvh<Triangles<float, Watertight>, accel::Wide> reference(floor);
  for (std::size_t i = 0; i < floor.size(); ++i) {
    const V c = floor[i].centroid();
    const auto down = tree.closest_hit({{c[0], c[1], 5}, {0, 0, -1}});
    ASSERT_EQ(down.primitive, i);
    for (const V& direction : {V{1, 0, 1}, V{1, 1, 0}, V{0, 1, 1e-6f}})
      ASSERT_TRUE(tree.closest_hit({c, direction, -1}) == reference.closest_hit({c, direction, -1}));
  }
}

TEST(CompactLeaves, KeepEveryCornerAsItIs) {
  using Layout = wide::CompactLayout<std::uint8_t>;
  Pcg32 random(95);
  alignas(64) unsigned char memory[1024];
  for (int round = 0; round < 5000; ++round) {
    const std::uint32_t count = 1 + random.below(8);
    V pool[24];
    for (V& p : pool)
      for (int k = 0; k < 3; ++k) p[k] = any_size(random, 60);
    pool[3] = V{0.0f, 0.0f, 0.0f}, pool[4] = V{-0.0f, 0.0f, 0.0f};  // equal, but not the same
    const std::uint32_t corners = round % 2 ? 24 : 3 + random.below(8);
    wide::RayLeaf<8> full;
    for (std::uint32_t j = 0; j < 8; ++j) {
      for (int i = 0; i < 3; ++i) {
        const V& p = pool[corners == 24 ? 3 * j + static_cast<std::uint32_t>(i) : random.below(corners)];
        for (int k = 0; k < 3; ++k) full.corner[i][k][j] = j < count ? p[k] : full.corner[i][k][count - 1];
      }
      full.id[j] = j < count ? 17 * j + static_cast<std::uint32_t>(round) : full.id[count - 1];
    }
    const std::size_t bytes = Layout::leaf_steps(full, count) * Layout::step;
    ASSERT_LE(bytes + Layout::overrun, sizeof memory);
    std::memset(memory, 0xee, sizeof memory);
    auto& leaf = *reinterpret_cast<wide::CompactLeaf*>(memory);
    Layout::write(leaf, full, count);
    for (std::size_t i = bytes; i < sizeof memory; ++i) ASSERT_EQ(memory[i], 0xee);
    const wide::RayLeaf<8> same = Layout::triangles(leaf);
    ASSERT_EQ(std::memcmp(&same, &full, sizeof full), 0) << round;
  }
}

TEST(CompactLeaves, TakeHalfTheMemoryOfAClosedMesh) {
  const Mesh<float> mesh = sphere<float>(5);
  const Bvh<Triangles<float, Watertight>, accel::Wide> full(mesh);
  const Bvh<Triangles<float, Watertight>, WideCompact<8>> compact(mesh);
  EXPECT_LT(static_cast<double>(compact.bytes()), 0.55 * static_cast<double>(full.bytes()));
}

}  // namespace
}  // namespace treeline::accel::test
