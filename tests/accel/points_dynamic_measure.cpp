// A forest answers bit for bit as one tree over the same points does, also where its parts alone would be
// scaled otherwise than all of them are, and where squares vanish or overflow.
#include "accel/brute_force/points.hpp"
#include "accel/bvh/wide_points.hpp"
#include "accel/dynamic_points.hpp"
#include "accel/kd_tree/points.hpp"
#include "points_common.hpp"

namespace treeline::accel::test {
namespace {

template <class Tree>
class PointDynamicMeasure : public testing::Test {};
using DynamicTrees = testing::Types<KdTree<Points<float, 3>>, Bvh<Points<float, 3>, accel::Wide>,
                                    Bvh<Points<double, 3>, accel::Wide>>;
TYPED_TEST_SUITE(PointDynamicMeasure, DynamicTrees);

/// A forest whose parts are runs of the given sizes (the last is loose if it is below 16), beside one tree of
/// the same kind. Sizes fall, so that no run takes in the ones before.
template <class Tree>
struct Pair {
  using T = typename Tree::Scalar;
  using Point = geometry::Vec<T, 3>;
  using Found = Neighbor<T>;

  Vecs<T, 3> points;
  DynamicPoints<Tree> forest{{}, {.block = 16, .growth = 1}};
  std::vector<Id> ids;  // of the forest, for those of the tree
  std::unique_ptr<Tree> tree;

  Pair(const Vecs<T, 3>& all, const std::vector<std::size_t>& sizes, std::size_t removed_of = 0) {
    std::size_t from = 0;
    for (const std::size_t size : sizes) forest.insert(std::span(all).subspan(from, size)), from += size;
    EXPECT_EQ(from, all.size());
    EXPECT_EQ(forest.tree_count(), sizes.size() - (sizes.back() < 16));
    for (Id id = 0; id < all.size(); ++id) {
      if (removed_of > 0 && id % removed_of == 0) {
        EXPECT_TRUE(forest.erase(id));
        continue;
      }
      points.push_back(all[id]), ids.push_back(id);
    }
    tree = std::make_unique<Tree>(std::span<const Point>(points));
  }
  std::vector<Found> named(std::vector<Found> list) const {
    for (Found& f : list) f.id = ids[f.id];
    return list;
  }
  static std::vector<Found> sorted(std::vector<Found> list) {
    std::sort(list.begin(), list.end());
    return list;
  }

