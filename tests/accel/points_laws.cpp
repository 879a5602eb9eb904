// Laws that need no truth, on clouds that RapidCheck makes up (and shrinks when one breaks).
#include <gtest/gtest.h>

// After gtest, which it needs but does not include.
#include <rapidcheck/gtest.h>

#include "points_common.hpp"

namespace treeline::accel::test {
namespace {

using V = geometry::Vec3f;

/// Few distinct coordinates of very different size, so that ties, lines and gaps come up often.
rc::Gen<V> any_point() {
  const auto coordinate =
      rc::gen::oneOf(rc::gen::map(rc::gen::inRange(-3, 4), [](int i) { return float(i); }),
                     rc::gen::map(rc::gen::inRange(-1000, 1000), [](int i) { return float(i) * 0.001f; }),
                     rc::gen::map(rc::gen::inRange(-40, 30), [](int i) { return std::ldexp(1.f, i); }));
  return rc::gen::map(rc::gen::tuple(coordinate, coordinate, coordinate), [](const auto& t) {
    return V{std::get<0>(t), std::get<1>(t), std::get<2>(t)};
  });
}
rc::Gen<std::vector<V>> any_cloud() { return rc::gen::container<std::vector<V>>(any_point()); }

template <class Check>
void on_all_trees(const std::vector<V>& points, Check&& check) {
  const int leaf_size = *rc::gen::inRange(1, 10);
  for_each_tree<float, 3>(
      points, [&](const std::string&, const auto& tree) { check(tree); }, leaf_size);
}

RC_GTEST_PROP(PointLaws, EveryTreeEqualsBruteForce, ()) {
  const auto points = *any_cloud();
  const V q = *any_point();
  const auto k = static_cast<std::size_t>(*rc::gen::inRange(1, 130));
  const auto trees = all_trees<float, 3>(points);
  const auto& brute = *trees.front();
  std::vector<Neighbor<float>> truth(k), mine(k);
  const std::size_t m = brute.nearest(q, k, truth);
  on_all_trees(points, [&](const auto& tree) {
    RC_ASSERT(tree.nearest(q, k, mine) == m);
    RC_ASSERT(mine == truth);
  });
}

RC_GTEST_PROP(PointLaws, TheKthDistanceNeverShrinksAndPrefixesAgree, ()) {
  const auto points = *any_cloud();
  const V q = *any_point();
  on_all_trees(points, [&](const auto& tree) {
    std::vector<Neighbor<float>> all(points.size()), some(points.size());
    if (points.empty()) return;
    RC_ASSERT(tree.nearest(q, points.size(), all) == points.size());
    RC_ASSERT(std::ranges::is_sorted(all, [](const auto& a, const auto& b) { return a < b; }));
    for (std::size_t k = 1; k <= points.size(); k += 1 + k / 4) {
      tree.nearest(q, k, some);
      RC_ASSERT(std::equal(some.begin(), some.begin() + static_cast<std::ptrdiff_t>(k), all.begin()));
    }
  });
}

// A cloud that such a search once failed on: beside a point at the query, two whose distances differ by less
// than a float can tell, the farther one with the lower id.
TEST(PointLaws, TiesGoToTheLowerIdBesideAPointAtTheQuery) {
  const float tiny = std::ldexp(1.f, -40);
  const std::vector<V> points{{0, -2, -2}, {tiny, tiny, tiny}, {tiny, 0, 0}, {-3, -3, tiny}};
  for_each_tree<float, 3>(
      points,
      [&](const std::string& name, const auto& tree) {
        std::vector<Neighbor<float>> out(4);
        tree.nearest({0, -2, -2}, 4, out);
        EXPECT_EQ(out[0].id, 0u) << name;
        EXPECT_EQ(out[1].id, 1u) << name;
        EXPECT_EQ(out[2].id, 2u) << name;
        EXPECT_EQ(out[1].distance2, out[2].distance2) << name;
      },
      1);
}

RC_GTEST_PROP(PointLaws, APointFindsItself, ()) {
  const auto points = *rc::gen::nonEmpty(any_cloud());
  const auto i = *rc::gen::inRange<std::size_t>(0, points.size());
  on_all_trees(points, [&](const auto& tree) {
    std::vector<Neighbor<float>> out(1);
    tree.nearest(points[i], 1, out);
    RC_ASSERT(out[0].distance2 == 0.f);
    RC_ASSERT(points[out[0].id] == points[i]);
    RC_ASSERT(out[0].id <= i);
    std::vector<Id> ids;
    tree.inside({points[i], points[i]}, ids);
    RC_ASSERT(std::ranges::find(ids, static_cast<Id>(i)) != ids.end());
    tree.within(points[i], 0.f, out);
    RC_ASSERT(std::ranges::any_of(out, [&](const auto& n) { return n.id == i; }));
  });
}

// In exact arithmetic but for long double's own roundings, which these coordinates do not need.
RC_GTEST_PROP(PointLaws, ABallHoldsAllNeighboursWithinItAndNoneBeyondRounding, ()) {
  const auto points = *any_cloud();
  const V q = *any_point();
  // A radius of its own, or that of a point, as rounded up.
  float radius = std::ldexp(1.f, *rc::gen::inRange(-20, 10));
  if (!points.empty() && *rc::gen::inRange(0, 2) == 0) {
    const Wide d = std::sqrt(wide_distance2(points[*rc::gen::inRange<std::size_t>(0, points.size())], q));
    radius = static_cast<float>(d);
    if (static_cast<Wide>(radius) < d)
      radius = std::nextafter(radius, std::numeric_limits<float>::infinity());
  }
  const Wide square = Wide(radius) * Wide(radius);
  on_all_trees(points, [&](const auto& tree) {
    std::vector<Neighbor<float>> ball;
    tree.within(q, radius, ball);
    const auto ids = ids_of(ball);
    for (Id id = 0; id < points.size(); ++id) {
      const Wide distance2 = wide_distance2(points[id], q);
      if (distance2 <= square) RC_ASSERT(ids.contains(id));
      if (distance2 > square * (1 + 3 * distance2_error<float, 3>)) RC_ASSERT(!ids.contains(id));
    }
  });
}

}  // namespace
}  // namespace treeline::accel::test
