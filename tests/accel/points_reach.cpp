// Radii lose nobody to rounding: whatever lies within one as real numbers do is found, on every scale, by
// every kind of query that takes one; and an approximate search keeps its promise and loses nobody within a
// largest distance.
#include "accel/brute_force/points.hpp"
#include "accel/bvh/wide_points.hpp"
#include "accel/kd_tree/points.hpp"
#include "points_common.hpp"

namespace treeline::accel::test {
namespace {

template <class T>
class PointReach : public testing::Test {};
using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(PointReach, Scalars);

/// The least T, or the next, that is no less than the true distance.
template <class T>
T rounded_up(Wide distance2) {
  const Wide distance = std::sqrt(distance2) * (1 + 4 * std::numeric_limits<Wide>::epsilon());
  T radius = static_cast<T>(distance);
  if (static_cast<Wide>(radius) < distance)
    radius = std::nextafter(radius, std::numeric_limits<T>::infinity());
  return radius;
}

/// From clouds whose squares vanish, even denormal ones, to such whose squares overflow.
template <class T>
std::vector<T> scales() {
  const int most = std::numeric_limits<T>::max_exponent;
  std::vector<T> all;
  for (const int e : {16 - most, 30 - most, -most / 2 - 3, -most / 2 + 5, -most / 4, 0, most / 4,
                      most / 2 - 2, most / 2 + 3, most - 6})
    all.push_back(std::ldexp(T(1), e));
  return all;
}

template <class Tree, class T>
void expect_all_within(const Tree& tree, const geometry::Vec<T, 3>& q, T radius, const std::set<Id>& sure,
                       const std::set<Id>& allowed, std::size_t n) {
  std::vector<Neighbor<T>> found;
  tree.within(q, radius, found);
  const auto ids = ids_of(found);
  EXPECT_TRUE(std::ranges::includes(ids, sure));
  EXPECT_TRUE(std::ranges::includes(allowed, ids));
  EXPECT_EQ(tree.count_within(q, radius), ids.size());
  tree.within(q, radius, {.sorted = true}, found);
  EXPECT_EQ(ids_of(found), ids);
  for (const double epsilon : {0.0, 0.25, 3.0, 1e9}) {
    std::vector<Neighbor<T>> nearest(n);
    nearest.resize(tree.nearest(q, n, {.max_distance = radius, .epsilon = epsilon}, nearest));
    EXPECT_EQ(ids_of(nearest), ids) << "epsilon " << epsilon;
    // With no room for all of them, as many as there is room for.
    const std::size_t k = std::max<std::size_t>(ids.size(), 2) / 2;
    nearest.assign(k, {});
    EXPECT_EQ(tree.nearest(q, k, {.max_distance = radius, .epsilon = epsilon}, nearest),
              std::min(k, ids.size()));
  }
}

TYPED_TEST(PointReach, EveryPointIsWithinItsOwnDistance) {
  using T = TypeParam;
  for (const T scale : scales<T>()) {
    SCOPED_TRACE(scale);
    auto points = uniform_cloud<T, 3>(150, 3);
    for (auto& p : points) p = p * scale;
    const BruteForce<Points<T, 3>> brute(points);
    const KdTree<Points<T, 3>> kd(points);
    const Bvh<Points<T, 3>, accel::Wide> wide(points);
    geometry::Pcg32 random(4);
    for (int i = 0; i < 12; ++i) {
      const auto q = uniform_point<T, 3>(random, T(-0.5), T(1.5)) * scale;
      for (std::size_t j = 0; j < points.size(); j += 7) {
        const T radius = rounded_up<T>(wide_distance2(points[j], q));
        // Beyond: what a square's D + 2 roundings may hide, half of it twice, and one of the bound.
        const Wide farthest = static_cast<Wide>(radius) * (1 + geometry::tolerance::gamma<T>(6)) +
                              std::numeric_limits<T>::denorm_min();
        std::set<Id> sure, allowed;
        for (Id id = 0; id < points.size(); ++id) {
          const Wide d2 = wide_distance2(points[id], q);
          if (rounded_up<T>(d2) <= radius) sure.insert(id);
          if (d2 <= farthest * farthest) allowed.insert(id);
        }
        ASSERT_TRUE(sure.contains(static_cast<Id>(j)));
        expect_all_within(brute, q, radius, sure, allowed, points.size());
        expect_all_within(kd, q, radius, sure, allowed, points.size());
        expect_all_within(wide, q, radius, sure, allowed, points.size());
        if (this->HasFailure()) return;
      }
    }
  }
}

// As real numbers: distances of what is found, against (1 + epsilon) times the true ones.
TYPED_TEST(PointReach, EpsilonIsKeptAsRealNumbers) {
  using T = TypeParam;
  for (const T scale : scales<T>()) {
    SCOPED_TRACE(scale);
    auto points = uniform_cloud<T, 3>(3000, 5);
    for (std::size_t i = 0; i < points.size(); ++i)
      points[i] = points[i] * (i % 4 == 0 ? scale / 1024 : scale);
    for_each_tree<T, 3>(points, [&](const std::string&, const auto& tree) {
      geometry::Pcg32 random(6);
      for (int i = 0; i < 5; ++i) {
        const auto q = uniform_point<T, 3>(random, T(-0.5), T(1.5)) * scale;
        const auto truth = ranked(points, q);
        for (const double epsilon : {1e-5, 0.1, 1.0, 1e4, 1e12})
          for (const std::size_t k : {1, 9, 130}) {
            std::vector<Neighbor<T>> found(k);
            ASSERT_EQ(tree.nearest(q, k, {.epsilon = epsilon}, found), k);
            std::vector<Wide> squares;
            for (const auto& f : found) squares.push_back(wide_distance2(points[f.id], q));
            for (std::size_t j = 0; j < k; ++j)
              ASSERT_LE(std::sqrt(squares[j]), std::sqrt(truth[j].first) * (1 + static_cast<Wide>(epsilon)))
                  << "rank " << j << " of " << k << ", epsilon " << epsilon;
          }
      }
    });
  }
}

TYPED_TEST(PointReach, AtMostSortsHoweverFewThereAre) {
  using T = TypeParam;
  const auto points = uniform_cloud<T, 3>(300);
  for_each_tree<T, 3>(points, [&](const std::string&, const auto& tree) {
    Work work;
    std::vector<Neighbor<T>> all, some;
    const auto q = geometry::Vec<T, 3>::filled(T(0.5));
    tree.within(q, T(0.4), {.sorted = true}, all, work);
    ASSERT_GT(all.size(), 20u);
    for (const std::size_t at_most : {std::size_t{7}, all.size(), points.size(), points.size() + 1}) {
      tree.within(q, T(0.4), {.at_most = at_most}, some, work);
      ASSERT_EQ(some.size(), std::min(at_most, all.size()));
      EXPECT_TRUE(std::equal(some.begin(), some.end(), all.begin())) << at_most;
    }
  });
}

}  // namespace
}  // namespace treeline::accel::test
