// What limits on a search are for: less work, by counters, while their promises hold. And searches limited by
// distance and number on clouds of every scale, against brute force and against distances in long double.
#include "points_common.hpp"

namespace treeline::accel::test {
namespace {

template <class T>
class PointLimits : public testing::Test {};
using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(PointLimits, Scalars);

constexpr std::uint64_t largest_leaf = 16;  // of the wide trees; the others' hold 8

bool searches(const std::string& tree) { return tree != "brute force"; }

// With a largest distance a search may well find fewer than k; that must not make it look for more leaves
// than it may.
TYPED_TEST(PointLimits, TheLeafLimitEndsASearchThatFindsFewerThanK) {
  using T = TypeParam;
  const auto points = uniform_cloud<T, 3>(5000);
  const auto queries = uniform_cloud<T, 3>(40, 2);
  const T reach = T(0.2);  // some 170 points
  for_each_tree<T, 3>(points, [&](const std::string& name, const auto& tree) {
    if (!searches(name)) return;
    for (const std::size_t leaves : {1, 2, 5})
      for (const std::size_t k : {1, 20, 120, 1000}) {
        std::vector<Neighbor<T>> found(k);
        const NearestOptions<T> options{.max_distance = reach, .max_leaves = leaves};
        for (std::size_t i = 0; i < queries.size(); ++i) {
          Work work;
          const std::size_t n = tree.nearest(queries[i], k, options, found, work);
          EXPECT_LE(work.primitives, leaves * largest_leaf);
          EXPECT_LE(n, work.primitives);
          for (std::size_t j = 0; j < n; ++j)
            EXPECT_LE(wide_distance2(points[found[j].id], queries[i]),
                      Wide(reach) * Wide(reach) * (1 + 4 * distance2_error<T, 3>));
        }
      }
  });
}

TYPED_TEST(PointLimits, EpsilonSavesWorkAndKeepsItsPromise) {
  using T = TypeParam;
  const auto points = uniform_cloud<T, 3>(20000);
  const auto queries = uniform_cloud<T, 3>(60, 2);
  const auto trees = all_trees<T, 3>(points);
  for (const std::size_t k : {1, 10, 60, 150}) {
    std::vector<Neighbor<T>> truth(k * queries.size()), found(k);
    trees.front()->nearest(queries, k, truth, 1);
    for (const auto& tree : trees) {
      if (!searches(tree->name)) continue;
      SCOPED_TRACE(tree->name + ", k " + std::to_string(k));
      std::uint64_t before = std::numeric_limits<std::uint64_t>::max();
      for (const double epsilon : {0.0, 0.5, 2.0}) {
        Work work;
        for (std::size_t i = 0; i < queries.size(); ++i) {
          ASSERT_EQ(tree->nearest(queries[i], k, {.epsilon = epsilon}, found, work), k);
          for (std::size_t j = 0; j < k; ++j)
            EXPECT_LE(std::sqrt(wide_distance2(points[found[j].id], queries[i])),
                      std::sqrt(Wide(truth[i * k + j].distance2)) * (1 + Wide(epsilon)) *
                          (1 + 2 * distance2_error<T, 3>));
        }
        EXPECT_LT(work.primitives * 10, before * 9) << "epsilon " << epsilon;
        before = work.primitives;
      }
    }
  }
}

TYPED_TEST(PointLimits, FewerLeavesAreLessWork) {
  using T = TypeParam;
  const auto points = uniform_cloud<T, 3>(20000);
  const auto queries = uniform_cloud<T, 3>(60, 2);
  constexpr std::size_t k = 10;
  for_each_tree<T, 3>(points, [&](const std::string& name, const auto& tree) {
    if (!searches(name)) return;
    std::vector<Neighbor<T>> found(k);
    std::uint64_t before = 0;
    for (const std::size_t leaves : {1, 3, 9, 100000}) {
      Work work;
      for (const auto& q : queries) {
        Work one;
        ASSERT_EQ(tree.nearest(q, k, {.max_leaves = leaves}, found, one), k);
        // It goes on until there are k, and a leaf may hold but one.
        EXPECT_LE(one.primitives, (leaves + k) * largest_leaf);
        work.primitives += one.primitives, work.nodes += one.nodes;
      }
      // As many as there are leaves that matter: the wide tree's exact search needs fewer than nine.
      if (leaves < 9) {
        EXPECT_GT(work.primitives, before) << leaves;
      } else {
        EXPECT_GE(work.primitives, before) << leaves;
      }
      before = work.primitives;
    }
  });
}

/// Parts of very different size, from coordinates whose squares vanish to such whose squares overflow, many
/// of them equal.
template <class T>
struct Stress {
  static constexpr int most = std::numeric_limits<T>::max_exponent;
  geometry::Pcg32 random;
  std::vector<int> exponents;

