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
    DynamicPoints<TypeParam> forest({}, {.block = 8, .growth = 1});
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

// What is refused is so at once, and changes nothing.
TEST(PointDynamicKd, RefusalsChangeNothing) {
  using Forest = DynamicPoints<KdTree<Points<float, 3>>>;
  KdPointOptions options;
  options.leaf_size = 0;
  EXPECT_THROW(Forest{options}, InvalidInput);
  for (const double growth : {0.5, -1.0, double(NAN), double(INFINITY)})
    EXPECT_THROW(Forest({}, {.growth = growth}), InvalidInput);
  EXPECT_THROW(Forest({}, {.block = 0}), InvalidInput);
  Forest forest;
  for (const std::size_t n : {10, 1000}) {
    auto points = uniform_cloud<float, 3>(n);
    points.back()[1] = NAN;
    EXPECT_THROW(forest.insert(points), InvalidInput);
    EXPECT_EQ(forest.size(), 0u);
    EXPECT_EQ(forest.tree_count(), 0u);
  }
}

static_assert(NeighborIndex<DynamicPoints<KdTree<Points<float, 3>>>>);
static_assert(NeighborIndex<DynamicPoints<Bvh<Points<double, 3>, accel::Wide>>>);

TYPED_TEST(PointDynamic, AnEmptyForestRefusesWhatAFullOneDoes) {
  using T = typename TypeParam::Scalar;
  using Point = geometry::Vec<T, 3>;
  using Box = geometry::Box<T, 3>;
  const T nan = std::numeric_limits<T>::quiet_NaN();
  DynamicPoints<TypeParam> empty, full;
  full.insert(uniform_cloud<T, 3>(1000));
  for (const auto* forest : {&empty, &full}) {
    std::vector<Neighbor<T>> list(8);
    std::vector<Id> ids;
    Lists<Neighbor<T>> lists;
    Lists<Id> id_lists;
    const Point bad{0, nan, 0};
    const std::vector<Point> queries{Point{}, bad};
    const Box bad_box{Point{}, bad};
    const std::vector<Box> boxes{bad_box};
    EXPECT_THROW(forest->nearest(Point{}, 0, list), InvalidInput);
    EXPECT_THROW(forest->nearest(bad, 1, list), InvalidInput);
    EXPECT_THROW(forest->nearest(queries, 1, list), InvalidInput);
    EXPECT_THROW(forest->nearest(queries, 0, list), InvalidInput);
    EXPECT_THROW(forest->nearest(std::span(queries).first(1), 9, list), InvalidInput);
    for (const NearestOptions<T>& options :
         {NearestOptions<T>{.max_distance = -1}, NearestOptions<T>{.max_distance = nan},
          NearestOptions<T>{.epsilon = -1}, NearestOptions<T>{.max_leaves = 0}}) {
      EXPECT_THROW(forest->nearest(Point{}, 1, options, list), InvalidInput);
      EXPECT_THROW(forest->nearest(std::span(queries).first(1), 1, options, list), InvalidInput);
    }
    EXPECT_THROW(forest->within(Point{}, -1, list), InvalidInput);
    EXPECT_THROW(forest->within(bad, 1, list), InvalidInput);
    EXPECT_THROW(forest->within(bad, 1, {.at_most = 1}, list), InvalidInput);
    EXPECT_THROW(forest->within(queries, 1, lists), InvalidInput);
    EXPECT_THROW(forest->within_squared(Point{}, -1, list), InvalidInput);
    EXPECT_THROW(forest->count_within(bad, 1), InvalidInput);
    EXPECT_THROW(forest->inside(bad_box, ids), InvalidInput);
    EXPECT_THROW(forest->inside(boxes, id_lists), InvalidInput);
  }
}

