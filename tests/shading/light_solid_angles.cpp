// Solid angles: closed forms for special places, and for any place an integral over the shape's area that
// knows none of their formulas. Elliptic integrals against the standard library's. Irradiance likewise.
#include <gtest/gtest.h>

#include "geometry/random.hpp"
#include "shading/light/irradiance.hpp"
#include "shading/light/radiometry.hpp"
#include "shading/light/spherical_cap.hpp"
#include "shading/light/spherical_ellipse.hpp"
#include "shading/light/spherical_rectangle.hpp"
#include "shading/light/spherical_triangle.hpp"
#include "tests/shading/quadrature.hpp"

namespace treeline::shading::light {
namespace {

using geometry::Pcg32;
using std::numbers::pi;
using test::integral;

/// Of the patch at(s, t) over the unit square, with area element and normal by at's exact derivatives: the
/// integral of |cosine| / r². at gives {point, cross product of derivatives}.
template <class At>
double by_area(const At& at, const Vec3d& from, double tolerance) {
  return integral(
      [&](double s, double t) {
        const auto [point, normal] = at(s, t);
        const Vec3d to = point - from;
        const double r2 = length2(to);
        return std::abs(dot(to, normal)) / (r2 * std::sqrt(r2));
      },
      0, 1, 0, 1, tolerance, 14);
}
struct Patch {
  Vec3d point, normal;
};
double triangle_by_area(const Triangle3d& t, const Vec3d& from, double tolerance) {
  return by_area(
      [&](double s, double r) -> Patch {
        return {t.a + (t.b - t.a) * s + (t.c - t.b) * (s * r), t.area_normal() * s};
      },
      from, tolerance);
}
double disc_by_area(const Vec3d& middle, const Vec3d& normal, double radius, const Vec3d& from,
                    double tolerance) {
  const geometry::Frame<double> frame(normal);
  return by_area(
      [&](double s, double t) -> Patch {
        const double r = radius * s, a = 2 * pi * t;
        return {middle + frame.x * (r * std::cos(a)) + frame.y * (r * std::sin(a)),
                normal * (2 * pi * radius * r)};
      },
      from, tolerance);
}
Vec3d random_point(Pcg32& random, double low, double high) {
  return {random.uniform(low, high), random.uniform(low, high), random.uniform(low, high)};
}

TEST(SolidAngle, OfCapsAndBalls) {
  EXPECT_NEAR(cap_solid_angle(pi), 4 * pi, 1e-14);
  EXPECT_NEAR(cap_solid_angle(pi / 2), 2 * pi, 1e-14);
  EXPECT_NEAR(cap_solid_angle(pi / 3), pi, 1e-14);  // 2 pi (1 - 1/2)
  EXPECT_NEAR(cap_solid_angle(1e-9) / (pi * 1e-18), 1, 1e-15);
  EXPECT_EQ(ball_solid_angle(1, 0.5), 4 * pi);
  EXPECT_EQ(ball_solid_angle(1, 1), 2 * pi);
  EXPECT_NEAR(ball_solid_angle(1, 2), cap_solid_angle(pi / 6), 1e-14);
  EXPECT_NEAR(ball_solid_angle(1, 1e10) / (pi * 1e-20), 1, 1e-15);
  // As the disc that a ball's outline is: of radius R √(1 - s²), nearer by R s, s = R / d.
  for (const double d : {1.01, 1.5, 3.0, 40.0}) {
    const double s = 1 / d;
    EXPECT_NEAR(
        ball_solid_angle(1, d) / disc_solid_angle({0, 0, d - s}, {0, 0, 1}, std::sqrt((1 - s) * (1 + s)), {}),
        1, 1e-13);
  }
}

TEST(SolidAngle, OfTrianglesAndRectanglesInSpecialPlaces) {
  EXPECT_NEAR(triangle_solid_angle({{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {}), pi / 2, 1e-15);  // an octant
  EXPECT_NEAR(rectangle_solid_angle({0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {}), 4 * pi / 6,
              1e-14);  // a cube's side
  // By its half angles, from its axis: 4 asin(sin a sin b).
  for (const auto& [a, b] : {std::pair{0.3, 1.2}, {1e-3, 1.5}, {1e-6, 2e-6}})
    EXPECT_NEAR(rectangle_solid_angle({0, 0, -2}, {2 * std::tan(a), 0, 0}, {0, 2 * std::tan(b), 0}, {}) /
                    (4 * std::asin(std::sin(a) * std::sin(b))),
                1, 1e-12);
  // From its plane nothing, from just above all of the hemisphere.
  const Triangle3d t{{-1, -1, 0}, {2, -1, 0}, {0, 3, 0}};
  EXPECT_EQ(triangle_solid_angle(t, {0.1, 0.2, 0}), 0);
  EXPECT_NEAR(triangle_solid_angle(t, {0.1, 0.2, 1e-12}), 2 * pi, 1e-10);
  EXPECT_NEAR(triangle_solid_angle(t, {0.1, 0.2, -1e-12}), 2 * pi, 1e-10);
  EXPECT_EQ(triangle_solid_angle({{1, 1, 1}, {2, 2, 2}, {3, 3, 3}}, {0, 1, 0}), 0);
  // Far away: area × cosine / r², with a relative error of the size's order.
  const Vec3d far{3e8, 4e8, 5e8};
  const double r = length(far);
  EXPECT_NEAR(triangle_solid_angle(t, far) / (6 * (far[2] / r) / (r * r)), 1, 1e-7);
}

TEST(SolidAngle, OfAnyTriangleByItsArea) {
  Pcg32 random(1);
  for (int i = 0; i < 30; ++i) {
    const Triangle3d t{random_point(random, -1, 1), random_point(random, -1, 1), random_point(random, -1, 1)};
    const Vec3d from = random_point(random, -2, 2);
    const double expected = triangle_by_area(t, from, 1e-12);
    EXPECT_NEAR(triangle_solid_angle(t, from), expected, 3e-11 + 1e-11 * expected) << i;
  }
}

TEST(SolidAngle, ScalesAndSplitsExactly) {
  Pcg32 random(2);
  for (int i = 0; i < 1000; ++i) {
    // Of any size down to 1e-7: parts add up to the whole, which relative errors of 1 / size would break.
    const double size = std::pow(10, random.uniform(-7.0, 0.0));
    const Vec3d middle = random_point(random, -1, 1);
    const Triangle3d t{middle + random_point(random, -size, size), middle + random_point(random, -size, size),
                       middle + random_point(random, -size, size)};
    const Vec3d from = middle + normalized(random_point(random, -1, 1)) * random.uniform(0.5, 3.0),
                at = t.a * 0.2 + t.b * 0.5 + t.c * 0.3;
    const double whole = triangle_solid_angle(t, from);
    const double parts = triangle_solid_angle({t.a, t.b, at}, from) +
                         triangle_solid_angle({t.b, t.c, at}, from) +
                         triangle_solid_angle({t.c, t.a, at}, from);
    // The corners' own rounding moves the parts by 1e-16 / size.
    EXPECT_NEAR(parts / whole, 1, 1e-12 + 2e-14 / (whole / size)) << size;
  }
}

TEST(SolidAngle, OfDiscsOnTheirAxis) {
  for (const double h : {1e-9, 1e-3, 0.1, 1.0, 10.0, 1e5}) {
    const double expected = 2 * pi / (std::hypot(h, 1) * (std::hypot(h, 1) + h));  // 2 pi (1 - h / √(h² + 1))
    for (const double side : {-1.0, 1.0})
      EXPECT_NEAR(disc_solid_angle({1, 2, 3}, {0, 0, 1}, 1, {1, 2, 3 + side * h}) / expected, 1, 1e-13) << h;
  }
  EXPECT_EQ(disc_solid_angle({0, 0, 0}, {0, 0, 1}, 1, {0.5, 0, 0}), 0);
  EXPECT_EQ(disc_solid_angle({0, 0, 0}, {0, 0, 1}, 1, {5, 0, 0}), 0);
}

TEST(SolidAngle, OfAnyDiscByItsArea) {
  Pcg32 random(3);
  for (int i = 0; i < 30; ++i) {
    const Vec3d middle = random_point(random, -1, 1), n = normalized(random_point(random, -1, 1));
    const double radius = random.uniform(0.1, 1.5);
    const Vec3d from = middle + random_point(random, -2, 2);
    const double expected = disc_by_area(middle, n, radius, from, 1e-12);
    EXPECT_NEAR(disc_solid_angle(middle, n, radius, from), expected, 3e-11 + 1e-11 * expected) << i;
  }
}

/// The solid angle as 2 pi less complete elliptic integrals, which are the standard library's.
double disc_by_elliptic_integrals(const SphericalEllipse& e) {
  const double a = 1 / std::pow(std::tan(e.smaller_half_angle()), 2),
               b = 1 / std::pow(std::tan(e.larger_half_angle()), 2);
  // I = (a R_F - (a - b) R_J / 3) / √(a (1 + a)) of (0, b / a, z[, 1]); R_J / 3 = (Π - K) / (n z √z).
  const double z = (1 + b) / (1 + a), k = std::sqrt(1 - b / a / z), n = 1 - 1 / z;
  const double first = std::comp_ellint_1(k) / std::sqrt(z);
  const double j = n == 0 ? 0 : (std::comp_ellint_3(k, n) - std::comp_ellint_1(k)) / (n * z * std::sqrt(z));
  return 2 * pi - 4 * (a * first - (a - b) * j) / std::sqrt(a * (1 + a));
}

TEST(SolidAngle, OfDiscsNearGrazingAndWide) {
  for (const double h : {1e-3, 1e-2, 0.3, 2.0})
    for (const double d : {0.2, 0.9, 0.999, 1.0, 1.001, 1.3, 4.0}) {
      const SphericalEllipse e({0, 0, 0}, {0, 0, 1}, 1, {d, 0, h});
      EXPECT_NEAR(e.solid_angle(), disc_by_elliptic_integrals(e), 2e-11) << h << " " << d;
    }
  // Grazing, from outside: to first order in the height h, h times the integral of 1 / r³ over the disc.
  for (const double d : {1.05, 2.0, 30.0}) {
    const double plane = integral(
        [&](double s, double t) {
          const double r2 = d * d + s * s - 2 * d * s * std::cos(2 * pi * t);
          return 2 * pi * s / (r2 * std::sqrt(r2));
        },
        0, 1, 0, 1, 1e-10, 14);
    const double h = 1e-7;
    EXPECT_NEAR(disc_solid_angle({0, 0, 0}, {0, 0, 1}, 1, {d, 0, h}) / (h * plane), 1, 1e-8) << d;
  }
}

TEST(SolidAngle, OfBoxes) {
  const Box<double, 3> box{{-1, -2, 0}, {1, 0.5, 3}};
  EXPECT_EQ(box_solid_angle(box, {0, 0, 1}), 4 * pi);
  EXPECT_EQ(box_solid_angle(box, {1, 0, 1}), 2 * pi);
  EXPECT_EQ(box_solid_angle(box, {1, 0.5, 1}), pi);
  EXPECT_EQ(box_solid_angle(box, {1, 0.5, 3}), pi / 2);
  EXPECT_NEAR(box_solid_angle({{-1, -1, -1}, {1, 1, 1}}, {0, 0, 1 + 1e-9}), 2 * pi, 1e-7);
  EXPECT_NEAR(rectangle_solid_angle({}, {1, 0, 0}, {0, 2, 0}, {0.5, 1, 1e-13}), 2 * pi,
              1e-12);  // over its diagonal
  // Each direction that leaves a box's silhouette crosses two of its sides: half the sum over all six.
  Pcg32 random(4);
  for (int i = 0; i < 200; ++i) {
    const Vec3d from = random_point(random, -6, 6);
    if (box.contains(from)) continue;
    double all = 0;
    for (int axis = 0; axis < 3; ++axis)
      for (const int end : {0, 1}) {
        const BoxFace f = box_face(box, axis, end);
        EXPECT_GT(dot(cross(f.u, f.v), f.middle - box.centre()), 0);
        all += rectangle_solid_angle(f.middle, f.u, f.v, from);
      }
    EXPECT_NEAR(box_solid_angle(box, from), all / 2, 1e-13);
  }
}

TEST(Elliptic, CarlsonsFormsAreLegendres) {
  Pcg32 random(5);
  for (int i = 0; i < 2000; ++i) {
    const double k = random.uniform(0.0, 0.999), nu = random.uniform(-5.0, 0.95),
                 phi = random.uniform(1e-3, pi / 2);
    const double s = std::sin(phi), c2 = std::cos(phi) * std::cos(phi), m = 1 - k * k * s * s;
    const double first = s * geometry::carlson_rf(c2, m, 1);
    EXPECT_NEAR(first / std::ellint_1(k, phi), 1, 1e-13);
    EXPECT_NEAR((first + nu / 3 * s * s * s * geometry::carlson_rj(c2, m, 1, 1 - nu * s * s)) /
                    std::ellint_3(k, nu, phi),
                1, 1e-12);
  }
  EXPECT_NEAR(geometry::carlson_rf(4, 4, 4), 0.5, 1e-16);
  EXPECT_NEAR(geometry::carlson_rj(4, 4, 4, 4), 0.125, 1e-16);
  EXPECT_NEAR(geometry::carlson_rf(0, 1, 2), 1.3110287771461, 1e-13);      // Carlson 1995, table
  EXPECT_NEAR(geometry::carlson_rj(0, 1, 2, 3), 0.77688623778582, 1e-13);  // the same
  EXPECT_NEAR(geometry::carlson_rj(2, 3, 4, 5), 0.14297579667157, 1e-13);
}

TEST(Irradiance, OfPolygonsAndBallsByQuadrature) {
  Pcg32 random(6);
  for (int i = 0; i < 12; ++i) {
    const Triangle3d t{random_point(random, -1, 1), random_point(random, -1, 1), random_point(random, -1, 1)};
    const Vec3d from = random_point(random, -2, 2), n = normalized(random_point(random, -1, 1));
    // Cell by cell: a horizon that only cuts a corner off would escape the rule.
    double expected = 0;
    constexpr int cells = 8;
    for (int cell = 0; cell < cells * cells; ++cell)
      expected += by_area(
          [&](double s, double r) -> Patch {
            s = (cell / cells + s) / cells, r = (cell % cells + r) / cells;
            const Vec3d p = t.a + (t.b - t.a) * s + (t.c - t.b) * (s * r);
            return {p, t.area_normal() * (s * std::max(0.0, dot(normalized(p - from), n)) / (cells * cells))};
          },
          from, 1e-9);
    EXPECT_NEAR(polygon_cosine_angle(std::array{t.a, t.b, t.c}, from, n), expected, 1e-6) << i;
    EXPECT_NEAR(polygon_cosine_angle(std::array{t.c, t.b, t.a}, from, n), expected, 1e-6) << i;
  }
  for (const double cosine : {1.0, 0.9, 0.3, 0.0, -0.2, -0.49, -0.5, -0.51, -1.0}) {
    // A ball of radius 1 at distance 2: its cap is 30 degrees wide. By rings, of which what is above the
    // horizon is an arc.
    const double sine = std::sqrt(1 - cosine * cosine);
    double expected = 0;
    constexpr int rings = 4000;
    for (int i = 0; i < rings; ++i) {
      const double z = 1 - (1 - std::cos(pi / 6)) * (i + 0.5) / rings, r = std::sqrt((1 - z) * (1 + z));
      const double arc = sine > 0     ? std::acos(std::clamp(-cosine * z / (sine * r), -1.0, 1.0))
                         : cosine > 0 ? pi
                                      : 0;
      expected += 2 * (cosine * z * arc + sine * r * std::sin(arc)) * (1 - std::cos(pi / 6)) / rings;
    }
    EXPECT_NEAR(ball_cosine_angle(1, 2, cosine), expected, 1e-7) << cosine;
  }
  EXPECT_NEAR(polygon_cosine_angle(
                  std::array<Vec3d, 4>{{{-1e6, -1e6, 1}, {1e6, -1e6, 1}, {1e6, 1e6, 1}, {-1e6, 1e6, 1}}}, {},
                  {0, 0, 1}),
              pi, 1e-9);  // all of the sky
}

TEST(Radiometry, UnitsMultiplyAndFactorsOfPiAreInOnePlace) {
  static_assert(std::is_same_v<decltype(Radiance{} * SolidAngle{}), Quantity<1, -1, 0>>);
  static_assert(std::is_same_v<decltype(Flux{} / SolidAngle{}), Intensity>);
  static_assert(!std::is_convertible_v<Irradiance, Radiosity>);
  static_assert(!std::is_convertible_v<double, Flux>);
  const Area area{2};
  const Radiance l{3};
  EXPECT_DOUBLE_EQ(radiosity_of(l).value, 3 * pi);
  EXPECT_DOUBLE_EQ(flux_of(l, area).value, 6 * pi);
  EXPECT_DOUBLE_EQ(radiance_of(radiosity_of(l)).value, 3);
  EXPECT_DOUBLE_EQ(intensity_of(flux_of(Intensity{5})).value, 5);
  EXPECT_DOUBLE_EQ(arriving(flux_of(Irradiance{7}, area), area).value, 7);
  EXPECT_DOUBLE_EQ(leaving(flux_of(Radiosity{7}, area), area).value, 7);
  EXPECT_DOUBLE_EQ(reflected(irradiance_under(l), 0.5).value, 1.5 * pi);
  EXPECT_DOUBLE_EQ(irradiance_from(Intensity{8}, 2, 0.5).value, 1);
  EXPECT_EQ(irradiance_from(Intensity{8}, 2, -0.5).value, 0);
  EXPECT_DOUBLE_EQ(irradiance_from(l, SolidAngle{0.1}, 0.5).value, 0.15);
  EXPECT_DOUBLE_EQ((whole_sphere / hemisphere).value, 2);
  // A small ball of radiance L is a point of intensity pi R² L.
  const double r = 1e-3, d = 5;
  EXPECT_NEAR(l.value * ball_cosine_angle(r, d, 0.7),
              irradiance_from(Intensity{pi * r * r * l.value}, d, 0.7).value, 1e-12);
}

}  // namespace
}  // namespace treeline::shading::light
