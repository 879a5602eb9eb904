// Piles of equal points where squared distances vanish or overflow: the lowest ids, as brute force gives
// them, for the work of a few leaves and not of the pile.
#include "points_common.hpp"

namespace treeline::accel::test {
namespace {

template <class T>
class PointPiles : public testing::Test {};
using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(PointPiles, Scalars);

template <class T>
struct PileCase {
  const char* name;
  geometry::Vec<T, 3> at, query;
  T max_distance;
};

template <class T>
std::vector<PileCase<T>> pile_cases() {
  constexpr T none = std::numeric_limits<T>::infinity(), most = std::numeric_limits<T>::max();
  // Its square vanishes beside 1, and that of `far` overflows.
  const T tiny = sizeof(T) == 4 ? T(1e-17) : T(1e-160), far = sizeof(T) == 4 ? T(1e20) : T(1e160);
  return {{"all tiny", {tiny, 0, 0}, {tiny, 0, 0}, none},
          {"tiny beside 1", {1, tiny, 0}, {1, tiny, 0}, none},
          {"a tiny way off", {1, tiny, 0}, {1, 0, 0}, none},
          {"from far", {tiny, 0, 0}, {far, 0, 0}, none},
          {"from farthest", {1, 1, 1}, {most, -most, most}, none},
          {"no distance allowed", {1, 1, 1}, {1, 1, 1}, 0},
          {"no distance allowed, tiny", {tiny, 0, 0}, {tiny, 0, 0}, 0},
          {"a tiny distance allowed", {1, tiny, 0}, {1, 0, 0}, 2 * tiny},
          {"a far distance allowed", {1, tiny, 0}, {far, 0, 0}, 2 * far}};
}

template <class T>
void expect_few(const Vecs<T, 3>& points, const PileCase<T>& c, std::uint64_t leaves) {
  const auto trees = all_trees<T, 3>(points);
  const AnyTree<T, 3>& brute = *trees.front();
  for (const std::size_t k : {1, 8, 100})
    for (std::size_t i = 0; i < trees.size(); ++i) {
      SCOPED_TRACE(trees[i]->name + ", k " + std::to_string(k));
      const NearestOptions<T> options{.max_distance = c.max_distance};
      std::vector<Neighbor<T>> found(k), truth(k), within;
      Work work, work_within;
      ASSERT_EQ(trees[i]->nearest(c.query, k, options, found, work), k);
      brute.nearest(c.query, k, options, truth);
      EXPECT_EQ(found, truth);
      trees[i]->within(c.query, c.max_distance, {.at_most = k}, within, work_within);
      EXPECT_EQ(within, truth);
      if (i == 0) continue;
      // Twice: in T, then in the wider type. A leaf of equal points shows one that is not taken, a wide one
      // all its 16.
      for (const Work& w : {work, work_within}) EXPECT_LE(w.primitives, 2 * leaves * (k + 16));
    }
}

TYPED_TEST(PointPiles, AQueryLooksAtNoMoreThanItTakes) {
  for (const auto& c : pile_cases<TypeParam>()) {
    SCOPED_TRACE(c.name);
    expect_few<TypeParam>(Vecs<TypeParam, 3>(20000, c.at), c, 1);
  }
}

// Two piles, as near as squares in T can tell; odd ids lie in the second.
TYPED_TEST(PointPiles, TwoThatSquaresDoNotTellApart) {
  for (const auto& c : pile_cases<TypeParam>()) {
    SCOPED_TRACE(c.name);
    Vecs<TypeParam, 3> points(20000, c.at);
    for (std::size_t i = 1; i < points.size(); i += 2) points[i] = -c.at;
    if (c.max_distance == 0 || c.at[0] == 1) {
      for (std::size_t i = 1; i < points.size(); i += 2) points[i] = {c.at[0], -c.at[1], c.at[2]};
    }
    expect_few<TypeParam>(points, c, 8);
  }
}

}  // namespace
}  // namespace treeline::accel::test
