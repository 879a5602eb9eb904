// Searches with limits: what is promised of max_distance, epsilon, max_leaves, counts and sorted lists holds
// for every tree. Expected answers come from an exhaustive list ranked in long double (points_common.hpp).
#include <set>

#include "accel/brute_force/points.hpp"
#include "accel/bsp_tree/points.hpp"
#include "accel/bvh/points.hpp"
#include "accel/bvh/wide_points.hpp"
#include "accel/kd_tree/points.hpp"
#include "points_common.hpp"

namespace treeline::accel::test {
namespace {

template <class Tree>
class PointOptions : public testing::Test {};
using F3 = Points<float, 3>;
using D3 = Points<double, 3>;
using AllTrees = testing::Types<BruteForce<F3>, KdTree<F3>, BspTree<F3>, Bvh<F3>, Bvh<F3, accel::Wide>,
                                BruteForce<D3>, Bvh<D3, accel::Wide>>;
TYPED_TEST_SUITE(PointOptions, AllTrees);

template <class T>
inline constexpr double rounding = sizeof(T) == 4 ? 1e-6 : 1e-14;

// Clouds whose distances float can tell apart; the others are ranked in a wider type, see the exact tests.
template <class T>
std::vector<NamedCloud<T, 3>> ordinary_clouds() {
  std::vector<NamedCloud<T, 3>> all;
  for (auto& c : clouds<T, 3>())
    for (const char* name : {"first 0", "first 1", "first 9", "uniform", "few distinct", "all equal",
                             "axis line", "grid", "long box", "one far away", "tiny", "huge"})
      if (c.name == name) all.push_back(std::move(c));
  return all;
}

TYPED_TEST(PointOptions, NothingBeyondTheMaximalDistance) {
  using T = typename TypeParam::Scalar;
  for (const auto& cloud : ordinary_clouds<T>()) {
    SCOPED_TRACE(cloud.name);
    const TypeParam tree(cloud.points);
    for (const auto& q : queries_for<T, 3>(cloud.points)) {
      std::vector<Neighbor<T>> all(20), near(20);
      const std::size_t n = tree.nearest(q, 20, all);
      for (const std::size_t i : {std::size_t{0}, n / 2, n}) {
        // Between two distances, so that no rounding decides.
        const double from = i > 0 ? std::sqrt(double(all[i - 1].distance2)) : 0;
        const double to = i < n ? std::sqrt(double(all[i].distance2)) : from * 2;
        if (!(to > from * 1.001) || !(to < std::sqrt(double(std::numeric_limits<T>::max())))) continue;
        const auto radius = static_cast<T>((from + to) / 2);
        const std::size_t found = tree.nearest(q, 20, NearestOptions<T>{.max_distance = radius}, near);
        if (i == n && n == 20) continue;
        ASSERT_EQ(found, i);
        for (std::size_t j = 0; j < found; ++j) EXPECT_EQ(near[j], all[j]);
      }
    }
  }
}

TYPED_TEST(PointOptions, EpsilonBoundsEachDistance) {
  using T = typename TypeParam::Scalar;
  for (const auto& cloud : ordinary_clouds<T>()) {
    SCOPED_TRACE(cloud.name);
    const TypeParam tree(cloud.points);
    for (const auto& q : queries_for<T, 3>(cloud.points)) {
      const auto truth = ranked<T, 3>(cloud.points, q);
      for (const std::size_t k : {1, 8, 40})
        for (const double epsilon : {0.1, 1.0, 10.0, 1e30}) {
          std::vector<Neighbor<T>> found(k);
          const std::size_t n = tree.nearest(q, k, NearestOptions<T>{.epsilon = epsilon}, found);
          ASSERT_EQ(n, std::min(k, cloud.points.size()));
          std::set<Id> ids;
          for (std::size_t i = 0; i < n; ++i) {
            EXPECT_TRUE(ids.insert(found[i].id).second);
            const double distance = std::sqrt(double(wide_distance2<T, 3>(cloud.points[found[i].id], q)));
            EXPECT_LE(distance, std::sqrt(double(truth[i].first)) * (1 + epsilon) * (1 + rounding<T>));
          }
        }
    }
  }
}

TYPED_TEST(PointOptions, MoreLeavesAreNeverWorseAndEnoughAreExact) {
  using T = typename TypeParam::Scalar;
  for (const auto& cloud : ordinary_clouds<T>()) {
    SCOPED_TRACE(cloud.name);
    const TypeParam tree(cloud.points);
    for (const auto& q : queries_for<T, 3>(cloud.points, 3)) {
      std::vector<Neighbor<T>> exact(8), found(8);
      const std::size_t n = tree.nearest(q, 8, exact);
      T last = std::numeric_limits<T>::infinity();
      for (const std::size_t leaves : {1, 2, 4, 16, 100000}) {
        const std::size_t m = tree.nearest(q, 8, NearestOptions<T>{.max_leaves = leaves}, found);
        ASSERT_EQ(m, n);
        const T worst = n > 0 ? found[n - 1].distance2 : 0;
        EXPECT_LE(worst, last);
        last = worst;
        for (std::size_t i = 0; i < m; ++i) EXPECT_GE(found[i].distance2, exact[i].distance2);
        if (leaves == 100000) {
          for (std::size_t i = 0; i < m; ++i) EXPECT_EQ(found[i], exact[i]);
        }
      }
    }
  }
}

TYPED_TEST(PointOptions, BatchesAnswerAsSingleQueriesDo) {
  using T = typename TypeParam::Scalar;
  for (const auto& cloud : ordinary_clouds<T>()) {
    SCOPED_TRACE(cloud.name);
    const TypeParam tree(cloud.points);
    const auto queries = queries_for<T, 3>(cloud.points);
    for (const NearestOptions<T>& options :
         {NearestOptions<T>{.max_distance = T(0.05)}, NearestOptions<T>{.epsilon = 0.5},
          NearestOptions<T>{.max_leaves = 2}, NearestOptions<T>{.max_distance = T(0.3), .max_leaves = 2}}) {
      std::vector<Neighbor<T>> batch(queries.size() * 6), one(6);
      tree.nearest(queries, 6, options, batch, 2);
      for (std::size_t i = 0; i < queries.size(); ++i) {
        one.assign(6, {});
        tree.nearest(queries[i], 6, options, one);
        for (std::size_t j = 0; j < 6; ++j) EXPECT_EQ(batch[6 * i + j], one[j]);
      }
    }
  }
}

TYPED_TEST(PointOptions, ListsCountsAndSquaredRadiiAgree) {
  using T = typename TypeParam::Scalar;
  for (const auto& cloud : ordinary_clouds<T>()) {
    SCOPED_TRACE(cloud.name);
    const TypeParam tree(cloud.points);
    for (const auto& q : queries_for<T, 3>(cloud.points, 3)) {
      std::vector<Neighbor<T>> ten(10), all, some;
      const std::size_t n = tree.nearest(q, 10, ten);
      const T radius = n > 0 ? std::sqrt(ten[n - 1].distance2) : T(1);
      tree.within(q, radius, WithinOptions{.sorted = true}, all);
      // Where the square vanishes or overflows, the true distance ranks, and no id.
      EXPECT_TRUE(std::is_sorted(all.begin(), all.end(), [](const auto& a, const auto& b) {
        return a.distance2 < b.distance2 ||
               (std::isnormal(a.distance2) && a.distance2 == b.distance2 && a.id < b.id);
      }));
      EXPECT_EQ(tree.count_within(q, radius), all.size());
      tree.within(q, radius, WithinOptions{.at_most = 3}, some);
      ASSERT_EQ(some.size(), std::min<std::size_t>(3, all.size()));
      for (std::size_t i = 0; i < some.size(); ++i) EXPECT_EQ(some[i], all[i]);
      // A square that float cannot hold in full bounds nothing.
      if (n == 0 || !std::isnormal(ten[n - 1].distance2)) continue;
      tree.within_squared(q, ten[n - 1].distance2, some);  // inclusive: the tenth itself is in
      EXPECT_GE(some.size(), n);
      for (const Neighbor<T>& f : some) EXPECT_LE(f.distance2, ten[n - 1].distance2);
    }
    EXPECT_EQ(tree.count_within({}, std::numeric_limits<T>::infinity()), cloud.points.size());
  }
}

// Each point's own neighbours are those of a query at it, itself left out.
TYPED_TEST(PointOptions, NeighboursOfAllLeaveThePointItselfOut) {
  using T = typename TypeParam::Scalar;
  for (const auto& cloud : ordinary_clouds<T>())
    for (const int threads : {1, 2}) {
      SCOPED_TRACE(cloud.name);
      const TypeParam tree(cloud.points);
      for (const std::size_t k : {1, 6}) {
        std::vector<Neighbor<T>> all(k * cloud.points.size()), row(k + 1);
        tree.nearest_of_all(k, all, threads);
        for (std::size_t i = 0; i < cloud.points.size(); ++i) {
          const std::size_t n = tree.nearest(cloud.points[i], k + 1, row);
          std::vector<Neighbor<T>> others;
          for (std::size_t j = 0; j < n; ++j)
            if (row[j].id != i) others.push_back(row[j]);
          others.resize(k);  // k + 1 equal points of lower id: the last is one too many
          for (std::size_t j = 0; j < k; ++j) ASSERT_EQ(all[i * k + j], others[j]) << i;
        }
      }
    }
  const TypeParam tree(uniform_cloud<T, 3>(10));
  std::vector<Neighbor<T>> small(9);
  EXPECT_THROW(tree.nearest_of_all(1, small), InvalidInput);
}

TYPED_TEST(PointOptions, SenselessLimitsAreRefused) {
  using T = typename TypeParam::Scalar;
  const TypeParam tree(uniform_cloud<T, 3>(50));
  std::vector<Neighbor<T>> out(3);
  const T nan = std::numeric_limits<T>::quiet_NaN();
  for (const NearestOptions<T>& options :
       {NearestOptions<T>{.max_distance = -1}, NearestOptions<T>{.max_distance = nan},
        NearestOptions<T>{.epsilon = -0.1}, NearestOptions<T>{.epsilon = double(nan)},
        NearestOptions<T>{.max_leaves = 0}}) {
    EXPECT_THROW(tree.nearest(geometry::Vec<T, 3>{}, 3, options, out), InvalidInput);
    EXPECT_THROW(tree.nearest(std::span<const geometry::Vec<T, 3>>{}, 3, options, out), InvalidInput);
  }
  std::vector<Neighbor<T>> list;
  EXPECT_THROW(tree.count_within({}, -1), InvalidInput);
  EXPECT_THROW(tree.within_squared({}, -1, list), InvalidInput);
}

// In units in which squared distances vanish or overflow, the nearest within a radius are still the nearest.
// The ids say how far a point is: point i lies (100 - i) units from the query.
TYPED_TEST(PointOptions, TheNearestWithinARadiusAtEveryScale) {
  using T = typename TypeParam::Scalar;
  const std::vector<double> scales = sizeof(T) == 4 ? std::vector{1e-25, 1e-22, 1e-12, 1., 1e15, 1e18, 1e25}
                                                    : std::vector{1e-200, 1e-160, 1e-100, 1., 1e150, 1e200};
  for (const double scale : scales) {
    Vecs<T, 3> points;
    for (int i = 0; i < 100; ++i) points.push_back({static_cast<T>((100 - i) * scale), T(0), T(0)});
    Vecs<T, 3> mixed = points;  // amid others of ordinary size
    for (int i = 0; i < 200; ++i) mixed.push_back({T(1) + T(i), T(2), T(3)});
    const geometry::Vec<T, 3> query{};
    const T radius = static_cast<T>(60.5 * scale);
    for (const auto& cloud : {points, scale < 1e-2 ? mixed : points}) {
      SCOPED_TRACE(std::to_string(scale) + ", " + std::to_string(cloud.size()) + " points");
      const TypeParam tree(cloud);
      std::vector<Neighbor<T>> list;
      tree.within(query, radius, {.sorted = true}, list);
      ASSERT_EQ(list.size(), 60u);
      for (std::size_t i = 0; i < list.size(); ++i) EXPECT_EQ(list[i].id, 99 - i);
      tree.within(query, radius, {.at_most = 3}, list);
      ASSERT_EQ(list.size(), 3u);
      for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(list[i].id, 99 - i);
      ASSERT_EQ(tree.nearest(query, 3, NearestOptions<T>{.max_distance = radius}, list), 3u);
      for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(list[i].id, 99 - i);
    }
  }
}

}  // namespace
}  // namespace treeline::accel::test
