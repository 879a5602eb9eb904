// Distance fields in closed form, by laws that need no truth: distances are 1-Lipschitz, the gradient is the
// limit of difference quotients, and going the distance along it ends on the surface.
#include "tests/accel/field_common.hpp"

namespace treeline::accel::field::test {
namespace {

constexpr Box3d around{{-2, -2, -2}, {2, 2, 2}};
const AxisBox box{Box3d{{-0.7, -0.3, -1}, {0.5, 0.9, 0.2}}};
const Torus torus{{0.1, 0.2, -0.1}, 0.9, 0.3};
const Sphere ball{{0.3, -0.2, 0.1}, 0.8};
const HalfSpace below{{normalized(Vec3d{1, 2, -3}), 0.25}};

template <class F>
void expect_lipschitz(const F& field) {
  Pcg32 random(7);
  for (int n = 0; n < 20000; ++n) {
    const Vec3d p = in_box(random, around),
                q = n % 2 ? in_box(random, around) : p + in_box(random, around) * 0.01;
    ASSERT_LE(std::abs(field.distance(p) - field.distance(q)),
              field.lipschitz() * distance(p, q) * (1 + 1e-12));
  }
}

/// Where the field is smooth: where both halves of a difference agree.
template <class F>
void expect_gradient(const F& field) {
  Pcg32 random(8);
  constexpr double e = 1e-5;
  int smooth = 0;
  for (int n = 0; n < 5000; ++n) {
    const Vec3d p = in_box(random, around), gradient = field.gradient(p);
    Vec3d forward, backward;
    for (int k = 0; k < 3; ++k) {
      Vec3d step{};
      step[k] = e;
      forward[k] = (field.distance(p + step) - field.distance(p)) / e;
      backward[k] = (field.distance(p) - field.distance(p - step)) / e;
    }
    if (distance(forward, backward) > 1e-3) continue;
    ++smooth;
    ASSERT_LT(distance(gradient, (forward + backward) * 0.5), 1e-3) << p[0] << " " << p[1] << " " << p[2];
  }
  EXPECT_GT(smooth, 4500);
}

template <class F>
void expect_on_surface(const F& field) {
  Pcg32 random(9);
  for (int n = 0; n < 5000; ++n) {
    const Vec3d p = in_box(random, around);
    const FieldSample s = field.sample(p);
    ASSERT_EQ(s.distance, field.distance(p));
    ASSERT_TRUE(s.known);
    ASSERT_EQ(s.error, 0);
    ASSERT_NEAR(length(field.gradient(p)), 1, 1e-12);
    ASSERT_NEAR(field.distance(p - field.gradient(p) * s.distance), 0, 1e-12);
  }
}

TEST(AnalyticField, ShapesAreExact) {
  const auto all = [](const auto& field) {
    expect_lipschitz(field), expect_gradient(field), expect_on_surface(field);
  };
  all(box), all(torus), all(ball), all(below);
}

TEST(AnalyticField, KnownDistances) {
  EXPECT_DOUBLE_EQ(box.distance({0, 0, -0.4}), -0.3);  // 0.3 above the lower side in y
  EXPECT_DOUBLE_EQ(box.distance({3.5, 4.9, 0}), 5);
  EXPECT_DOUBLE_EQ(torus.distance(torus.centre), 0.6);
  EXPECT_DOUBLE_EQ(torus.distance(torus.centre + Vec3d{0.9, 0, 0.1}), -0.2);
  EXPECT_DOUBLE_EQ(ball.distance(ball.centre), -0.8);
  EXPECT_EQ(ball.gradient(ball.centre), Vec3d{});
}

TEST(AnalyticField, CombinationsKeepTheirLaws) {
  const Union either{ball, box};
  const Difference less{ball, box};
  const SmoothUnion smooth{ball, box, 0.2};
  const auto both = [](const auto& field) { expect_lipschitz(field), expect_gradient(field); };
  both(either), both(less), both(smooth);
  Pcg32 random(10);
  for (int n = 0; n < 20000; ++n) {
    const Vec3d p = in_box(random, around);
    const double a = ball.distance(p), b = box.distance(p);
    ASSERT_EQ(either.distance(p) < 0, a < 0 || b < 0);
    ASSERT_EQ(less.distance(p) < 0, a < 0 && b > 0);
    ASSERT_LE(smooth.distance(p), std::min(a, b));
    ASSERT_GE(smooth.distance(p), std::min(a, b) - 0.05);
    if (std::abs(a - b) >= 0.2) {
      ASSERT_EQ(smooth.distance(p), std::min(a, b));
    }
    ASSERT_EQ(either.sample(p).known, std::min(a, b) > 0);
  }
}

// Every point where a field is not positive lies within its bounds; without a blend it is the plain union.
TEST(AnalyticField, BoundsHoldTheSurface) {
  const auto expect = [](const auto& field) {
    Pcg32 random(12);
    for (int n = 0; n < 20000; ++n) {
      const Vec3d p = in_box(random, around);
      if (field.distance(p) <= 0) {
        ASSERT_TRUE(field.bounds().contains(p));
      }
    }
  };
  expect(ball), expect(box), expect(torus), expect(Union{ball, box}), expect(Difference{torus, ball});
  expect(SmoothUnion{ball, box, 0.8}), expect(SmoothUnion{torus, ball, 0.5});
  static_assert(!BoundedField<HalfSpace> && !BoundedField<Union<HalfSpace, Sphere>>);
}

TEST(AnalyticField, ABlendOfNoWidthIsAUnion) {
  const Union either{ball, box};
  for (const double width : {0.0, -1.0}) {
    const SmoothUnion smooth{ball, box, width};
    Pcg32 random(13);
    for (int n = 0; n < 2000; ++n) {
      const Vec3d p = in_box(random, around);
      ASSERT_EQ(smooth.distance(p), either.distance(p));
      ASSERT_EQ(smooth.gradient(p), either.gradient(p));
      ASSERT_FALSE(std::isnan(smooth.sample(p).error));
    }
  }
}

/// The magnitude is a lower bound of the distance to where the field changes sign.
template <class F>
void expect_clear(const F& field) {
  Pcg32 random(11);
  for (int n = 0; n < 300; ++n) {
    const Vec3d p = in_box(random, around);
    const FieldSample s = field.sample(p);
    for (int m = 0; m < 200; ++m) {
      const Vec3d direction = normalized(in_box(random, around));
      const Vec3d q = p + direction * (0.999 * s.clearance());
      ASSERT_EQ(field.distance(q) < 0, s.distance < 0);
    }
  }
}

TEST(AnalyticField, ClearanceIsFree) {
  expect_clear(Union{ball, box});
  expect_clear(Difference{torus, box});
  expect_clear(SmoothUnion{ball, torus, 0.3});
}

}  // namespace
}  // namespace treeline::accel::field::test