/// In units from those in which squares vanish to those in which they overflow: the same operations, the same
/// answers as brute force over what is there, ids and ties included.
TYPED_TEST(PointDynamic, EveryQueryAtEveryScaleEqualsBruteForce) {
  using T = typename TypeParam::Scalar;
  using Found = Neighbor<T>;
  const std::vector<double> scales = std::is_same_v<T, float>
                                         ? std::vector{1e-25, 3e-21, 1e-19, 1., 1e18, 3e19, 1e25}
                                         : std::vector{1e-200, 3e-162, 1e-150, 1., 1e150, 3e154, 1e200};
  for (std::size_t round = 0; round < scales.size(); ++round) {
    SCOPED_TRACE(scales[round]);
    // A power of two, as the trees scale by: the clouds then differ by nothing else.
    const T scale = std::ldexp(T(1), static_cast<int>(std::lround(std::log2(scales[round]))));
    geometry::Pcg32 random(round + 1);
    DynamicPoints<TypeParam> forest({}, {.block = 16, .growth = round % 2 ? 1.0 : 4.0});
    Vecs<T, 3> points;
    std::vector<bool> there;
    // On a grid every distance is tied.
    const auto place = [&](std::uint32_t steps) {
      geometry::Vec<T, 3> p;
      for (int a = 0; a < 3; ++a)
        p[a] = (round % 3 == 0 ? static_cast<T>(random.below(steps)) : random.uniform(T(0), T(8))) * scale;
      return p;
    };
    for (int step = 0; step < 400; ++step) {
      if (random.below(5) < 3) {
        Vecs<T, 3> more(random.below(step % 20 == 0 ? 80 : 4));
        for (auto& p : more) p = place(8);
        forest.insert(more);
        points.insert(points.end(), more.begin(), more.end());
        there.resize(points.size(), true);
      } else if (!points.empty()) {
        const Id id = random.below(static_cast<std::uint32_t>(points.size()));
        ASSERT_EQ(forest.erase(id), there[id]);
        there[id] = false;
      }
      if (step % 40 != 39) continue;
      Vecs<T, 3> alive;
      std::vector<Id> ids;
      for (Id id = 0; id < points.size(); ++id)
        if (there[id]) alive.push_back(points[id]), ids.push_back(id);
      ASSERT_EQ(forest.size(), alive.size());
      const BruteForce<Points<T, 3>> brute(alive);
      const auto named = [&](std::vector<Found> list) {
        for (Found& f : list)
          if (f.id != no_id) f.id = ids[f.id];
        return list;
      };
      Vecs<T, 3> queries;
      std::vector<geometry::Box<T, 3>> boxes;
      for (int i = 0; i < 8; ++i) {
        queries.push_back(i % 2 && !alive.empty() ? alive[random.below(std::uint32_t(alive.size()))]
                                                  : place(9));
        boxes.emplace_back().grow(queries.back()), boxes.back().grow(place(9));
      }
      const T radius = T(2) * scale;  // on the grid, exactly some distances
      Lists<Found> lists;
      Lists<Id> id_lists;
      forest.within(queries, radius, lists, 2), forest.inside(boxes, id_lists, 2);
      for (const std::size_t k : {1, 6, 50})
        for (const NearestOptions<T>& options :
             {NearestOptions<T>{}, NearestOptions<T>{.max_distance = radius},
              NearestOptions<T>{.max_distance = 0}}) {
          std::vector<Found> batch(k * queries.size());
          forest.nearest(queries, k, options, batch);
          for (std::size_t i = 0; i < queries.size(); ++i) {
            std::vector<Found> mine(k), truth(k);
            const std::size_t n = forest.nearest(queries[i], k, options, mine);
            ASSERT_EQ(n, brute.nearest(queries[i], k, options, truth));
            ASSERT_EQ(mine, named(truth));
            ASSERT_TRUE(std::equal(mine.begin(), mine.end(), batch.begin() + std::ptrdiff_t(i * k)));
          }
        }
      for (std::size_t i = 0; i < queries.size(); ++i) {
        std::vector<Found> mine, truth;
        forest.within(queries[i], radius, {.sorted = true}, mine);
        brute.within(queries[i], radius, {.sorted = true}, truth);
        ASSERT_EQ(mine, named(truth));
        EXPECT_EQ(forest.count_within(queries[i], radius), mine.size());
        std::vector<Found> some, list(lists[i].begin(), lists[i].end());
        forest.within(queries[i], radius, {.at_most = 3}, some);
        EXPECT_TRUE(std::equal(some.begin(), some.end(), mine.begin()));
        EXPECT_EQ(some.size(), std::min<std::size_t>(3, mine.size()));
        EXPECT_EQ(ids_of(list), ids_of(mine));
        if (scale == 1) {
          forest.within_squared(queries[i], T(2), mine), brute.within_squared(queries[i], T(2), truth);
          EXPECT_EQ(ids_of(mine), ids_of(named(truth)));
        }
        std::vector<Id> in, in_list(id_lists[i].begin(), id_lists[i].end());
        forest.inside(boxes[i], in);
        std::set<Id> expected;
        for (std::size_t j = 0; j < alive.size(); ++j)
          if (boxes[i].contains(alive[j])) expected.insert(ids[j]);
        EXPECT_EQ(ids_of(in), expected);
        EXPECT_EQ(ids_of(in_list), expected);
      }
    }
  }
}

TYPED_TEST(PointDynamic, ApproximateSearchesKeepTheirPromiseForLessWork) {
  using T = typename TypeParam::Scalar;
  DynamicPoints<TypeParam> forest({}, {.growth = 1});
  const auto points = uniform_cloud<T, 3>(20000);
  for (std::size_t i = 0; i < points.size(); i += 100) forest.insert(std::span(points).subspan(i, 100));
  for (Id id = 0; id < points.size(); id += 7) forest.erase(id);
  ASSERT_GT(forest.tree_count(), 2u);
  std::uint64_t work_of[3] = {};
  for (const auto& q : uniform_cloud<T, 3>(50, 2)) {
    std::vector<Neighbor<T>> exact(10), found(10);
    Work work[3];
    ASSERT_EQ(forest.nearest(q, 10, exact, work[0]), 10u);
    ASSERT_EQ(forest.nearest(q, 10, {.epsilon = 2}, found, work[1]), 10u);
    for (std::size_t i = 0; i < 10; ++i)
      EXPECT_LE(std::sqrt(wide_distance2(points[found[i].id], q)),
                std::sqrt(Wide(exact[i].distance2)) * 3 * (1 + 2 * distance2_error<T, 3>));
    ASSERT_EQ(forest.nearest(q, 10, {.max_leaves = 1}, found, work[2]), 10u);
    for (std::size_t i = 0; i < 10; ++i) EXPECT_GE(found[i].distance2, exact[i].distance2);
    for (int i = 0; i < 3; ++i) work_of[i] += work[i].primitives;
  }
  EXPECT_LT(work_of[1], work_of[0]);
  EXPECT_LT(work_of[2], work_of[1]);
}

}  // namespace
}  // namespace treeline::accel::test
