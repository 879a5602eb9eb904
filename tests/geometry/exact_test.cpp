// The exact predicates against rational arithmetic by other formulas, and against laws, on numbers that are
// hard.
#include "geometry/exact.hpp"

#include <gtest/gtest.h>

#include "geometry/exact_ray_triangle.hpp"
#include "tests/geometry/exact_numbers.hpp"
#include "tests/geometry/witness.hpp"

namespace treeline::test {
namespace {

using VecR = Vec<Rational, 3>;
VecR rational(const Vec3d& v) { return {Rational(v[0]), Rational(v[1]), Rational(v[2])}; }
int sign_of(const Rational& x) { return x > 0 ? 1 : x < 0 ? -1 : 0; }
VecR minus(const VecR& a, const VecR& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Rational dot_of(const VecR& a, const VecR& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/// No double is nearer to the truth than r, and at a tie r is even.
bool is_nearest(double r, const Rational& truth) {
  const Rational off = abs(Rational(r) - truth);
  for (const double to : {-INFINITY, INFINITY}) {
    const double next = std::nextafter(r, to);
    if (std::isinf(next)) continue;
    const Rational other = abs(Rational(next) - truth);
    if (other < off || (other == off && (std::bit_cast<std::uint64_t>(r) & 1) == 1)) return false;
  }
  return true;
}

template <class F>
void for_all_kinds(int cases, const F& check) {
  for (const Numbers kind : all_numbers) {
    Pcg32 random(17, static_cast<std::uint64_t>(kind));
    SCOPED_TRACE("numbers of kind " + std::to_string(static_cast<int>(kind)));
    for (int i = 0; i < cases && !testing::Test::HasFailure(); ++i) check(kind, random);
  }
}

TEST(Dyadic, CalculatesLikeRationals) {
  for_all_kinds(300, [](Numbers kind, Pcg32& random) {
    double x[4];
    for (double& v : x) v = hard_number(kind, random);
    const auto value = [&]<class N>(N) {
      const N a(x[0]), b(x[1]), c(x[2]), d(x[3]);
      return N((a * b - c * d) * (a + d) - b * (c - a) * (d - b));
    };
    const Rational truth = value(Rational());
    const Dyadic r = value(Dyadic());
    ASSERT_EQ(r.sign(), sign_of(truth));
    const Dyadic below = Dyadic(x[1]) * Dyadic(x[2]) - Dyadic(x[0]);
    const Rational truth_below = Rational(x[1]) * Rational(x[2]) - Rational(x[0]);
    if (below.sign() == 0) return;
    const Rational q = truth / truth_below;
    if (abs(q) < Rational(1e300)) {
      ASSERT_TRUE(is_nearest(rounded_quotient<double>(r, below), q));
    }
  });
}

TEST(Orientation, AgreesWithRationals) {
  int zeros = 0;
  for_all_kinds(1000, [&](Numbers kind, Pcg32& random) {
    const auto t = hard_triangle(kind, random);
    const Vec3d d = hard_point(kind, random);
    // Laplace's expansion of the homogeneous determinant.
    const VecR p[4] = {rational(t.a), rational(t.b), rational(t.c), rational(d)};
    const auto minor = [&](int i, int j, int k) {
      return Rational(p[i][0] * (p[j][1] * p[k][2] - p[j][2] * p[k][1]) -
                      p[i][1] * (p[j][0] * p[k][2] - p[j][2] * p[k][0]) +
                      p[i][2] * (p[j][0] * p[k][1] - p[j][1] * p[k][0]));
    };
    const int truth = sign_of(minor(0, 1, 2) * -1 + minor(0, 1, 3) - minor(0, 2, 3) + minor(1, 2, 3));
    zeros += truth == 0;
    ASSERT_EQ(orientation(t.a, t.b, t.c, d), truth);
    ASSERT_EQ(OrientationWithin(4e150)(t.a, t.b, t.c, d), truth);
    if (kind != Numbers::huge && kind != Numbers::mixed) {
      ASSERT_EQ(OrientationWithin(3)(t.a, t.b, t.c, d), truth);
    }
    const Vec2d a{t.a[0], t.a[1]}, b{t.b[0], t.b[1]}, c{t.c[0], t.c[1]};
    ASSERT_EQ(orientation(a, b, c),
              sign_of((p[1][0] - p[0][0]) * (p[2][1] - p[0][1]) - (p[1][1] - p[0][1]) * (p[2][0] - p[0][0])));
  });
  EXPECT_GT(zeros, 150);
}

TEST(Orientation, ChangesSignWithEachSwapAndNotWithScaleOrShift) {
  for_all_kinds(500, [](Numbers kind, Pcg32& random) {
    Vec3d p[4];
    for (auto& x : p) x = hard_point(kind, random);
    const int sign = orientation(p[0], p[1], p[2], p[3]);
    for (int i = 0; i < 4; ++i)
      for (int j = i + 1; j < 4; ++j) {
        std::swap(p[i], p[j]);
        ASSERT_EQ(orientation(p[0], p[1], p[2], p[3]), -sign);
        std::swap(p[i], p[j]);
      }
    bool small = false;  // some neighbours of 0 are denormal
    for (const Vec3d& x : p)
      for (int k = 0; k < 3; ++k) small = small || (x[k] != 0 && std::abs(x[k]) < 0x1p-30);
    if (!small && (kind == Numbers::uniform || kind == Numbers::whole || kind == Numbers::last_place)) {
      const auto scaled = [](const Vec3d& v, double s) { return v * s; };
      for (const double s : {0x1p-400, 0x1p-990, 0x1p300, 0x1p1000})  // to 2^-1043 no digit is lost
        ASSERT_EQ(orientation(scaled(p[0], s), scaled(p[1], s), scaled(p[2], s), scaled(p[3], s)), sign);
    }
    if (kind == Numbers::whole) {
      const Vec3d by{0x1p40, -0x1p51, 3};
      ASSERT_EQ(orientation(p[0] + by, p[1] + by, p[2] + by, p[3] + by), sign);
    }
  });
}

TEST(ExactHit, AgreesWithCramersRule) {
  int hits = 0, edges = 0;
  for_all_kinds(1000, [&](Numbers kind, Pcg32& random) {
    Rayd ray{hard_point(kind, random), hard_point(kind, random)};
    const Triangle3d t = hard_triangle(kind, random);
    if (kind != Numbers::denormal && kind != Numbers::mixed && random.below(2) == 0)
      ray.direction = t.a + (t.b - t.a) * 0.5 - ray.origin;  // at an edge, nearly or exactly
    if (random.below(2) == 0) ray.t_min = -std::numeric_limits<double>::infinity();
    if (random.below(2) == 0) ray.t_max = random.below(3);
    const auto found = exact_hit(ray, t);
    const auto single = exact_hit<float>(ray, t);
    auto truth = witness_hit<Rational>(ray, t);
    edges += truth && (truth->u == 0 || truth->v == 0 || truth->u + truth->v == 1);
    if (truth && std::isfinite(ray.t_min) && truth->t < Rational(ray.t_min)) truth.reset();
    if (truth && std::isfinite(ray.t_max) && truth->t > Rational(ray.t_max)) truth.reset();
    ASSERT_EQ(found.has_value(), truth.has_value());
    ASSERT_EQ(single.has_value(), truth.has_value());
    if (!found) return;
    ++hits;
    if (abs(truth->t) < Rational(1e300)) {
      ASSERT_TRUE(is_nearest(*found, truth->t)) << *found;
    }
    if (abs(truth->t) < Rational(1e38f)) {
      for (const float to : {-INFINITY, INFINITY}) {
        const Rational other(std::nextafter(*single, to));
        ASSERT_LE(abs(Rational(*single) - truth->t), abs(other - truth->t));
      }
    }
  });
  EXPECT_GT(hits, 500);
  EXPECT_GT(edges, 300);
}

TEST(ExactHit, LeavesOfTreesRoundTheSameTime) {
  Pcg32 random(3);
  int hits = 0;
  for (int i = 0; i < 20000; ++i) {
    const auto vec = [&] {
      return hard_float_point(i % 2 == 0 ? Numbers::whole : Numbers::last_place, random);
    };
    const Rayf ray{vec(), vec()};
    const Triangle3f t{vec(), vec(), vec()};
    const auto leaf = ExactRay(ray, Vec3f{}).time(t);
    const auto found = exact_hit<float>({Vec3d(ray.origin), Vec3d(ray.direction)}, Triangle3d(t));
    ASSERT_EQ(leaf.has_value(), found.has_value());
    if (found) {
      ASSERT_EQ(*leaf, *found);
      ++hits;
    }
  }
  EXPECT_GT(hits, 500);
}

/// By projection to the plane and clamped projections to the edges.
Rational distance2_of(const Vec3d& point, const Triangle3d& t) {
  const VecR p = rational(point), c[3] = {rational(t.a), rational(t.b), rational(t.c)};
  std::optional<Rational> best;
  const auto offer = [&](const VecR& q) {
    const VecR v = minus(p, q);
    const Rational d = dot_of(v, v);
    if (!best || d < *best) best = d;
  };
  for (int i = 0; i < 3; ++i) {
    const VecR along = minus(c[(i + 1) % 3], c[i]);
    const Rational whole = dot_of(along, along);
    Rational s = whole == 0 ? Rational(0) : Rational(dot_of(minus(p, c[i]), along) / whole);
    s = std::min(std::max(s, Rational(0)), Rational(1));
    offer({c[i][0] + s * along[0], c[i][1] + s * along[1], c[i][2] + s * along[2]});
  }
  // In the plane: the normal equations of a + v ab + w ac.
  const VecR ab = minus(c[1], c[0]), ac = minus(c[2], c[0]), ap = minus(p, c[0]);
  const Rational m = dot_of(ab, ab), n = dot_of(ab, ac), o = dot_of(ac, ac), det = m * o - n * n;
  if (det != 0) {
    const Rational x = dot_of(ab, ap), y = dot_of(ac, ap), v = (x * o - y * n) / det,
                   w = (y * m - x * n) / det;
    if (v >= 0 && w >= 0 && v + w <= 1)
      offer({c[0][0] + v * ab[0] + w * ac[0], c[0][1] + v * ab[1] + w * ac[1],
             c[0][2] + v * ab[2] + w * ac[2]});
  }
  return *best;
}

TEST(ExactDistance, IsRoundedOnceAndOrderedRight) {
  int ties = 0, zeros = 0, features[7] = {};
  for_all_kinds(150, [&](Numbers kind, Pcg32& random) {
    const Vec3d p = hard_point(kind, random);
    const Triangle3d t = hard_triangle(kind, random), s = hard_triangle(kind, random);
    const Rational x = distance2_of(p, t), y = distance2_of(p, s);
    ASSERT_EQ(compare_distance(p, t, s), sign_of(x - y));
    ties += x == y, zeros += x == 0, ++features[exact_feature(p, t)];
    if (x < Rational(1e300)) {
      ASSERT_TRUE(is_nearest(exact_distance2(p, t), x));
    }
    const DistanceBracket b = distance_bracket(p, t);
    ASSERT_TRUE(b.low <= 0 || Rational(b.low) * Rational(b.low) <= x);
    if (std::isfinite(b.high)) {
      ASSERT_GE(Rational(b.high) * Rational(b.high), x);
    }
  });
  EXPECT_GT(ties, 1);
  EXPECT_GT(zeros, 5);
  for (const int f : features) EXPECT_GT(f, 20);
}

/// The triangle clipped to the box, in rationals, has a corner left.
bool clips_to_something(const Triangle3d& t, const Box<double, 3>& box) {
  std::vector<VecR> polygon{rational(t.a), rational(t.b), rational(t.c)};
  for (int k = 0; k < 3; ++k)
    for (const int side : {1, -1}) {
      const Rational limit = side * Rational(side > 0 ? box.high[k] : box.low[k]);
      std::vector<VecR> kept;
      for (std::size_t i = 0; i < polygon.size(); ++i) {
        const VecR &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
        const Rational dp = side * p[k] - limit, dq = side * q[k] - limit;
        if (dp <= 0) kept.push_back(p);
        if ((dp < 0 && dq > 0) || (dp > 0 && dq < 0)) {
          const Rational s = dp / (dp - dq);
          kept.push_back({p[0] + s * (q[0] - p[0]), p[1] + s * (q[1] - p[1]), p[2] + s * (q[2] - p[2])});
        }
      }
      polygon = kept;
    }
  return !polygon.empty();
}

TEST(TriangleBox, AgreesWithClippingInRationals) {
  int counts[2] = {};
  for_all_kinds(1000, [&](Numbers kind, Pcg32& random) {
    Triangle3d t = hard_triangle(kind, random);
    if (kind == Numbers::uniform) t.b = t.a + t.b * 0.7, t.c = t.a + t.c * 0.7;
    const Vec3d p = hard_point(kind, random), q = hard_point(kind, random);
    Box<double, 3> box{min(p, q), max(p, q)};
    if (kind == Numbers::uniform) box.high = box.low + (box.high - box.low) * 0.5;
    const bool truth = clips_to_something(t, box);
    ++counts[truth];
    ASSERT_EQ(overlaps(t, box), truth);
    if (truth) {
      ASSERT_TRUE(overlaps(Triangle3d{t.b, t.a, t.c}, box));
    }
  });
  EXPECT_GT(counts[0], 1000);
  EXPECT_GT(counts[1], 500);
  EXPECT_FALSE(overlaps(Triangle3d{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, Box<double, 3>{{0, 0, 1}, {1, 1, 0}}));
}

TEST(ThreePlanes, AgreeWithCramersRule) {
  int counts[4] = {};
  for_all_kinds(1000, [&](Numbers kind, Pcg32& random) {
    Plane3d plane[4];
    for (auto& p : plane) p = {hard_point(kind, random), hard_number(kind, random)};
    const auto det = [&](const std::array<Rational, 3>& x, const std::array<Rational, 3>& y,
                         const std::array<Rational, 3>& z) {
      return Rational(x[0] * y[1] * z[2] + y[0] * z[1] * x[2] + z[0] * x[1] * y[2] - x[2] * y[1] * z[0] -
                      y[2] * z[1] * x[0] - z[2] * x[1] * y[0]);
    };
    std::array<Rational, 3> column[4];
    for (std::size_t i = 0; i < 3; ++i) {
      for (int k = 0; k < 3; ++k) column[k][i] = Rational(plane[i].normal[k]);
      column[3][i] = Rational(plane[i].offset);
    }
    const Rational whole = det(column[0], column[1], column[2]);
    const auto found = side_of_meeting_point(plane[0], plane[1], plane[2], plane[3]);
    ASSERT_EQ(found.has_value(), whole != 0);
    if (!found) return void(++counts[3]);
    const VecR x{det(column[3], column[1], column[2]) / whole, det(column[0], column[3], column[2]) / whole,
                 det(column[0], column[1], column[3]) / whole};
    const int truth = sign_of(dot_of(rational(plane[3].normal), x) - Rational(plane[3].offset));
    ASSERT_EQ(*found, truth);
    ++counts[truth + 1];
  });
  for (const int c : counts) EXPECT_GT(c, 100);
}

}  // namespace
}  // namespace treeline::test