  explicit Stress(std::uint64_t seed) : random(seed) {
    const bool wild = seed % 2 == 1;
    for (std::uint32_t i = 1 + random.below(4); i > 0; --i)
      exponents.push_back((static_cast<int>(random.below(2 * most - 60)) - most + 40) / (wild ? 1 : 4));
  }
  T coordinate() {
    const int e = exponents[random.below(static_cast<std::uint32_t>(exponents.size()))];
    const T m = random.below(3) ? random.uniform(T(-1), T(1)) : static_cast<T>(random.below(5)) - T(2);
    return std::ldexp(m, e);
  }
  geometry::Vec<T, 3> point() {
    geometry::Vec<T, 3> p;
    for (int a = 0; a < 3; ++a) p[a] = coordinate();
    return p;
  }
  Vecs<T, 3> cloud(std::size_t n) {
    Vecs<T, 3> points;
    for (std::size_t i = 0; i < n; ++i)
      points.push_back(i > 0 && random.below(4) == 0 ? points[random.below(static_cast<std::uint32_t>(i))]
                                                     : point());
    return points;
  }
};

TYPED_TEST(PointLimits, DistanceAndNumberOnEveryScale) {
  using T = TypeParam;
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    Stress<T> stress(seed);
    const auto points = stress.cloud(1 + stress.random.below(seed % 10 == 0 ? 3000 : 200));
    const auto pick = [&] { return points[stress.random.below(static_cast<std::uint32_t>(points.size()))]; };
    const auto trees = all_trees<T, 3>(points);
    for (int i = 0; i < 8; ++i) {
      SCOPED_TRACE("seed " + std::to_string(seed) + ", query " + std::to_string(i));
      const auto q = i % 2 ? pick() : stress.point();
      // At a point's own distance, where rounding decides, or at none.
      const Wide at = i % 4 == 3 ? 0 : std::sqrt(wide_distance2(pick(), q));
      if (at > std::numeric_limits<T>::max()) continue;
      const T reach = static_cast<T>(at);
      const std::size_t k = std::min<std::size_t>(1 + stress.random.below(i < 4 ? 12 : 150), points.size());
      std::vector<Neighbor<T>> truth(k), found, within;
      truth.resize(trees.front()->nearest(q, k, {.max_distance = reach}, truth));
      for (const auto& tree : trees) {
        SCOPED_TRACE(tree->name);
        Work work;
        found.assign(k, {});
        found.resize(tree->nearest(q, k, {.max_distance = reach}, found, work));
        ASSERT_EQ(found, truth);
        tree->within(q, reach, {.sorted = true, .at_most = k}, within, work);
        ASSERT_EQ(within, truth);
      }
      // Nothing beyond by more than rounding, and nothing within left out.
      const Wide error = 2 * geometry::tolerance::gamma<T>(3 + 3);
      const Wide square = Wide(reach) * Wide(reach), least = std::numeric_limits<T>::denorm_min();
      const auto all = ranked(points, q);
      const auto inside = static_cast<std::size_t>(std::count_if(all.begin(), all.end(), [&](const auto& p) {
        return p.first < square * (1 - 8 * std::numeric_limits<Wide>::epsilon());
      }));
      EXPECT_GE(truth.size(), std::min(k, inside));
      for (std::size_t j = 0; j < truth.size(); ++j) {
        const Wide exact = wide_distance2(points[truth[j].id], q);
        EXPECT_LE(exact, square * (1 + error) + least * least);
        EXPECT_LE(exact, all[j].first * (1 + 3 * error));
      }
    }
  }
}

}  // namespace
}  // namespace treeline::accel::test
