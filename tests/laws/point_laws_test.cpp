// Laws of every tree over points: equal to brute force, monotone in k, the same for any thread count and
// batch.
#include <oneapi/tbb/global_control.h>

#include <algorithm>

#include "tests/laws/point_clouds.hpp"
#include "tests/laws/trees.hpp"

namespace treeline::test {
namespace {

using accel::Id;
using accel::Neighbor;
using accel::Points;

template <class Tree>
class PointLaws : public testing::Test {};
TYPED_TEST_SUITE_P(PointLaws);

/// A tree, the points it is over, and brute force beside it.
template <class Tree>
struct Scene {
  using T = typename Tree::Scalar;
  static constexpr int D = Tree::dimension;
  using Point = Vec<T, D>;

  CloudMaker<T, D> make = any_cloud<T, D>();
  std::vector<Point> points = make.points(*rc::gen::inRange<std::size_t>(0, 300));
  Tree tree{points};
  typename PrimitivesOf<Tree>::Brute brute{points};

  std::vector<Neighbor<T>> nearest(const auto& index, const Point& q, std::size_t k) const {
    std::vector<Neighbor<T>> r(std::min(k, points.size()));
    RC_ASSERT(index.nearest(q, k, r) == r.size());
    return r;
  }
  std::vector<Neighbor<T>> within(const auto& index, const Point& q, T radius) const {
    std::vector<Neighbor<T>> r;
    index.within(q, radius, r);
    std::sort(r.begin(), r.end());
    return r;
  }
};

long double exact_distance2(const auto& p, const auto& q) {
  long double s = 0;
  for (int i = 0; i < std::remove_cvref_t<decltype(p)>::dimension; ++i) {
    const long double d = static_cast<long double>(p[i]) - static_cast<long double>(q[i]);
    s += d * d;
  }
  return s;
}

// Brute force itself is held against distances in long double, ids against nothing but being different.
TYPED_TEST_P(PointLaws, NearestAreNearest) {
  const bool ok = rc::check([] {
    Scene<TypeParam> scene;
    using T = typename TypeParam::Scalar;
    const auto q = scene.make.query(scene.points);
    const std::size_t k = *rc::gen::inRange<std::size_t>(1, 40);
    const auto found = scene.nearest(scene.tree, q, k);
    std::vector<long double> truth;
    for (const auto& p : scene.points) truth.push_back(exact_distance2(p, q));
    std::vector<Id> ids;
    // A difference, a square and D - 1 sums: gamma(D + 2) relative, on the found and on the compared
    // distance.
    const long double relative = 2 * tolerance::gamma<T>(TypeParam::dimension + 2);
    for (const auto& n : found) {
      RC_ASSERT(n.id < scene.points.size());
      ids.push_back(n.id);
      const long double slack = relative * truth[n.id] + std::numeric_limits<T>::min();
      RC_ASSERT(std::abs(static_cast<long double>(n.distance2) - truth[n.id]) <= slack);
    }
    std::sort(ids.begin(), ids.end());
    RC_ASSERT(std::adjacent_find(ids.begin(), ids.end()) == ids.end());
    std::sort(truth.begin(), truth.end());
    for (std::size_t i = 0; i < found.size(); ++i) {
      const long double slack = relative * truth[i] + std::numeric_limits<T>::min();
      RC_ASSERT(std::abs(static_cast<long double>(found[i].distance2) - truth[i]) <= slack);
    }
  });
  EXPECT_TRUE(ok);
}

TYPED_TEST_P(PointLaws, EqualBruteForce) {
  const bool ok = rc::check([] {
    Scene<TypeParam> scene;
    using T = typename TypeParam::Scalar;
    const auto q = scene.make.query(scene.points), corner = scene.make.query(scene.points);
    const std::size_t k = *rc::gen::inRange<std::size_t>(1, 330);
    const auto nearest = scene.nearest(scene.brute, q, k);
    RC_ASSERT(scene.nearest(scene.tree, q, k) == nearest);

    const T radius = nearest.empty() ? T(1) : std::sqrt(nearest[nearest.size() / 2].distance2);
    for (T r : {T(0), radius, radius * T(3), std::numeric_limits<T>::infinity()})
      RC_ASSERT(scene.within(scene.tree, q, r) == scene.within(scene.brute, q, r));

    typename TypeParam::Box box;
    box.grow(q), box.grow(corner);
    std::vector<Id> inside, expected;
    scene.tree.inside(box, inside);
    std::sort(inside.begin(), inside.end());
    for (Id i = 0; i < scene.points.size(); ++i)
      if (box.contains(scene.points[i])) expected.push_back(i);
    RC_ASSERT(inside == expected);
  });
  EXPECT_TRUE(ok);
}

// Deep enough that the wide tree has inner nodes below inner nodes, which small clouds do not.
TYPED_TEST_P(PointLaws, EqualBruteForceOnCloudsOfThousands) {
  using T = typename TypeParam::Scalar;
  using Maker = CloudMaker<T, TypeParam::dimension>;
  for (int kind = 0; kind < int(Maker::kinds); ++kind) {
    SCOPED_TRACE(kind);
    Maker make{Pcg32(static_cast<std::uint64_t>(kind) + 1), static_cast<typename Maker::Kind>(kind)};
    const auto points = make.points(5000);
    const TypeParam tree(points);
    const typename PrimitivesOf<TypeParam>::Brute brute(points);
    for (int i = 0; i < 12; ++i) {
      const auto q = make.query(points), corner = make.query(points);
      for (const std::size_t k : {1u, 12u, 30u, 90u, 400u}) {
        std::vector<Neighbor<T>> mine(k), truth(k);
        ASSERT_EQ(tree.nearest(q, k, mine), k);
        brute.nearest(q, k, truth);
        ASSERT_EQ(mine, truth) << "k " << k;
        const T radius = std::sqrt(truth.back().distance2);
        tree.within(q, radius, mine), brute.within(q, radius, truth);
        std::sort(mine.begin(), mine.end()), std::sort(truth.begin(), truth.end());
        ASSERT_EQ(mine, truth) << "radius " << radius;
        ASSERT_EQ(tree.count_within(q, radius), truth.size());
      }
      typename TypeParam::Box box;
      box.grow(q), box.grow(corner);
      std::vector<Id> inside, expected;
      tree.inside(box, inside);
      std::sort(inside.begin(), inside.end());
      for (Id id = 0; id < points.size(); ++id)
        if (box.contains(points[id])) expected.push_back(id);
      ASSERT_EQ(inside, expected);
    }
  }
}

TYPED_TEST_P(PointLaws, TheKthDistanceNeverShrinksAsKGrows) {
  const bool ok = rc::check([] {
    Scene<TypeParam> scene;
    const auto q = scene.make.query(scene.points);
    std::vector<Neighbor<typename TypeParam::Scalar>> before;
    for (std::size_t k = 1; k <= scene.points.size() + 2; k += 1 + k / 3) {
      const auto now = scene.nearest(scene.tree, q, k);
      RC_ASSERT(std::is_sorted(now.begin(), now.end()));
      RC_ASSERT(now.size() >= before.size());
      RC_ASSERT(std::equal(before.begin(), before.end(), now.begin()));
      before = now;
    }
  });
  EXPECT_TRUE(ok);
}

TYPED_TEST_P(PointLaws, AnswersDoNotDependOnThreadsOrBatches) {
  using T = typename TypeParam::Scalar;
  constexpr int D = TypeParam::dimension;
  const tbb::global_control allow(tbb::global_control::max_allowed_parallelism, 8);
  CloudMaker<T, D> make{Pcg32(3), CloudMaker<T, D>::grid};  // full of ties
  auto points = make.points(1000);
  make.kind = CloudMaker<T, D>::even;
  for (const auto& p : make.points(4000)) points.push_back(p);
  const TypeParam tree(points);
  std::vector<Vec<T, D>> queries;
  std::vector<typename TypeParam::Box> boxes;
  for (int i = 0; i < 1500; ++i) {
    queries.push_back(make.query(points));
    boxes.emplace_back().grow(queries.back()), boxes.back().grow(queries.back() + Vec<T, D>::filled(T(0.2)));
  }
  constexpr std::size_t k = 9;
  const T radius = T(0.1);

  std::vector<Neighbor<T>> one_by_one(k * queries.size()), single_list;
  accel::Lists<Neighbor<T>> lists;
  accel::Lists<Id> id_lists;
  for (std::size_t i = 0; i < queries.size(); ++i)
    tree.nearest(queries[i], k, std::span(one_by_one).subspan(i * k, k));
  for (int threads : {1, 2, 3, 8}) {
    std::vector<Neighbor<T>> batch(one_by_one.size());
    tree.nearest(queries, k, batch, threads);
    EXPECT_EQ(batch, one_by_one) << threads;
    for (std::size_t size : {1u, 7u, 256u, 1000u}) {
      std::ranges::fill(batch, Neighbor<T>{});
      for (std::size_t i = 0; i < queries.size(); i += size) {
        const std::size_t n = std::min(size, queries.size() - i);
        tree.nearest(std::span(std::as_const(queries)).subspan(i, n), k,
                     std::span(batch).subspan(i * k, n * k), threads);
      }
      EXPECT_EQ(batch, one_by_one) << threads << " threads, batches of " << size;
    }
    tree.within(queries, radius, lists, threads);
    tree.inside(boxes, id_lists, threads);
    ASSERT_EQ(lists.size(), queries.size());
    ASSERT_EQ(id_lists.size(), queries.size());
    for (std::size_t i = 0; i < queries.size(); i += 13) {
      std::vector<Id> single_ids;
      tree.within(queries[i], radius, single_list);
      tree.inside(boxes[i], single_ids);
      EXPECT_TRUE(std::ranges::equal(lists[i], single_list)) << threads << " " << i;
      EXPECT_TRUE(std::ranges::equal(id_lists[i], single_ids)) << threads << " " << i;
    }
  }
}

REGISTER_TYPED_TEST_SUITE_P(PointLaws, NearestAreNearest, EqualBruteForce, EqualBruteForceOnCloudsOfThousands,
                            TheKthDistanceNeverShrinksAsKGrows, AnswersDoNotDependOnThreadsOrBatches);
using Float3 = Trees<Points<float, 3>>;
using Float2 = Trees<Points<float, 2>>;
using Double3 = Trees<Points<double, 3>>;
INSTANTIATE_TYPED_TEST_SUITE_P(Float3, PointLaws, Float3);
INSTANTIATE_TYPED_TEST_SUITE_P(Float2, PointLaws, Float2);
INSTANTIATE_TYPED_TEST_SUITE_P(Double3, PointLaws, Double3);
using WideFloat =
    testing::Types<accel::Bvh<Points<float, 3>, accel::Wide>, accel::Bvh<Points<float, 2>, accel::Wide>>;
INSTANTIATE_TYPED_TEST_SUITE_P(WideFloat, PointLaws, WideFloat);
using WideDouble =
    testing::Types<accel::Bvh<Points<double, 3>, accel::Wide>, accel::Bvh<Points<double, 2>, accel::Wide>>;
INSTANTIATE_TYPED_TEST_SUITE_P(WideDouble, PointLaws, WideDouble);

/// The same trees with the bounds that are not their default.
template <class P>
struct BoxedKdTree : accel::KdTree<P> {
  explicit BoxedKdTree(std::span<const typename P::Point> points)
      : accel::KdTree<P>(
            points, {{}, accel::KdPointOptions::Split::median, accel::KdPointOptions::Bounds::tight_box}) {}
};
template <class P>
struct BoxedBspTree : accel::BspTree<P> {
  explicit BoxedBspTree(std::span<const typename P::Point> points)
      : accel::BspTree<P>(points, {{}, {}, accel::BspPointOptions::Bounds::box_and_plane}) {}
};
template <class P>
struct BallBvh : accel::Bvh<P> {
  explicit BallBvh(std::span<const typename P::Point> points)
      : accel::Bvh<P>(points,
                      {{}, accel::BvhPointOptions::Split::sah, accel::BvhPointOptions::Bounds::ball}) {}
};
template <class P>
using OtherBounds = testing::Types<BoxedKdTree<P>, BoxedBspTree<P>, BallBvh<P>>;
using OtherBoundsFloat3 = OtherBounds<Points<float, 3>>;
using OtherBoundsDouble2 = OtherBounds<Points<double, 2>>;
INSTANTIATE_TYPED_TEST_SUITE_P(OtherBoundsFloat3, PointLaws, OtherBoundsFloat3);
INSTANTIATE_TYPED_TEST_SUITE_P(OtherBoundsDouble2, PointLaws, OtherBoundsDouble2);

}  // namespace
}  // namespace treeline::test
