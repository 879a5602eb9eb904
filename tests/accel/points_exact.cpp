// Every tree under every option against a brute force written here, in a wider type, on clouds that are hard.
#include <array>

#include "points_common.hpp"

namespace treeline::accel::test {
namespace {

template <class T_, int D_>
struct Config {
  using T = T_;
  static constexpr int D = D_;
};

template <class C>
class PointTrees : public testing::Test {};
using Configs = testing::Types<Config<float, 2>, Config<float, 3>, Config<double, 2>, Config<double, 3>>;
TYPED_TEST_SUITE(PointTrees, Configs);

template <class T, int D>
void expect_nearest(const Vecs<T, D>& points, const geometry::Vec<T, D>& q, std::size_t k,
                    std::span<const Neighbor<T>> found, const std::vector<std::pair<Wide, Id>>& truth) {
  ASSERT_EQ(found.size(), std::min(k, points.size()));
  // Two points may change places if rounding can confuse them: either side of the comparison rounds.
  const Wide error = distance2_error<T, D>;
  const Wide smallest = std::numeric_limits<T>::min();
  std::set<Id> seen;
  for (std::size_t i = 0; i < found.size(); ++i) {
    ASSERT_LT(found[i].id, points.size());
    EXPECT_TRUE(seen.insert(found[i].id).second) << "id " << found[i].id << " twice";
    const Wide exact = wide_distance2(points[found[i].id], q), best = truth[i].first;
    EXPECT_LE(exact, best * (1 + 2 * error + error * error)) << "rank " << i;
    if (exact < static_cast<Wide>(std::numeric_limits<T>::max())) {
      EXPECT_LE(std::abs(static_cast<Wide>(found[i].distance2) - exact), exact * error + smallest)
          << "rank " << i;
    }
    if (i > 0) {
      EXPECT_TRUE(found[i - 1] < found[i] || found[i].distance2 == found[i - 1].distance2);
    }
  }
}

TYPED_TEST(PointTrees, NearestAreThoseOfTheTruth) {
  using T = typename TypeParam::T;
  constexpr int D = TypeParam::D;
  for (const auto& cloud : clouds<T, D>()) {
    SCOPED_TRACE(cloud.name);
    const auto queries = queries_for(cloud.points, 6);
    std::vector<std::vector<std::pair<Wide, Id>>> truths;
    for (const auto& q : queries) truths.push_back(ranked(cloud.points, q));
    for_each_tree<T, D>(cloud.points, [&](const std::string&, const auto& tree) {
      for (const std::size_t k :
           {std::size_t{1}, std::size_t{8}, std::size_t{150}, cloud.points.size() + 5}) {
        std::vector<Neighbor<T>> out(k);
        for (std::size_t i = 0; i < queries.size(); ++i) {
          const std::size_t found = tree.nearest(queries[i], k, out);
          expect_nearest<T, D>(cloud.points, queries[i], k, std::span(out).first(found), truths[i]);
        }
      }
    });
  }
}

// A point so far away that squared distances to it overflow neither disturbs those among the others nor the
// build.
TYPED_TEST(PointTrees, OneFarOutlier) {
  using T = typename TypeParam::T;
  constexpr int D = TypeParam::D;
  auto points = uniform_cloud<T, D>(1500);
  const auto queries = queries_for(points, 10);
  points[700] = geometry::Vec<T, D>::filled(std::ldexp(T(1), std::numeric_limits<T>::max_exponent / 4 * 3));
  for_each_tree<T, D>(points, [&](const std::string&, const auto& tree) {
    EXPECT_TRUE(std::isfinite(tree.stats().sah_cost));
    std::vector<Neighbor<T>> out(points.size());
    for (const auto& q : queries)
      for (const std::size_t k : {std::size_t{1}, std::size_t{20}, points.size()}) {
        ASSERT_EQ(tree.nearest(q, k, out), k);
        expect_nearest<T, D>(points, q, k, std::span(out).first(k), ranked(points, q));
      }
  });
}

// All trees measure distance by one function and break ties by id, so they agree with brute force to the bit.
TYPED_TEST(PointTrees, AgreeToTheBitWithBruteForce) {
  using T = typename TypeParam::T;
  constexpr int D = TypeParam::D;
  for (const auto& cloud : clouds<T, D>())
    for (const int leaf_size : {1, 32}) {
      SCOPED_TRACE(cloud.name + ", leaf size " + std::to_string(leaf_size));
      const auto trees = all_trees<T, D>(cloud.points);
      const auto& brute = *trees.front();
      const auto queries = queries_for(cloud.points, 6);
      const T reach = brute.size() ? length(brute.box().extent() * T(0.125)) : T(1);
      const std::array<std::size_t, 3> counts{1, 10, 120};
      const std::array<T, 3> radii{T(0), reach, std::numeric_limits<T>::infinity()};
      using Found = std::vector<Neighbor<T>>;
      const auto nearest = [](const auto& tree, const auto& q, std::size_t k) {
        Found found(k);
        found.resize(tree.nearest(q, k, found));
        return found;
      };
      const auto within = [](const auto& tree, const auto& q, T radius) {
        Found found;
        tree.within(q, radius, found);
        std::sort(found.begin(), found.end());
        return found;
      };
      std::vector<Found> theirs;  // in the order in which they are asked below
      for (const auto& q : queries) {
        for (const std::size_t k : counts) theirs.push_back(nearest(brute, q, k));
        for (const T radius : radii) theirs.push_back(within(brute, q, radius));
      }
      for (const auto& tree : trees) {
        SCOPED_TRACE(tree->name);
        auto expected = theirs.begin();
        for (const auto& q : queries) {
          for (const std::size_t k : counts) ASSERT_EQ(nearest(*tree, q, k), *expected++);
          for (const T radius : radii) ASSERT_EQ(within(*tree, q, radius), *expected++);
        }
      }
    }
}

// On whole numbers every distance is exact in T, so that ids, ties included, must be those of the truth.
TYPED_TEST(PointTrees, TiesGoToTheLowestId) {
  using T = typename TypeParam::T;
  constexpr int D = TypeParam::D;
  auto points = grid_cloud<T, D>(D == 2 ? 30 : 10);
  const std::size_t distinct = points.size();
  for (std::size_t i = 0; i < distinct / 2; ++i) points.push_back(points[(i * 7919) % distinct]);
  Vecs<T, D> queries;
  for (std::size_t i = 0; i < 60; ++i)
    queries.push_back(points[i] + geometry::Vec<T, D>::filled(T(i % 2) / 2));
  queries.push_back(geometry::Vec<T, D>::filled(T(-4)));
  for_each_tree<T, D>(points, [&](const std::string&, const auto& tree) {
    for (const auto& q : queries) {
      const auto truth = ranked(points, q);
      for (const std::size_t k : {1, 2, 6, 27, 200}) {
        std::vector<Neighbor<T>> out(k);
        ASSERT_EQ(tree.nearest(q, k, out), k);
        for (std::size_t i = 0; i < k; ++i) {
          ASSERT_EQ(out[i].id, truth[i].second) << "rank " << i << " of " << k;
          ASSERT_EQ(static_cast<Wide>(out[i].distance2), truth[i].first);
        }
      }
      for (const T radius : {T(0), T(1), T(2), T(5)}) {  // closed balls: points at exactly the radius are in
        std::vector<Neighbor<T>> out;
        tree.within(q, radius, out);
        std::set<Id> truth_ids;
        for (const auto& [distance2, id] : truth)
          if (distance2 <= static_cast<Wide>(radius) * static_cast<Wide>(radius)) truth_ids.insert(id);
        ASSERT_EQ(ids_of(out), truth_ids) << "radius " << radius;
      }
    }
  });
}

TYPED_TEST(PointTrees, WithinIsTheClosedBall) {
  using T = typename TypeParam::T;
  constexpr int D = TypeParam::D;
  for (const auto& cloud : clouds<T, D>()) {
    SCOPED_TRACE(cloud.name);
    for_each_tree<T, D>(cloud.points, [&](const std::string&, const auto& tree) {
      for (const auto& q : queries_for(cloud.points, 3)) {
        const auto truth = ranked(cloud.points, q);
        for (const std::size_t rank : {0, 5, 100, 1000}) {
          if (rank >= truth.size()) continue;
          const T radius = static_cast<T>(std::sqrt(truth[rank].first));
          if (!std::isfinite(radius)) continue;
          std::vector<Neighbor<T>> out{{T(-1), 12345}};  // what was in the list is replaced
          tree.within(q, radius, out);
          const auto ids = ids_of(out);
          // All of it, as real numbers; and what a squared distance's roundings may hide, twice: in the bound
          // and in what is compared with it.
          const Wide square = static_cast<Wide>(radius) * static_cast<Wide>(radius);
          const Wide error = 2 * geometry::tolerance::gamma<T>(D + 3);
          const Wide smallest = std::numeric_limits<T>::min();
          for (const auto& [distance2, id] : truth) {
            if (distance2 < square * (1 - 8 * std::numeric_limits<Wide>::epsilon())) {
              ASSERT_TRUE(ids.contains(id)) << "missing " << id;
            }
            if (distance2 > square * (1 + error) + smallest) {
              ASSERT_FALSE(ids.contains(id)) << "too far " << id;
            }
          }
        }
        std::vector<Neighbor<T>> out;
        tree.within(q, std::numeric_limits<T>::infinity(), out);
        ASSERT_EQ(out.size(), cloud.points.size());
      }
    });
  }
}

TYPED_TEST(PointTrees, InsideIsTheClosedBox) {
  using T = typename TypeParam::T;
  constexpr int D = TypeParam::D;
  using Box = geometry::Box<T, D>;
  constexpr T infinity = std::numeric_limits<T>::infinity();
  for (const auto& cloud : clouds<T, D>()) {
    SCOPED_TRACE(cloud.name);
    std::vector<Box> boxes{
        Box{}, Box{geometry::Vec<T, D>::filled(-infinity), geometry::Vec<T, D>::filled(infinity)}};
    const auto corners = queries_for(cloud.points, 10);
    for (std::size_t i = 0; i + 1 < corners.size(); ++i) {
      Box box;
      box.grow(corners[i]);
      boxes.push_back(box);  // a single position
      box.grow(corners[i + 1]);
      boxes.push_back(box);
      box.high[0] = infinity;
      boxes.push_back(box);
    }
    std::vector<std::set<Id>> truths;
    for (const auto& box : boxes) {
      truths.emplace_back();
      for (std::size_t i = 0; i < cloud.points.size(); ++i) {
        bool in = true;
        for (int a = 0; a < D; ++a)
          in = in && box.low[a] <= cloud.points[i][a] && cloud.points[i][a] <= box.high[a];
        if (in) truths.back().insert(static_cast<Id>(i));
      }
    }
    for_each_tree<T, D>(cloud.points, [&](const std::string&, const auto& tree) {
      for (std::size_t b = 0; b < boxes.size(); ++b) {
        std::vector<Id> out{12345};
        tree.inside(boxes[b], out);
        ASSERT_EQ(ids_of(out), truths[b]);
      }
    });
  }
}

}  // namespace
}  // namespace treeline::accel::test
