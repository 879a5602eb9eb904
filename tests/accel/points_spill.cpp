// The spill tree is approximate, and says how far: what it promises is held against brute force.
#include "accel/brute_force/points.hpp"
#include "accel/bsp_tree/spill_points.hpp"
#include "points_common.hpp"

namespace treeline::accel::test {
namespace {

template <class T_, int D_>
struct Config {
  using T = T_;
  static constexpr int D = D_;
};
template <class C>
class SpillTrees : public testing::Test {};
using Configs = testing::Types<Config<float, 2>, Config<float, 3>, Config<double, 3>>;
TYPED_TEST_SUITE(SpillTrees, Configs);

template <class T, int D>
SpillTree<Points<T, D>> spill(const Vecs<T, D>& points, double tau, int leaf_size = 8) {
  SpillPointOptions options;
  options.tau = tau, options.leaf_size = leaf_size;
  return SpillTree<Points<T, D>>(points, options);
}

// Whatever it misses: k answers, none twice, in order, each at its true distance (as brute force computes
// it).
TYPED_TEST(SpillTrees, AnswersAreNeighboursAtTheirTrueDistance) {
  using T = typename TypeParam::T;
  constexpr int D = TypeParam::D;
  for (const auto& cloud : clouds<T, D>())
    for (const double tau : {0.0, 1.0, 4.0}) {
      SCOPED_TRACE(cloud.name + ", tau " + std::to_string(tau));
      const auto tree = spill(cloud.points, tau);
      const BruteForce<Points<T, D>> brute(cloud.points);
      for (const auto& q : queries_for(cloud.points, 6))
        for (const std::size_t k :
             {std::size_t{1}, std::size_t{8}, std::size_t{150}, cloud.points.size() + 5}) {
          std::vector<Neighbor<T>> mine(k), all(cloud.points.size());
          const std::size_t m = tree.nearest(q, k, mine);
          ASSERT_EQ(m, std::min(k, cloud.points.size()));
          mine.resize(m);
          ids_of(mine);  // none twice
          EXPECT_TRUE(std::ranges::is_sorted(mine, {}, &Neighbor<T>::distance2));
          if (m == 0) continue;
          brute.nearest(q, all.size(), all);
          for (const auto& found : mine) {
            const auto truth = std::ranges::find(all, found.id, &Neighbor<T>::id);
            ASSERT_NE(truth, all.end());
            ASSERT_EQ(found.distance2, truth->distance2);
          }
        }
    }
}

// The theorem: a neighbour within the overlap is never missed.
TYPED_TEST(SpillTrees, NeighboursWithinTheOverlapAreExact) {
  using T = typename TypeParam::T;
  constexpr int D = TypeParam::D;
  std::size_t exact = 0, overlapping = 0;
  for (const auto& cloud : clouds<T, D>())
    for (const double tau : {1.0, 3.0}) {
      SCOPED_TRACE(cloud.name + ", tau " + std::to_string(tau));
      const auto tree = spill(cloud.points, tau);
      const BruteForce<Points<T, D>> brute(cloud.points);
      overlapping += tree.stats().references > cloud.points.size();
      for (const auto& q : queries_for(cloud.points, 10))
        for (const std::size_t k : {1, 2, 8}) {
          if (k > cloud.points.size()) continue;
          std::vector<Neighbor<T>> mine(k), truth(k);
          tree.nearest(q, k, mine), brute.nearest(q, k, truth);
          const Wide farthest = std::sqrt(wide_distance2(cloud.points[truth.back().id], q));
          if (farthest > static_cast<Wide>(tree.overlap())) continue;
          ASSERT_EQ(mine, truth);
          ++exact;
        }
    }
  EXPECT_GT(exact, 300u);  // or this test tested nothing
  EXPECT_GT(overlapping, 8u);
}

template <int D>
struct Tried {
  double recall = 0, tested = 0, references = 0;
};
Tried<3> tried(const Vecs<float, 3>& points, const Vecs<float, 3>& queries, SpillPointOptions options) {
  const SpillTree<Points<float, 3>> tree(points, options);
  const BruteForce<Points<float, 3>> brute(points);
  constexpr std::size_t k = 8;
  Work work;
  std::size_t right = 0;
  std::vector<Neighbor<float>> mine(k), truth(k);
  for (const auto& q : queries) {
    tree.nearest(q, k, mine, work), brute.nearest(q, k, truth);
    for (const auto& n : mine) right += n.distance2 <= truth.back().distance2;
  }
  const auto asked = static_cast<double>(queries.size());
  return {static_cast<double>(right) / (asked * double(k)), static_cast<double>(work.primitives) / asked,
          static_cast<double>(tree.stats().references) / static_cast<double>(points.size())};
}

// More overlap, better recall; backtracking makes up for what is missed.
TEST(Spill, RecallGrowsWithTheOverlap) {
  const auto points = uniform_cloud<float, 3>(20000);
  const auto queries = uniform_cloud<float, 3>(300, 9);
  SpillPointOptions options;
  options.leaf_size = 16;
  Tried<3> before;
  for (const double tau : {0.25, 1.0, 2.0, 3.0}) {
    SCOPED_TRACE(tau);
    options.tau = tau;
    const Tried<3> now = tried(points, queries, options);
    EXPECT_GT(now.recall, before.recall);
    EXPECT_GT(now.references, 1.5);
    before = now;
  }
  EXPECT_GT(before.recall, 0.99);
  options.tau = 0.25;
  const Tried<3> defeatist = tried(points, queries, options);
  EXPECT_LT(defeatist.recall, 0.95);
  options.search = SpillPointOptions::Search::backtracking;
  const Tried<3> backtracking = tried(points, queries, options);
  EXPECT_EQ(backtracking.recall, 1);
  EXPECT_LT(defeatist.tested, backtracking.tested);
}

// Without overlap it is a BSP tree, and exact; with more than a node can bear it is so, too.
TEST(Spill, IsExactWithoutOverlapAndWithTooMuch) {
  const auto points = uniform_cloud<float, 3>(3000);
  for (const double tau : {0.0, 1e6, std::numeric_limits<double>::infinity()}) {
    const auto tree = spill(points, tau);
    EXPECT_EQ(tree.stats().references, points.size());
    const BruteForce<Points<float, 3>> brute(points);
    for (const auto& q : queries_for(points, 20)) {
      std::vector<Neighbor<float>> mine(8), truth(8);
      tree.nearest(q, 8, mine), brute.nearest(q, 8, truth);
      ASSERT_EQ(mine, truth);
    }
  }
}

TEST(Spill, NoSideGetsMoreThanTheBalance) {
  const auto points = uniform_cloud<float, 3>(5000);
  SpillPointOptions options;
  options.leaf_size = 1;
  std::size_t depth = 0;
  for (const double balance : {0.5, 0.7, 0.8}) {
    options.balance = balance;
    const auto stats = SpillTree<Points<float, 3>>(points, options).stats();
    EXPECT_LE(double(stats.depth), 1 + std::log(5000) / -std::log(balance + 1e-9) + 1);
    EXPECT_GE(stats.depth, depth);
    depth = stats.depth;
  }
}

TEST(Spill, RefusesKnobsWithoutSense) {
  const auto points = uniform_cloud<float, 3>(10);
  const auto message = [&](auto set) -> std::string {
    SpillPointOptions options;
    set(options);
    try {
      SpillTree<Points<float, 3>> tree(points, options);
    } catch (const InvalidInput& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_NE(message([](auto& o) { o.tau = -1; }).find("tau is -1"), std::string::npos);
  EXPECT_NE(message([](auto& o) { o.tau = std::nan(""); }).find("tau is "), std::string::npos);
  EXPECT_NE(message([](auto& o) { o.balance = 0.9; }).find("balance is 0.9"), std::string::npos);
  EXPECT_NE(message([](auto& o) { o.balance = 0.4; }).find("balance is 0.4"), std::string::npos);
  EXPECT_NE(message([](auto& o) { o.projections = 0; }).find("projections is 0"), std::string::npos);
}

}  // namespace
}  // namespace treeline::accel::test
