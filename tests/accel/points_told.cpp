// All calls tell the same squared distance for the same query and point, and within_squared compares what is
// told: on clouds whose squares vanish, are denormal or overflow, and for forests whose parts differ.
#include "accel/brute_force/points.hpp"
#include "accel/bsp_tree/points.hpp"
#include "accel/bvh/wide_points.hpp"
#include "accel/dynamic_points.hpp"
#include "accel/kd_tree/points.hpp"
#include "points_common.hpp"

namespace treeline::accel::test {
namespace {

template <class T>
class PointsTold : public testing::Test {};
using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(PointsTold, Scalars);

template <class T>
std::vector<Neighbor<T>> sorted(std::vector<Neighbor<T>> list) {
  std::sort(list.begin(), list.end());
  return list;
}

template <class T, class Index>
void expect_told_alike(const Index& index, const Vecs<T, 3>& points, const geometry::Vec<T, 3>& q) {
  const std::size_t n = points.size();
  std::vector<Neighbor<T>> told(n), found;
  ASSERT_EQ(index.nearest(q, n, told), n);
  // As T rounds the true square, but for D + 2 roundings, or one denormal number on each axis.
  for (const auto& t : told) {
    const Wide true_square = wide_distance2(points[t.id], q);
    if (true_square > static_cast<Wide>(std::numeric_limits<T>::max()) / 2) continue;
    const Wide allowed =
        true_square * (distance2_error<T, 3>)+2 * static_cast<Wide>(std::numeric_limits<T>::denorm_min());
    ASSERT_LE(std::abs(static_cast<Wide>(t.distance2) - true_square), allowed) << "id " << t.id;
  }
  told = sorted(told);
  constexpr T infinity = std::numeric_limits<T>::infinity();
  index.within(q, infinity, found);
  ASSERT_EQ(sorted(found), told);
  index.within(q, infinity, {.sorted = true}, found);
  ASSERT_EQ(sorted(found), told);
  for (std::size_t i = 0; i < n; i += 3) {
    const T square = told[i].distance2;
    auto expected = told;
    std::erase_if(expected, [&](const auto& t) { return t.distance2 > square; });
    index.within_squared(q, square, found);
    ASSERT_EQ(sorted(found), expected) << "within the square " << square;
    if (const T radius = std::sqrt(square) * 2; radius < infinity) {
      std::vector<Neighbor<T>> ranked;
      index.within(q, radius, found), index.within(q, radius, {.sorted = true}, ranked);
      ASSERT_EQ(sorted(found), sorted(ranked)) << "radius " << radius;
      for (const auto& f : found)
        ASSERT_TRUE(std::binary_search(told.begin(), told.end(), f)) << "id " << f.id;
    }
  }
}

/// Runs of points of several exponents, and queries at the origin and at, and beside, points of each.
template <class T>
void expect_all_told_alike(const std::vector<int>& exponents) {
  SCOPED_TRACE(testing::PrintToString(exponents));
  geometry::Pcg32 random(3);
  Vecs<T, 3> points;
  for (std::size_t i = 0; i < 90; ++i)
    points.push_back(uniform_point<T, 3>(random, T(-1), T(1)) *
                     std::ldexp(T(1), exponents[i / 18 % exponents.size()]));
  DynamicPoints<KdTree<Points<T, 3>>> forest({}, {.block = 16, .growth = 1});
  for (const std::size_t from : {0, 40, 65, 82})
    forest.insert(std::span<const geometry::Vec<T, 3>>(points).subspan(from, (from == 0    ? 40
                                                                              : from == 40 ? 65
                                                                              : from == 65 ? 82
                                                                                           : 90) -
                                                                                 from));
  const BruteForce<Points<T, 3>> brute(points);
  const KdTree<Points<T, 3>> kd(points);
  const BspTree<Points<T, 3>> bsp(points);
  const Bvh<Points<T, 3>, accel::Wide> wide(points);
  for (const auto& q : {geometry::Vec<T, 3>{}, points[1], points[20] * T(0.75), points[40]}) {
    const auto check = [&](const char* name, const auto& index) {
      SCOPED_TRACE(name);
      expect_told_alike<T>(index, points, q);
    };
    check("brute", brute), check("kd", kd), check("bsp", bsp), check("wide", wide), check("forest", forest);
    if (testing::Test::HasFatalFailure()) return;
  }
}

TYPED_TEST(PointsTold, AlikeByEveryCall) {
  using T = TypeParam;
  using Limits = std::numeric_limits<T>;
  const int least = Limits::min_exponent - Limits::digits, most = Limits::max_exponent;
  for (const std::vector<int>& exponents :
       {std::vector{0}, std::vector{least / 2}, std::vector{least / 2 + 3, least / 2 + 1},
        std::vector{least / 2 + 5, least / 2 + 12}, std::vector{0, 0, 0, least / 2 + 2},
        std::vector{most / 2 - 8, most / 2 - 9, -30}, std::vector{most / 2 + 2, 0, 0, least / 2 + 6},
        std::vector{most - 3, most / 2, most - 20, 0}}) {
    expect_all_told_alike<T>(exponents);
    if (this->HasFatalFailure()) return;
  }
}

}  // namespace
}  // namespace treeline::accel::test
