// A forest that changes answers like brute force over what is there, through any history of insertions and
// removals.
#include "accel/brute_force/points.hpp"
#include "accel/bvh/wide_points.hpp"
#include "accel/dynamic_points.hpp"
#include "accel/kd_tree/points.hpp"
#include "points_common.hpp"

namespace treeline::accel::test {
namespace {

template <class Tree>
class PointDynamic : public testing::Test {};
using DynamicTrees = testing::Types<KdTree<Points<float, 3>>, Bvh<Points<float, 3>, accel::Wide>,
                                    Bvh<Points<double, 3>, accel::Wide>>;
TYPED_TEST_SUITE(PointDynamic, DynamicTrees);

/// What is alive, in order of id, as brute force sees it.
template <class T>
struct Reference {
  using Found = Neighbor<T>;
  using Brute = BruteForce<Points<T, 3>>;

  Vecs<T, 3> points;  // by id
  std::vector<bool> there;

  template <class Forest>
  void expect_equal(const Forest& forest, geometry::Pcg32& random) const {
    Vecs<T, 3> alive;
    std::vector<Id> ids;
    for (std::size_t i = 0; i < points.size(); ++i)
      if (there[i]) alive.push_back(points[i]), ids.push_back(static_cast<Id>(i));
    ASSERT_EQ(forest.size(), alive.size());
    const Brute brute(alive);
    for (int i = 0; i < 10; ++i) {
      const auto q = uniform_point<T, 3>(random, T(-0.2), T(1.2));
      for (const std::size_t k : {1, 5, 40}) {
        std::vector<Found> got(k), want(k);
        const std::size_t n = forest.nearest(q, k, std::span<Found>(got));
        ASSERT_EQ(n, brute.nearest(q, k, std::span<Found>(want)));
        for (std::size_t j = 0; j < n; ++j) EXPECT_EQ(got[j], (Found{want[j].distance2, ids[want[j].id]}));
      }
      std::vector<Found> got, want;
      forest.within(q, T(0.3), got), brute.within(q, T(0.3), want);
      for (Found& f : want) f.id = ids[f.id];
      std::sort(got.begin(), got.end()), std::sort(want.begin(), want.end());
      EXPECT_EQ(got, want);
      std::vector<Id> in, want_in;
      const geometry::Box<T, 3> box{q - geometry::Vec<T, 3>::filled(T(0.2)),
                                    q + geometry::Vec<T, 3>::filled(T(0.2))};
      forest.inside(box, in), brute.inside(box, want_in);
      for (Id& id : want_in) id = ids[id];
      std::sort(in.begin(), in.end()), std::sort(want_in.begin(), want_in.end());
      EXPECT_EQ(in, want_in);
    }
  }
};

TYPED_TEST(PointDynamic, AnyHistoryEqualsBruteForce) {
  using T = typename TypeParam::Scalar;
  for (const std::uint64_t seed : {1, 2, 3}) {
    geometry::Pcg32 random(seed);
    DynamicPoints<TypeParam> forest({}, {.block = 8});
    Reference<T> reference;
    reference.expect_equal(forest, random);
    for (int step = 0; step < 60; ++step) {
      if (random.uniform() < 0.6) {
        Vecs<T, 3> more(random.below(60));
        for (auto& p : more) p = uniform_point<T, 3>(random);
        if (more.size() > 3) more[1] = more[0];  // ties
        EXPECT_EQ(forest.insert(more), reference.points.size());
        reference.points.insert(reference.points.end(), more.begin(), more.end());
        reference.there.resize(reference.points.size(), true);
      } else {
        for (std::uint32_t i = random.below(40); i > 0 && !reference.points.empty(); --i) {
          const Id id = random.below(static_cast<std::uint32_t>(reference.points.size()));
          EXPECT_EQ(forest.erase(id), reference.there[id]);
          reference.there[id] = false;
        }
      }
      if (step % 6 == 0) reference.expect_equal(forest, random);
    }
    forest.rebuild();
    EXPECT_LE(forest.tree_count(), 1u);
    reference.expect_equal(forest, random);
    for (Id id = 0; id < reference.points.size(); ++id) forest.erase(id);
    EXPECT_EQ(forest.size(), 0u);
    EXPECT_EQ(forest.tree_count(), 0u);
  }
}

// One point at a time: few trees at any moment, and few rebuilds of each point in all.
TYPED_TEST(PointDynamic, TreesAreLogarithmicallyMany) {
  using T = typename TypeParam::Scalar;
  DynamicPoints<TypeParam> forest({}, {.block = 1});
  const auto points = uniform_cloud<T, 3>(1000);
  for (std::size_t i = 0; i < points.size(); ++i) {
    forest.insert(std::span(&points[i], 1));
    ASSERT_LE(std::size_t{1} << (forest.tree_count() - 1), i + 1);
  }
}

TYPED_TEST(PointDynamic, BatchesEqualSingleQueriesAndRefuse) {
  using T = typename TypeParam::Scalar;
  using Found = Neighbor<T>;
  DynamicPoints<TypeParam> forest;
  const auto points = uniform_cloud<T, 3>(3000);
  forest.insert(points);
  forest.insert(uniform_cloud<T, 3>(700, 2));
  const auto queries = uniform_cloud<T, 3>(600, 3);
  std::vector<Found> one(7), batch(7 * queries.size()), two(7 * queries.size());
  forest.nearest(queries, 7, batch, 1), forest.nearest(queries, 7, two, 2);
  EXPECT_EQ(batch, two);
  for (std::size_t i = 0; i < queries.size(); ++i) {
    forest.nearest(queries[i], 7, one);
    for (std::size_t j = 0; j < 7; ++j) EXPECT_EQ(one[j], batch[7 * i + j]);
  }
  const T nan = std::numeric_limits<T>::quiet_NaN();
  const Vecs<T, 3> bad{{0, 0, 0}, {0, nan, 0}};
  EXPECT_THROW(forest.insert(bad), InvalidInput);
  EXPECT_EQ(forest.size(), 3700u);
  EXPECT_THROW(forest.nearest(points[0], 0, one), InvalidInput);
  EXPECT_THROW(forest.nearest(bad[1], 1, one), InvalidInput);
  EXPECT_FALSE(forest.erase(1000000));
  // More than there are: all of them.
  std::vector<Found> all(forest.size());
  EXPECT_EQ(forest.nearest(points[0], static_cast<std::size_t>(-1), all), forest.size());
  for (const Found& f : all) EXPECT_NE(f.id, no_id);
}

// In units in which squared distances vanish, lose digits or overflow, trees rank their own points right; the
// forest must, across its trees. Distances are compared in double, by their ranks.
TYPED_TEST(PointDynamic, RanksAcrossTreesAtEveryScale) {
  using T = typename TypeParam::Scalar;
  const auto points = uniform_cloud<T, 3>(600, 5);
  const auto queries = uniform_cloud<T, 3>(20, 6);
  const std::vector<double> scales = std::is_same_v<T, float>
                                         ? std::vector{1e-25, 3e-21, 1e-19, 1., 1e18, 3e19, 1e30}
                                         : std::vector{1e-200, 3e-162, 1e-150, 1., 1e150, 3e154, 1e200};
  for (const double given : scales) {
    const T scale = static_cast<T>(given);
    Vecs<T, 3> scaled;
    for (const auto& p : points) scaled.push_back(p * scale);
    DynamicPoints<TypeParam> forest({}, {.block = 8});
    for (std::size_t i = 0; i < scaled.size(); i += 7)
      forest.insert(std::span(scaled).subspan(i, std::min<std::size_t>(7, scaled.size() - i)));
    for (Id id = 0; id < 600; id += 5) forest.erase(id);
    ASSERT_GT(forest.tree_count(), 2u);
    for (const auto& query : queries) {
      const geometry::Vec<T, 3> q = query * scale;
      const auto distance = [&](Id id) {
        const geometry::Vec3d d = geometry::Vec3d(scaled[id]) - geometry::Vec3d(q);
        return std::hypot(d[0], d[1], d[2]);
      };
      std::vector<double> right;
      for (Id id = 0; id < 600; ++id)
        if (id % 5 != 0) right.push_back(distance(id));
      std::sort(right.begin(), right.end());
      std::vector<Neighbor<T>> found(8);
      ASSERT_EQ(forest.nearest(q, 8, found), 8u);
      for (std::size_t j = 0; j < 8; ++j) EXPECT_NEAR(distance(found[j].id) / right[j], 1, 1e-6) << scale;
    }
  }
}

// An insertion that is refused leaves everything as it was.
TEST(PointDynamicKd, RefusedInsertionsChangeNothing) {
  KdPointOptions options;
  options.leaf_size = 0;
  DynamicPoints<KdTree<Points<float, 3>>> forest(options);
  EXPECT_THROW(forest.insert(uniform_cloud<float, 3>(10)), InvalidInput);
  EXPECT_EQ(forest.size(), 0u);
  EXPECT_EQ(forest.tree_count(), 0u);
}

}  // namespace
}  // namespace treeline::accel::test