  void expect_equal(const Point& q, const std::vector<T>& radii) const {
    const std::size_t n = points.size();
    std::vector<T> distances{std::numeric_limits<T>::infinity()};
    distances.insert(distances.end(), radii.begin(), radii.end());
    for (const T distance : distances)
      for (const std::size_t k : {std::size_t{1}, std::size_t{4}, std::size_t{30}, n}) {
        std::vector<Found> mine(k), theirs(k);
        const NearestOptions<T> options{.max_distance = distance};
        mine.resize(forest.nearest(q, k, options, mine)), theirs.resize(tree->nearest(q, k, options, theirs));
        ASSERT_EQ(mine, named(theirs)) << "k " << k << ", within " << distance;
        std::vector<Found> batch(k);
        forest.nearest(std::span(&q, 1), k, options, batch);
        ASSERT_TRUE(std::equal(mine.begin(), mine.end(), batch.begin()));
        forest.within(q, distance, {.at_most = k}, mine), tree->within(q, distance, {.at_most = k}, theirs);
        ASSERT_EQ(mine, named(theirs)) << "at most " << k << " within " << distance;
      }
    for (const T radius : distances) {
      std::vector<Found> mine, theirs;
      forest.within(q, radius, mine), tree->within(q, radius, theirs);
      ASSERT_EQ(sorted(mine), sorted(named(theirs))) << "radius " << radius;
      ASSERT_EQ(forest.count_within(q, radius), theirs.size());
      forest.within(q, radius, {.sorted = true}, mine), tree->within(q, radius, {.sorted = true}, theirs);
      ASSERT_EQ(mine, named(theirs)) << "radius " << radius;
      forest.within_squared(q, radius * radius, mine), tree->within_squared(q, radius * radius, theirs);
      ASSERT_EQ(sorted(mine), sorted(named(theirs))) << "radius " << radius;
      std::vector<Id> in, their_in;
      const auto side = geometry::Vec<T, 3>::filled(radius);
      forest.inside({q - side, q + side}, in), tree->inside({q - side, q + side}, their_in);
      for (Id& id : their_in) id = ids[id];
      ASSERT_EQ(ids_of(in), ids_of(their_in)) << "half side " << radius;
    }
  }
  /// With radii that are the distances of some points, rounded, where rounding decides.
  void expect_equal_around(const std::vector<T>& more_radii = {}) const {
    for (std::size_t i = 0; i < 10; ++i) {
      SCOPED_TRACE(i);
      Point q = points[i * 37 % points.size()];
      if (i % 3 == 2) q = q * T(1.0625);
      if (i == 8) q = {};
      std::vector<T> radii = more_radii;
      radii.push_back(0);
      for (const std::size_t other : {i + 1, i * 11 + 5, i * 23 + 7})
        if (const Wide d = std::sqrt(wide_distance2(points[other % points.size()], q));
            d <= std::numeric_limits<T>::max())
          radii.push_back(static_cast<T>(d));
      expect_equal(q, radii);
      if (testing::Test::HasFatalFailure()) return;
    }
  }
};

/// Runs of points, each at a scale of its own.
template <class T>
Vecs<T, 3> runs_of(const std::vector<int>& exponents, const std::vector<std::size_t>& sizes,
                   std::uint64_t seed) {
  geometry::Pcg32 random(seed);
  Vecs<T, 3> points;
  for (std::size_t run = 0; run < sizes.size(); ++run) {
    const T scale = std::ldexp(T(1), exponents[run % exponents.size()]);
    for (std::size_t i = 0; i < sizes[run]; ++i)
      points.push_back(i % 9 == 8 ? points[random.below(std::uint32_t(points.size()))]
                                  : uniform_point<T, 3>(random, T(-1), T(1)) * scale);
  }
  return points;
}

TYPED_TEST(PointDynamicMeasure, PartsOfEverySize) {
  using T = typename TypeParam::Scalar;
  constexpr int most = std::numeric_limits<T>::max_exponent;
  for (const std::vector<int>& exponents :
       {std::vector{0, -most / 2, -most / 4}, std::vector{most / 2 + 4, 0, 2},
        std::vector{-most + 30, -most + 45}, std::vector{most - 3, most - 20, -most + 20},
        std::vector{-20, -20, 0, 0, 0}, std::vector{-17, -13, -15}})
    for (const std::size_t removed_of : {0, 3}) {
      SCOPED_TRACE(testing::PrintToString(exponents) + ", removed one of " + std::to_string(removed_of));
      const std::vector<std::size_t> sizes{90, 60, 40, 25, 15};
      Pair<TypeParam> pair(runs_of<T>(exponents, sizes, 3), sizes, removed_of);
      pair.expect_equal_around();
      if (this->HasFatalFailure()) return;
    }
}

// A largest distance whose square overflows though the cloud is ordinary.
TYPED_TEST(PointDynamicMeasure, LargestDistancesWhoseSquaresOverflowOrVanish) {
  using T = typename TypeParam::Scalar;
  constexpr int most = std::numeric_limits<T>::max_exponent;
  Pair<TypeParam> pair(uniform_cloud<T, 3>(330, 7), {200, 100, 20, 10});
  std::vector<T> radii;
  for (const int e :
       {most / 2 - 1, most / 2, most / 2 + 1, most - 2, -most / 2 - 8, -most / 2 + 12, -most + 3})
    radii.push_back(std::ldexp(T(1), e));
  pair.expect_equal_around(radii);
}

// Dust on a plane: of some parts, of all, or of none but the loose points.
TYPED_TEST(PointDynamicMeasure, DustOnAPlane) {
  using T = typename TypeParam::Scalar;
  const bool is_float = std::is_same_v<T, float>;
  for (const T dust : {T(is_float ? 6e-17 : 6e-150), T(1e-10), T(is_float ? 1e-30 : 1e-200)})
    for (const int where : {0, 1, 2}) {
      SCOPED_TRACE(testing::Message() << dust << ", where " << where);
      geometry::Pcg32 random(9);
      Vecs<T, 3> points;
      for (std::size_t i = 0; i < 210; ++i) {
        auto p = uniform_point<T, 3>(random, T(0), T(1));
        if (i % 2) p[0] = points[i / 2][0], p[1] = points[i / 2][1];  // above one another
        p[2] = where == 0 || (where == 1 && i < 120) || (where == 2 && i >= 200)
                   ? dust * static_cast<T>(random.below(2))
                   : T(0);
        if (i % 5 == 0) p = p * dust;
        points.push_back(p);
      }
      Pair<TypeParam> pair(points, {120, 80, 10});
      pair.expect_equal_around({dust / 2, dust, 2 * dust});
      if (this->HasFatalFailure()) return;
    }
}

TYPED_TEST(PointDynamicMeasure, DuplicatesAcrossTreesAndTheLooseBlock) {
  using T = typename TypeParam::Scalar;
  const auto few = uniform_cloud<T, 3>(7, 11);
  Vecs<T, 3> points;
  for (std::size_t i = 0; i < 215; ++i) points.push_back(few[i * 5 % 7]);
  for (const std::size_t removed_of : {0, 2}) {
    Pair<TypeParam> pair(points, {100, 60, 40, 15}, removed_of);
    pair.expect_equal_around({T(0.25)});
  }
}

// One point at a time, so that the measure changes again and again while parts stay.
TYPED_TEST(PointDynamicMeasure, AsTheMeasureChanges) {
  using T = typename TypeParam::Scalar;
  constexpr int most = std::numeric_limits<T>::max_exponent;
  geometry::Pcg32 random(13);
  DynamicPoints<TypeParam> forest({}, {.block = 4, .growth = 1});
  Vecs<T, 3> points;
  std::vector<bool> there;
  for (int step = 0; step < 400; ++step) {
    if (random.below(3) > 0 || points.empty()) {
      const int e = step / 50 % 2 ? -most / 2 : static_cast<int>(random.below(8));
      points.push_back(uniform_point<T, 3>(random, T(-1), T(1)) * std::ldexp(T(1), e));
      there.push_back(true);
      forest.insert(std::span(&points.back(), 1));
    } else {
      const Id id = random.below(std::uint32_t(points.size()));
      EXPECT_EQ(forest.erase(id), there[id]);
      there[id] = false;
    }
    if (step % 9 > 0) continue;
    Vecs<T, 3> alive;
    std::vector<Id> ids;
    for (Id id = 0; id < points.size(); ++id)
      if (there[id]) alive.push_back(points[id]), ids.push_back(id);
    const BruteForce<Points<T, 3>> brute(alive);
    for (const auto& q : {points.back(), points.back() * T(0.75), points.front()})
      for (const std::size_t k : {1, 5, 60}) {
        std::vector<Neighbor<T>> mine(k), theirs(k);
        mine.resize(forest.nearest(q, k, mine)), theirs.resize(brute.nearest(q, k, theirs));
        for (auto& f : theirs) f.id = ids[f.id];
        ASSERT_EQ(mine, theirs) << "step " << step << ", k " << k;
      }
  }
}

}  // namespace
}  // namespace treeline::accel::test
