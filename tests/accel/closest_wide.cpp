// Closest points of the wide tree, once for each instruction set: against exact arithmetic on sets that
// strain them, against laws and closed forms, after a refit, in batches. With --digest it prints a hash of
// its answers instead, which all instruction sets must agree on.
#include "tests/accel/closest_wide.hpp"

#include "accel/bvh/wide_compact.hpp"
#include "accel/bvh/wide_triangles.hpp"
#include "geometry/sampling.hpp"
#include "tests/accel/instruction_set.hpp"

namespace treeline::accel::test {
namespace {

using Eight = Bvh<Triangles<float, Watertight>, WideOf<8, 8>>;

template <class Tree>
class WideClosest : public testing::Test {};
using Trees = testing::Types<Eight, Bvh<Triangles<float, Watertight>, WideOf<4, 4>>,
                             Bvh<Triangles<float, Watertight>, WideOf<16, 8>>,
                             Bvh<Triangles<float, Watertight>, WideCompact<16>>>;
TYPED_TEST_SUITE(WideClosest, Trees);

TYPED_TEST(WideClosest, ExactModeIsTheExactOracle) {
  for (const TriangleCase& c : triangle_cases()) {
    const TypeParam tree(c.triangles);
    for (const V& q : places(c.triangles, 70, 11)) {
      const ExactNearest expected = exact_nearest(c.triangles, q);
      const auto precise = tree.template closest_point<double>(q, {.exact = true});
      ASSERT_EQ(precise.primitive, expected.id) << c.name;
      ASSERT_EQ(precise.distance2, expected.distance2) << c.name;
      const Triangle<double> t(c.triangles[expected.id]);
      ASSERT_EQ(static_cast<int>(precise.feature), geometry::exact_feature(D(q), t)) << c.name;
      const auto single = tree.closest_point(q, {.exact = true});
      ASSERT_EQ(single.primitive, expected.id) << c.name;
      const auto nearest_float = [&] {  // of a double that is the true one rounded: never by two steps
        return std::nextafter(single.distance2, static_cast<float>(expected.distance2));
      };
      ASSERT_TRUE(single.distance2 == static_cast<float>(expected.distance2) ||
                  nearest_float() == static_cast<float>(expected.distance2))
          << c.name;
    }
  }
}

/// Whatever float does, what is found is what double finds: off by double's rounding of the distance and of
/// the triangle's size, and by what a sliver's own height leaves.
TYPED_TEST(WideClosest, IsRightToTheRoundingOfDouble) {
  for (const TriangleCase& c : triangle_cases()) {
    const TypeParam tree(c.triangles);
    Box<float, 3> box;
    for (const auto& t : c.triangles) box.grow(t.box());
    const double size = length(D(box.extent()));
    for (const V& q : places(c.triangles, 140, 12)) {
      const double expected = std::sqrt(exact_nearest(c.triangles, q).distance2);
      const auto found = tree.template closest_point<double>(q, ClosestOptions{});
      ASSERT_TRUE(found) << c.name;
      const Triangle<double> t(c.triangles[found.primitive]);
      const double rounding = 1e-13 * (expected + size),
                   true_distance = std::sqrt(geometry::exact_distance2(D(q), t));
      EXPECT_NEAR(true_distance, expected, rounding) << c.name;
      EXPECT_NEAR(std::sqrt(found.distance2), expected, rounding) << c.name;
      // The point lies on its triangle; its own coordinates are rounded, too.
      double reach = 0;
      for (int k = 0; k < 3; ++k) reach = std::max(reach, std::abs(found.point[k]));
      const double point_rounding = rounding + 4 * 0x1p-53 * reach;
      EXPECT_NEAR(distance(D(q), found.point), expected, point_rounding) << c.name;
      EXPECT_LE(std::sqrt(geometry::exact_distance2(found.point, t)), point_rounding) << c.name;
      const auto single = tree.closest_point(q);
      EXPECT_EQ(single.primitive, found.primitive) << c.name;
      EXPECT_EQ(single.feature, found.feature) << c.name;
      EXPECT_EQ(single.distance2, static_cast<float>(found.distance2)) << c.name;
      EXPECT_EQ(single.point, V(found.point)) << c.name;
    }
  }
}

/// Laws that know no truth: the distance changes by no more than the way, and no corner is nearer.
TYPED_TEST(WideClosest, DistanceIsLipschitzAndBelowThatToEveryCorner) {
  Pcg32 random(21);
  for (const TriangleCase& c : triangle_cases()) {
    const TypeParam tree(c.triangles);
    const auto queries = places(c.triangles, 300, 22);
    const auto to = [&](const V& q) {
      return std::sqrt(tree.template closest_point<double>(q, ClosestOptions{}).distance2);
    };
    Box<float, 3> box;
    for (const auto& t : c.triangles) box.grow(t.box());
    const double size = length(D(box.extent()));
    for (std::size_t i = 0; i < queries.size(); ++i) {
      const V p = queries[i], q = i % 2 ? queries[i / 2] : p + (queries[i / 2] - p) * 1e-4f;
      const double here = to(p), there = to(q), rounding = 1e-13 * (here + there + size);
      ASSERT_LE(std::abs(here - there), distance(D(p), D(q)) + rounding) << c.name;
      double corner = std::numeric_limits<double>::infinity();
      for (const auto& t : c.triangles)
        for (const V* v : {&t.a, &t.b, &t.c}) corner = std::min(corner, distance(D(p), D(*v)));
      ASSERT_LE(here, corner + rounding) << c.name;
      ASSERT_GE(here, distance(D(p), D(box.centre())) - size) << c.name;  // it is somewhere in the box
    }
  }
}

TYPED_TEST(WideClosest, KnowsTheDistanceToABox) {
  const Box<float, 3> box{{-1, -2, -3}, {2, 3, 5}};
  Mesh<float> mesh;
  add_box<float>(mesh, box);
  const TypeParam tree(mesh);
  Pcg32 random(31);
  for (int i = 0; i < 2000; ++i) {
    const V q = in_cube(random, i % 2 ? 8.0f : 2.5f);
    double outside = 0, inside = std::numeric_limits<double>::infinity();
    for (int k = 0; k < 3; ++k) {
      const double low = static_cast<double>(box.low[k]) - static_cast<double>(q[k]),
                   high = static_cast<double>(q[k]) - static_cast<double>(box.high[k]);
      const double gap = std::max({low, high, 0.0});
      outside += gap * gap, inside = std::min(inside, std::min(-low, -high));
    }
    const double expected = outside > 0 ? std::sqrt(outside) : inside;
    EXPECT_NEAR(std::sqrt(tree.template closest_point<double>(q, ClosestOptions{}).distance2), expected,
                1e-14);
  }
  const auto at_corner = tree.closest_point({-3, -4, -5});
  EXPECT_EQ(at_corner.point, (V{-1, -2, -3}));
  EXPECT_EQ(at_corner.distance2, 12.0f);
  EXPECT_GE(at_corner.feature, Feature::vertex_a);
  const auto at_face = tree.closest_point({7, 0.25f, 1});
  EXPECT_EQ(at_face.point, (V{2, 0.25f, 1}));
  EXPECT_EQ(at_face.feature, Feature::face);
  const auto at_edge = tree.closest_point({7, 8, 1});
  EXPECT_EQ(at_edge.point, (V{2, 3, 1}));
  EXPECT_TRUE(at_edge.feature >= Feature::edge_ab && at_edge.feature <= Feature::edge_ca);
}

TYPED_TEST(WideClosest, MaxDistanceIsInclusiveAndLimits) {
  const std::vector<Triangle<float>> triangles{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
                                               {{0, 0, 9}, {1, 0, 9}, {0, 1, 9}},
                                               {{3, 3, 3}, {3, 3, 3}, {3, 3, 3}}};
  const TypeParam tree(triangles);
  const V q{0.25f, 0.25f, 2};
  for (const bool exact : {false, true}) {
    const auto at = [&](const V& p, float limit) {
      return tree.closest_point(p, {.max_distance = limit, .exact = exact});
    };
    EXPECT_EQ(at(q, 2).primitive, 0u);
    EXPECT_EQ(at(q, 2).feature, Feature::face);
    EXPECT_FALSE(at(q, 1.9999999f));
    EXPECT_EQ(at({0.25f, 0.25f, 0}, 0).distance2, 0.0f);
    EXPECT_FALSE(at({0.25f, 0.25f, 1e-30f}, 0));
    EXPECT_EQ(at({3, 3, 4}, 1).primitive, 2u);
    EXPECT_FALSE(at({3, 3, 4}, 0.99999994f));
  }
  // Among many, as the search without a limit and a comparison would say.
  const auto many = soup<float>(500, 0.1f, 41);
  const TypeParam large(many);
  std::size_t met = 0;
  for (const V& p : places(many, 200, 42)) {
    const auto all = large.template closest_point<double>(p, ClosestOptions{});
    for (const float limit : {0.0f, 0.01f, 0.3f}) {
      const auto found = large.closest_point(p, limit);
      const bool expected = all.distance2 <= static_cast<double>(limit) * static_cast<double>(limit);
      ASSERT_EQ(static_cast<bool>(found), expected);
      if (!expected) continue;
      ++met;
      ASSERT_EQ(found.primitive, all.primitive);
    }
  }
  EXPECT_GT(met, 100u);
}

TYPED_TEST(WideClosest, BatchesAnswerAsSingleQueriesBitByBit) {
  for (const TriangleCase& c : triangle_cases()) {
    const TypeParam tree(c.triangles);
    const auto queries = places(c.triangles, 1200, 51);
    for (const bool exact : {false, true})
      for (const float limit : {std::numeric_limits<float>::infinity(), 0.05f}) {
        const ClosestOptions options{limit, exact};
        std::vector<ClosestPoint<float>> out(queries.size());
        for (const QueryOrder order : {QueryOrder::curve, QueryOrder::given, QueryOrder::automatic})
          for (const int threads : {1, 3}) {
            if (threads == 3 && order == QueryOrder::given) continue;
            tree.template closest_point<float>(queries, options, out, threads, order);
            for (std::size_t i = 0; i < queries.size(); i += 5) {
              const auto single = tree.closest_point(queries[i], options);
              ASSERT_EQ(out[i].primitive, single.primitive) << c.name << ' ' << i;
              ASSERT_EQ(out[i].distance2, single.distance2) << c.name << ' ' << i;
              ASSERT_EQ(out[i].point, single.point) << c.name << ' ' << i;
              ASSERT_EQ(out[i].feature, single.feature) << c.name << ' ' << i;
            }
          }
      }
  }
}

/// Neighbours on a fine mesh, which are answered together, among queries that leave the list of what is near
/// all of them: nearer and farther ones, strays, and crowds at one place.
TYPED_TEST(WideClosest, NeighboursInBatchesAnswerAsSingleQueriesBitByBit) {
  Pcg32 random(56);
  for (const bool ragged : {false, true}) {
    auto triangles = triangles_of(sphere<float>(5));
    if (ragged)
      for (const auto& t : soup<float>(3000, 0.02f, 57)) triangles.push_back(t);
    const TypeParam tree(triangles);
    std::vector<V> queries;
    for (int i = 0; i < 6000; ++i) {
      const auto& t = triangles[random.below(static_cast<std::uint32_t>(triangles.size()))];
      const float away = i % 50 == 0 ? 0.3f : i % 7 == 0 ? 0.03f : 0.003f;
      queries.push_back(i % 11 == 0 ? t.b : (t.a + t.b + t.c) * (1.0f / 3) + in_cube(random, away));
      if (i % 400 == 0) queries.push_back(in_cube(random, i % 800 == 0 ? 10.0f : 0.2f));
    }
    for (int i = 0; i < 300; ++i) queries.push_back(triangles[0].a + in_cube(random, 1e-4f));
    for (const bool exact : {false, true})
      for (const float limit : {std::numeric_limits<float>::infinity(), 0.01f, 0.0f}) {
        const ClosestOptions options{limit, exact};
        std::vector<ClosestPoint<double>> out(queries.size());
        tree.template closest_point<double>(queries, options, out, ragged ? 3 : 1, QueryOrder::curve);
        for (std::size_t i = 0; i < queries.size(); ++i) {
          const auto single = tree.template closest_point<double>(queries[i], options);
          ASSERT_EQ(out[i].primitive, single.primitive) << i;
          ASSERT_EQ(out[i].distance2, single.distance2) << i;
          ASSERT_EQ(out[i].point, single.point) << i;
          ASSERT_EQ(out[i].feature, single.feature) << i;
        }
      }
  }
}

TYPED_TEST(WideClosest, PilesOfEqualTrianglesGiveTheLowestId) {
  std::vector<Triangle<float>> pile(3000, Triangle<float>{{-1, -1, 1}, {1, -1, 1}, {0, 1, 1}});
  for (int i = 0; i < 1000; ++i) pile.push_back({{5, 5, 5}, {5, 5, 5}, {5, 5, 5}});
  const TypeParam tree(pile);
  for (const bool exact : {false, true}) {
    EXPECT_EQ(tree.closest_point({0, 0, 3}, {.exact = exact}).primitive, 0u);
    EXPECT_EQ(tree.closest_point({-2, -2, 1}, {.exact = exact}).primitive, 0u);
    EXPECT_EQ(tree.closest_point({5, 5, 6}, {.exact = exact}).primitive, 3000u);
  }
}

TYPED_TEST(WideClosest, RefusesWhatHasNoAnswer) {
  const auto triangles = soup<float>(50, 0.2f, 61);
  const TypeParam tree(triangles);
  constexpr float nan = std::numeric_limits<float>::quiet_NaN(),
                  infinity = std::numeric_limits<float>::infinity();
  EXPECT_THROW((void)tree.closest_point({nan, 0, 0}), InvalidInput);
  EXPECT_THROW((void)tree.closest_point({0, -infinity, 0}, {.exact = true}), InvalidInput);
  EXPECT_THROW((void)tree.closest_point({0, 0, 0}, -1.0f), InvalidInput);
  EXPECT_THROW((void)tree.closest_point({0, 0, 0}, nan), InvalidInput);
  std::vector<V> queries(7);
  std::vector<ClosestPoint<float>> out(7);
  queries[5][1] = nan;
  try {
    tree.closest_point(queries, 1.0f, out, 1);
    FAIL() << "not refused";
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("query 5"), std::string::npos) << error.what();
  }
  queries[5][1] = 0;
  EXPECT_THROW(tree.closest_point(queries, 1.0f, std::span(out).first(6), 1), InvalidInput);
  EXPECT_THROW(tree.closest_point(queries, 1.0f, out, 0), InvalidInput);
  tree.closest_point(std::span<const V>{}, 1.0f, std::span<ClosestPoint<float>>{}, 1);
  const TypeParam none{std::vector<Triangle<float>>{}};
  EXPECT_FALSE(none.closest_point({1, 2, 3}));
  EXPECT_FALSE(none.closest_point({1, 2, 3}, {.exact = true}));
  const TypeParam point{std::vector<Triangle<float>>{{{1, 2, 3}, {1, 2, 3}, {1, 2, 3}}}};
  EXPECT_EQ(point.size(), 0u);
  EXPECT_EQ(point.closest_point({1, 2, 5}).distance2, 4.0f);
}

/// Largest and smallest queries that there are.
TYPED_TEST(WideClosest, AnswersFromAnywhere) {
  const auto triangles = soup<float>(300, 0.1f, 71);
  const TypeParam tree(triangles);
  for (const float x : {1e8f, 1e9f, 1e19f, 1e30f, 3e38f})
    for (const V& q : {V{x, 0, 0}, V{-x, x, x}, V{0, 1e-30f, -x}}) {
      const ExactNearest expected = exact_nearest(triangles, q);
      const auto found = tree.template closest_point<double>(q, {.exact = true});
      EXPECT_EQ(found.primitive, expected.id);
      EXPECT_EQ(found.distance2, expected.distance2);
    }
}

// ---- refit ---------------------------------------------------------------------------------------------

template <class Tree>
void expect_same_closest(const Tree& tree, const Tree& built, const std::vector<V>& queries) {
  for (std::size_t i = 0; i < queries.size(); ++i)
    for (const bool exact : {false, true}) {
      const auto found = tree.closest_point(queries[i], {.exact = exact}),
                 expected = built.closest_point(queries[i], {.exact = exact});
      ASSERT_EQ(found.primitive, expected.primitive) << i;
      ASSERT_EQ(found.distance2, expected.distance2) << i;
      ASSERT_EQ(found.point, expected.point) << i;
    }
}

TEST(WideClosestRefit, AnswersAsIfBuiltAnew) {
  auto triangles = soup<float>(600, 0.2f, 81);
  for (std::size_t i = 0; i < triangles.size(); i += 20) triangles[i].c = triangles[i].b;
  Eight tree(triangles, {.non_finite = NonFinite::drop});
  const auto drop = [](const auto& t) { return Eight(t, {.non_finite = NonFinite::drop}); };
  auto changed = triangles;
  for (auto& t : changed)
    for (V* v : {&t.a, &t.b, &t.c}) *v = {(*v)[1] * 2, (*v)[2] + 0.3f, (*v)[0] * (*v)[1]};
  // Those without an area may not gain one.
  for (std::size_t i = 0; i < changed.size(); i += 20) changed[i].c = changed[i].b;
  tree.refit(changed);
  expect_same_closest(tree, drop(changed), places(changed, 300, 82));
  // Some vanish, some lose their area: at (0, 0, 0) there is nothing, but near it are queries.
  for (std::size_t i = 1; i < changed.size(); i += 3) changed[i].b = changed[i].a;
  for (std::size_t i = 2; i < changed.size(); i += 9)
    changed[i].b[0] = std::numeric_limits<float>::infinity();
  tree.refit(changed);
  std::vector<V> queries;
  Pcg32 random(83);
  for (int i = 0; i < 400; ++i) queries.push_back(in_cube(random, i % 2 ? 1.0f : 0.05f));
  expect_same_closest(tree, drop(changed), queries);
  std::vector<ClosestPoint<float>> out(queries.size());
  tree.closest_point<float>(queries, ClosestOptions{}, out, 1, QueryOrder::curve);
  for (std::size_t i = 0; i < queries.size(); ++i)
    ASSERT_EQ(out[i].primitive, tree.closest_point(queries[i]).primitive);
  tree.refit(triangles);
  expect_same_closest(tree, drop(triangles), places(triangles, 300, 84));
  // To another place and size.
  const auto elsewhere = moved(triangles, 1e-12f, {});
  tree.refit(elsewhere);
  expect_same_closest(tree, drop(elsewhere), places(elsewhere, 200, 85));
}

// ---- digest --------------------------------------------------------------------------------------------

template <class Tree>
std::uint64_t digest() {
  std::uint64_t hash = 0;
  Pcg32 random(91);
  const auto whole = [&](int half) {  // made without a rounding, which compilers could fuse away
    const auto one = [&] {
      return static_cast<float>(static_cast<int>(random.below(static_cast<std::uint32_t>(2 * half))) - half) /
             4096;
    };
    const float x = one(), y = one();
    return V{x, y, one()};
  };
  for (const int size : {3, 100, 1000, 6000})
    for (const V centre : {V{}, V{100000, -30000, 70000}}) {
      std::vector<Triangle<float>> triangles;
      for (int i = 0; i < 2000; ++i) {
        const V at = whole(4096) + centre;
        const V a = at + whole(size), b = at + whole(size);
        triangles.push_back({a, b, i % 7 ? at + whole(size) : at});
        if (i % 9 == 0) triangles.back().c = (a + b) * 0.5f + whole(2) * 0.01f;
      }
      std::vector<V> queries;
      for (int i = 0; i < 1000; ++i)
        queries.push_back(i % 3 == 0 ? triangles[static_cast<std::size_t>(i)].b
                                     : whole(i % 3 == 1 ? 4096 : 40000) + centre);
      const Tree tree(triangles);
      for (const bool exact : {false, true}) {
        std::vector<ClosestPoint<double>> out(queries.size());
        tree.template closest_point<double>(queries, {.exact = exact}, out, 1);
        for (const auto& c : out) {
          hash = geometry::hash_u64(hash,
                                    std::uint64_t{c.primitive} << 8 | static_cast<std::uint64_t>(c.feature));
          hash = geometry::hash_u64(hash, std::bit_cast<std::uint64_t>(c.distance2));
          for (const double x : c.point.v) hash = geometry::hash_u64(hash, std::bit_cast<std::uint64_t>(x));
        }
      }
      Work work;
      for (const V& q : queries) (void)tree.closest_point(q, std::numeric_limits<float>::infinity(), work);
      hash = geometry::hash_u64(geometry::hash_u64(hash, work.nodes), work.primitives);
    }
  return hash;
}

}  // namespace
}  // namespace treeline::accel::test

int main(int argc, char** argv) {
  using namespace treeline::accel::test;
  if (argc == 2 && std::string_view(argv[1]) == "--digest") {
    if (runs_here()) std::printf("%016llx\n", static_cast<unsigned long long>(digest<Eight>()));
    return 0;
  }
  testing::InitGoogleTest(&argc, argv);
  if (!runs_here()) return 0;
  return RUN_ALL_TESTS();
}
