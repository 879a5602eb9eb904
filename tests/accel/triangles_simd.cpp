// The filter of eight triangles against the ray tests themselves, once for each instruction set: it keeps all
// that they accept, and little else.
#include "accel/leaf_filter.hpp"
#include "tests/accel/triangles_common.hpp"

namespace treeline::accel::test {
namespace {

template <class T, class RayTest>
struct Case {
  using Scalar = T;
  using Test = RayTest;
};
template <class C>
class LeafFilters : public testing::Test {};
using Cases = testing::Types<Case<float, Watertight>, Case<double, Watertight>, Case<float, MollerTrumbore>,
                             Case<double, MollerTrumbore>>;
TYPED_TEST_SUITE(LeafFilters, Cases);

/// Random triangles, needles, points, and triangles that share corners and edges.
template <class T>
std::vector<StoredTriangle<T>> leaf(std::size_t n, Pcg32& random) {
  std::vector<StoredTriangle<T>> items;
  for (std::size_t i = 0; i < n; ++i) {
    const Vec<T, 3> a = in_cube(random, T(1)), b = a + in_cube(random, T(0.5)),
                    c = a + in_cube(random, T(0.5));
    Triangle<T> t{a, b, c};
    if (i % 5 == 1) t = {a, b, a + (b - a) * T(0.3)};
    if (i % 5 == 2 && i > 0) t = {items[i - 1].triangle.b, items[i - 1].triangle.a, c};
    if (i % 11 == 3) t = {a, a, a};
    items.push_back({t, static_cast<Id>(i)});
  }
  return items;
}

TYPED_TEST(LeafFilters, KeepWhatTheRayTestAccepts) {
  using T = typename TypeParam::Scalar;
  using Test = typename TypeParam::Test;
  Pcg32 random(301);
  constexpr T infinity = std::numeric_limits<T>::infinity();
  std::size_t all = 0, kept = 0, accepted = 0;
  for (int round = 0; round < 3000; ++round) {
    const std::size_t n = 1 + random.below(20);
    const auto items = leaf<T>(n, random);
    std::vector<std::uint32_t> numbers(n);
    for (std::size_t i = 0; i < n; ++i) numbers[i] = static_cast<std::uint32_t>(i);
    TriangleLeaves<T> leaves(n + 2);
    leaves.put(2, items, numbers);  // not at the beginning
    const Triangle<T>& aim = items[random.below(static_cast<std::uint32_t>(n))].triangle;
    Ray<T> ray{in_cube(random, T(2)), in_cube(random, T(1))};
    if (round % 4 == 1) ray.direction = aim.a - ray.origin;
    if (round % 4 == 2) ray.direction = aim.a + (aim.b - aim.a) * random.uniform<T>() - ray.origin;
    if (round % 4 == 3) ray.direction[round % 3] = round % 8 == 3 ? T(0) : -T(0);
    if (ray.direction == Vec<T, 3>{}) continue;
    const typename Test::template Prepared<T> test(ray);
    const LeafFilter<Test, T> filter(ray);
    for (std::size_t begin = 0; begin < n; begin += 8) {
      const std::uint32_t bits = filter(leaves.rows(2) + begin, n);
      for (std::size_t i = begin; i < std::min(n, begin + 8); ++i) {
        const StoredTriangle<T> stored = leaves.get(2, n, i);
        ASSERT_EQ(stored.triangle, items[i].triangle);
        ASSERT_EQ(stored.id, items[i].id);
        const bool keeps = (bits >> (i - begin) & 1) != 0;
        const bool accepts = test(stored.triangle, -infinity, infinity).has_value();
        ASSERT_TRUE(keeps || !accepts) << "round " << round << ", triangle " << i;
        ++all, kept += keeps, accepted += accepts;
      }
    }
  }
  EXPECT_GT(accepted, 500u);
  EXPECT_LT(kept, all / 4);
}

}  // namespace
}  // namespace treeline::accel::test

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
