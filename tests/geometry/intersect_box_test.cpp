// The slab test against exact rational slabs: never shorter than the truth, and not much longer.
#include "geometry/intersect_box.hpp"

#include <gtest/gtest.h>

#include "tests/geometry/meshes.hpp"
#include "tests/geometry/witness.hpp"

namespace treeline::test {
namespace {

template <class T>
class RayBox : public testing::Test {};
using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(RayBox, Scalars);

template <class T>
struct Random {
  Pcg32 bits;

  /// Directions with components that break slab tests among ordinary ones.
  T component() {
    using L = std::numeric_limits<T>;
    const T awkward[] = {T(0),     -T(0),     L::denorm_min(), -L::denorm_min(), 100 * L::denorm_min(),
                         L::min(), -L::min(), L::epsilon(),    -L::epsilon(),    T(1),
                         T(-1)};
    return bits.below(2) ? awkward[bits.below(std::size(awkward))] : bits.uniform<T>(-1, 1);
  }
  Vec<T, 3> direction() {
    for (;;) {
      const Vec<T, 3> d{component(), component(), component()};
      if (d != Vec<T, 3>{}) return d;
    }
  }
  /// Boxes from flat to long, at several distances from the origin.
  Box<T, 3> box() {
    const T far = std::pow(T(10), T(bits.below(6))) - T(1);
    Box<T, 3> b;
    b.grow(random_vec<T>(bits) * far);
    Vec<T, 3> extent = random_vec<T>(bits, 0, 2);
    for (int k = 0; k < 3; ++k) extent[k] *= bits.below(4) ? std::pow(T(10), -T(bits.below(8))) : T(0);
    b.grow(b.low + extent);
    return b;
  }
  /// Origins in the box's planes, on its edges and corners, inside, and anywhere.
  Vec<T, 3> origin(const Box<T, 3>& b) {
    Vec<T, 3> o;
    for (int k = 0; k < 3; ++k) {
      const T r[] = {b.low[k], b.high[k], b.low[k] + (b.high[k] - b.low[k]) * bits.uniform<T>(),
                     b.low[k] + bits.uniform<T>(-3, 3)};
      o[k] = r[bits.below(4)];
    }
    return o;
  }
  /// Rays from there in any direction, or aimed at a point of the box or its boundary.
  Ray<T> ray(const Box<T, 3>& b) {
    Ray<T> r{origin(b), direction()};
    if (bits.below(2)) {
      const Vec<T, 3> aim = origin(b) - r.origin;
      if (aim != Vec<T, 3>{}) r.direction = aim;
    }
    return r;
  }
};

TYPED_TEST(RayBox, NeverShorterThanTheExactInterval) {
  using T = TypeParam;
  Random<T> random{Pcg32(1)};
  int touched = 0, missed = 0, said_yes_when_missed = 0;
  for (int n = 0; n < 40000; ++n) {
    const Box<T, 3> box = random.box();
    Ray<T> ray = random.ray(box);
    ray.t_max = n % 2 ? T(1) : std::numeric_limits<T>::max();
    const auto exact = witness_slabs(ray, box);
    T enter = -1, exit = -1;
    const bool yes = BoxTest<T>(ray)(box, ray.t_min, ray.t_max, enter, exit);
    if (exact) {
      ++touched;
      ASSERT_TRUE(yes) << n;
      ASSERT_LE(Rational(enter), exact->first) << n;
      if (std::isfinite(exit)) {
        ASSERT_GE(Rational(exit), exact->second) << n;
      }
      ASSERT_GE(enter, ray.t_min);
      ASSERT_LE(exit, ray.t_max);
    } else {
      ++missed;
      said_yes_when_missed += yes;
      if (!yes) continue;
      // A "yes" beside the truth is allowed within the padding, twice over for what the padding itself
      // rounds.
      const int z = largest_axis(ray.direction);
      const auto reach = [&](int k) {
        return std::max(std::abs(box.low[k] - ray.origin[k]), std::abs(box.high[k] - ray.origin[k]));
      };
      Box<T, 3> wide = box;
      for (int k = 0; k < 3; ++k) {
        const T slack =
            2 * tolerance::slab_padding<T> * (reach(k) + reach(z)) + std::numeric_limits<T>::min() * 4;
        wide.low[k] = std::nextafter(box.low[k] - slack, T(-INFINITY));
        wide.high[k] = std::nextafter(box.high[k] + slack, T(INFINITY));
      }
      ray.t_min -= std::numeric_limits<T>::epsilon(),
          ray.t_max *= 1 - (n % 2 ? -4 : 4) * std::numeric_limits<T>::epsilon();
      ASSERT_TRUE(witness_slabs(ray, wide)) << n;
    }
  }
  EXPECT_GT(touched, 5000);
  EXPECT_GT(missed, 5000);
  EXPECT_LT(said_yes_when_missed, missed / 10);
}

TYPED_TEST(RayBox, MonotoneInTheBox) {
  using T = TypeParam;
  Random<T> random{Pcg32(2)};
  for (int n = 0; n < 100000; ++n) {
    const Box<T, 3> inner = random.box();
    const Ray<T> ray = random.ray(inner);
    Box<T, 3> outer = inner;
    for (int i = random.bits.below(3); i >= 0; --i) outer.grow(random.origin(inner));
    if (random.bits.below(2)) outer.grow(random.box());
    T enter, exit, outer_enter, outer_exit;
    const BoxTest<T> test(ray);
    if (!test(inner, ray.t_min, ray.t_max, enter, exit)) continue;
    ASSERT_TRUE(test(outer, ray.t_min, ray.t_max, outer_enter, outer_exit)) << n;
    ASSERT_LE(outer_enter, enter) << n;
    ASSERT_GE(outer_exit, exit) << n;
  }
}

TYPED_TEST(RayBox, RaysInFacePlanesAndAlongEdges) {
  using T = TypeParam;
  const Box<T, 3> box{{1, 1, 1}, {2, 3, 4}};
  for (T zero : {T(0), -T(0)})
    for (int axis = 0; axis < 3; ++axis)
      for (int corner = 0; corner < 4; ++corner)
        for (T sign : {T(1), T(-1)}) {
          const int p = (axis + 1) % 3, q = (axis + 2) % 3;
          Ray<T> ray{{}, Vec<T, 3>::filled(zero)};
          ray.origin[p] = corner & 1 ? box.low[p] : box.high[p];
          ray.origin[q] = corner & 2 ? box.low[q] : box.high[q];
          ray.origin[axis] = sign > 0 ? T(0) : T(5);
          ray.direction[axis] = sign;
          T enter, exit;
          ASSERT_TRUE(BoxTest<T>(ray)(box, ray.t_min, ray.t_max, enter, exit));
          const T first = sign > 0 ? box.low[axis] : T(5) - box.high[axis];
          EXPECT_LE(enter, first);
          EXPECT_GE(enter, first - T(100) * tolerance::slab_padding<T>);
          ray.origin[p] += corner & 1 ? T(-0.01) : T(0.01);
          EXPECT_FALSE(BoxTest<T>(ray)(box, ray.t_min, ray.t_max, enter, exit));
        }
}

TYPED_TEST(RayBox, EmptyInfiniteAndNaN) {
  using T = TypeParam;
  const T inf = std::numeric_limits<T>::infinity(), nan = std::numeric_limits<T>::quiet_NaN();
  const Ray<T> ray{{1, 2, 3}, {0, T(-0.0), 1}};
  T enter, exit;
  EXPECT_FALSE(BoxTest<T>(ray)(Box<T, 3>{}, 0, inf, enter, exit));
  EXPECT_FALSE(BoxTest<T>(ray)({{nan, 0, 0}, {9, 9, 9}}, 0, inf, enter, exit));
  EXPECT_FALSE(BoxTest<T>(ray)({{0, 0, 0}, {9, nan, 9}}, 0, inf, enter, exit));
  EXPECT_TRUE(BoxTest<T>(ray)({{-inf, -inf, -inf}, {inf, inf, inf}}, 0, inf, enter, exit));
  EXPECT_LE(enter, T(0));
  EXPECT_EQ(exit, inf);
  EXPECT_TRUE(BoxTest<T>(ray)({{1, 2, 3}, {1, 2, 3}}, 0, inf, enter, exit)) << "a box that is the origin";
  const T big = std::numeric_limits<T>::max();
  EXPECT_TRUE(BoxTest<T>(ray)({{-big, -big, -big}, {big, big, big}}, 0, inf, enter, exit));
}

}  // namespace
}  // namespace treeline::test
