// Samplers of solid angles: counts of directions against the density 1 / solid angle over what the shape
// covers, for shapes near, far, wide, grazing and small.
#include <gtest/gtest.h>

#include "shading/light/spherical_cap.hpp"
#include "shading/light/spherical_ellipse.hpp"
#include "shading/light/spherical_rectangle.hpp"
#include "shading/light/spherical_triangle.hpp"
#include "tests/shading/chi_square.hpp"

namespace treeline::shading::light {
namespace {

using geometry::Pcg32;
using std::numbers::pi;
constexpr long samples = 50'000;

/// Of one sampler: bins in rings around the axis, half of them within the width.
template <class Shape>
void add(test::TestFamily& family, const std::string& name, const Shape& shape, const Vec3d& axis,
         double width) {
  const auto sample = [&](Pcg32& random) -> std::optional<Vec3d> {
    const double u = random.uniform<double>();
    const Vec3d d = shape.sample(u, random.uniform<double>());
    EXPECT_NEAR(length(d), 1, 1e-14) << name;
    return d;
  };
  // Where rounding decides at an edge, either answer is right: directions are drawn in by a part in 10^9.
  const auto pdf = [&](const Vec3d& d) {
    return shape.contains(normalized(d + (normalized(axis) - d) * 1e-9)) ? shape.pdf() : 0;
  };
  family.add(name, test::chi_square_sphere(sample, pdf, {{24, 12, samples, 7}, normalized(axis), width}));
}

TEST(SolidAngleSamplers, CapsAreEven) {
  test::TestFamily family;
  add(family, "wide", SphericalCap({0.6, 0, 0.8}, 2.5), {0.6, 0, 0.8}, 1);
  add(family, "ball", SphericalCap(Vec3d{1, 2, 3}, 2, {0, 0, 1}), {1, 2, 2}, 0.3);
  add(family, "from within", SphericalCap(Vec3d{1, 2, 3}, 2, {1, 2, 2}), {0, 0, 1}, 1);
  add(family, "far ball", SphericalCap(Vec3d{1e5, 0, 0}, 0.5, {}), {1, 0, 0}, 2e-6);
}

/// Counts in parts of a flat shape, of which each is expected as often as its solid angle says: exact for any
/// shape, where bins of directions would need its outline. part_of: of a point on the plane, which part.
template <class Shape, class PartOf>
test::ChiSquare in_parts(const Shape& shape, const Vec3d& from, const Vec3d& at, const Vec3d& normal,
                         const std::vector<double>& solid_angles, const PartOf& part_of) {
  std::vector<double> counts(solid_angles.size()), expected;
  double sum = 0;
  for (const double a : solid_angles) sum += a, expected.push_back(a / shape.solid_angle() * samples);
  EXPECT_NEAR(sum / shape.solid_angle(), 1, 1e-8);  // corners are rounded to 1e-16, heights are down to 1e-7
  Pcg32 random(9);
  for (long i = 0; i < samples; ++i) {
    const double u = random.uniform<double>();
    const Vec3d d = shape.sample(u, random.uniform<double>());
    EXPECT_NEAR(length(d), 1, 1e-14);
    const double t = dot(at - from, normal) / dot(d, normal);
    EXPECT_GT(t, 0);
    ++counts[std::min(counts.size() - 1, static_cast<std::size_t>(part_of(from + d * t)))];
  }
  return test::chi_square(counts, expected);
}

/// 16 × 16 small triangles, in rows from corner a.
test::ChiSquare in_small_triangles(const Triangle3d& t, const Vec3d& from) {
  constexpr int n = 16;
  const Vec3d u = (t.b - t.a) / double(n), v = (t.c - t.a) / double(n), normal = t.area_normal();
  std::vector<double> parts(2 * n * n);  // two for each cell of a grid; those beyond the triangle stay 0
  for (int i = 0; i < n; ++i)
    for (int j = 0; i + j < n; ++j) {
      const Vec3d p = t.a + u * double(i) + v * double(j);
      parts[static_cast<std::size_t>(2 * (i * n + j))] = triangle_solid_angle({p, p + u, p + v}, from);
      if (i + j < n - 1)
        parts[static_cast<std::size_t>(2 * (i * n + j) + 1)] =
            triangle_solid_angle({p + u, p + u + v, p + v}, from);
    }
  return in_parts(SphericalTriangle(t, from), from, t.a, normal, parts, [&](const Vec3d& p) {
    const double scale = n / length2(normal), x = dot(cross(p - t.a, t.c - t.a), normal) * scale,
                 y = dot(cross(t.b - t.a, p - t.a), normal) * scale;
    const int i = std::clamp(static_cast<int>(x), 0, n - 1),
              j = std::clamp(static_cast<int>(y), 0, n - 1 - i);
    return 2 * (i * n + j) + (x - i + y - j > 1 && i + j < n - 1 ? 1 : 0);
  });
}

TEST(SolidAngleSamplers, TrianglesAreEven) {
  test::TestFamily family;
  const Triangle3d t{{-1, -1, 0}, {2, -1, 0.5}, {0, 3, 0}};
  for (const auto& [name, from] : {std::pair{"near", Vec3d{0.1, 0.1, 0.3}},
                                   {"other side", {0.5, 0.2, -1}},
                                   {"all but touching", {0.3, 0, 0.22}},
                                   {"grazing", {4, 0, 0.3}},
                                   {"grazing by 1e-6", {4, 0, 5.0 / 6 + 1e-6}},
                                   {"off an edge", {-3, -1, 0.5}},
                                   {"at a corner", {-1.001, -1, 0.001}}})
    family.add(name, in_small_triangles(t, from));
  family.add("octant", in_small_triangles({{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {}));
  family.add("needle", in_small_triangles({{1, 0, 0}, {0.3, 0.9, 0.3}, {0.3, 0.9, 0.31}}, {}));
  family.add("needle, turned", in_small_triangles({{0.3, 0.9, 0.3}, {0.3, 0.9, 0.300001}, {1, 0, 0}}, {}));
  family.add("all but a lune", in_small_triangles({{1, 0, 0}, {0, 1e-3, 1}, {-1, 1e-3, 0}}, {}));
}

/// 16 × 16 small rectangles.
test::ChiSquare in_small_rectangles(const Vec3d& middle, const Vec3d& u, const Vec3d& v, const Vec3d& from) {
  constexpr int n = 16;
  std::vector<double> parts;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      parts.push_back(
          rectangle_solid_angle(middle + u * ((2 * i + 1.0) / n - 1) + v * ((2 * j + 1.0) / n - 1),
                                u / double(n), v / double(n), from));
  return in_parts(
      SphericalRectangle(middle, u, v, from), from, middle, cross(u, v), parts, [&](const Vec3d& p) {
        const double x = 0.5 * n * (1 + dot(p - middle, u) / length2(u)),
                     y = 0.5 * n * (1 + dot(p - middle, v) / length2(v));
        return std::clamp(static_cast<int>(x), 0, n - 1) * n + std::clamp(static_cast<int>(y), 0, n - 1);
      });
}

TEST(SolidAngleSamplers, RectanglesAreEven) {
  test::TestFamily family;
  const Vec3d middle{1, 0, 2}, u{0.6, 0.8, 0}, v{0, 0, 1.5};
  for (const auto& [name, from] : {std::pair{"near", Vec3d{1.2, -0.2, 2}},
                                   {"other side", {0, 1, 2.5}},
                                   {"grazing", {3.2, 2.7, 1}},
                                   {"grazing by 1e-6", {1 + 3 * 0.6, 3 * 0.8 + 1e-6, 1}},
                                   {"corner", {0.5, -0.9, 0.4}}})
    family.add(name, in_small_rectangles(middle, u, v, from));
  family.add("hemisphere", in_small_rectangles({0.3, 0, 1e-3}, {2, 0, 0}, {0, 1, 0}, {}));
  family.add("strip", in_small_rectangles({0, 0, 1}, {50, 0, 0}, {0, 1e-3, 0}, {}));
  family.add("strip, turned", in_small_rectangles({0, 0, 1}, {1e-7, 0, 0}, {0, 50, 0}, {}));
}

TEST(SolidAngleSamplers, DiscsAreEven) {
  test::TestFamily family;
  const Vec3d middle{1, 0, 2}, n{0.6, 0, 0.8};
  for (const auto& [name, from, width] : {std::tuple{"on the axis", Vec3d{-0.2, 0, 0.4}, 0.4},
                                          {"near", {0.8, 0.3, 1.9}, 1.0},
                                          {"other side", {2, 1, 3}, 0.5},
                                          {"grazing", {3, 0.5, 0.6}, 0.3},
                                          {"near the rim", {1.75, 0, 1.3}, 0.9}})
    add(family, name, SphericalEllipse(middle, n, 1, from), middle - from, width);
}

TEST(SolidAngleSamplers, DiscsAreEvenBetweenCircles) {
  // Of the same middle: each is a disc, of a solid angle that is known.
  test::TestFamily family;
  const Vec3d n{0, 0, 1};
  for (const auto& [name, from] : {std::pair{"near", Vec3d{0.3, 0, 0.2}},
                                   {"touching", {0.3, 0, 1e-6}},
                                   {"over the rim", {1, 0, 1e-3}},
                                   {"grazing", {1.5, 0, -1e-7}},
                                   {"grazing at the rim", {1.0001, 0, 1e-6}},
                                   {"far", {5e4, 1e5, 2e5}}}) {
    constexpr int rings = 64;
    std::vector<double> parts;
    for (int i = 0; i < rings; ++i)
      parts.push_back(disc_solid_angle({}, n, (i + 1.0) / rings, from) -
                      (i > 0 ? disc_solid_angle({}, n, double(i) / rings, from) : 0));
    family.add(name, in_parts(SphericalEllipse({}, n, 1, from), from, {}, n, parts,
                              [&](const Vec3d& p) { return std::floor(rings * std::hypot(p[0], p[1])); }));
  }
}

/// Of sizes where bins of directions fail: evenly over solid angle is evenly over area then, to the size's
/// order, so points on the shape are counted, by coordinates in which its area is even.
template <class Shape, class Coordinates>
void add_small(test::TestFamily& family, const std::string& name, const Shape& shape, const Vec3d& normal,
               double height, const Coordinates& coordinates) {
  const auto sample = [&](Pcg32& random) -> std::optional<geometry::Vec2d> {
    const double u = random.uniform<double>();
    const Vec3d d = shape.sample(u, random.uniform<double>());
    const geometry::Vec2d q = coordinates(d * (height / dot(d, normal)));
    for (int k = 0; k < 2; ++k) EXPECT_NEAR(q[k], 0.5, 0.5 + 1e-6) << name;
    return q;
  };
  family.add(name, test::chi_square_square(sample, [](const geometry::Vec2d&) { return 1.0; },
                                           {24, 12, samples, 8}));
}

TEST(SolidAngleSamplers, SmallShapesKeepTheirDigits) {
  test::TestFamily family;
  for (const double size : {1e-3, 1e-5, 1e-8}) {
    const std::string name = " of size " + std::to_string(size * 1e9) + "e-9";
    // All lie at height 1, off to a side; what is seen of them is small and askew.
    const Vec3d n{0, 0, 1}, at{0.5, -0.25, 1}, u{size, 0, 0}, v{0, 3 * size, 0};
    const Triangle3d t{at, at + u, at + u * 0.3 + v};
    add_small(family, "triangle" + name, SphericalTriangle(t, {}), n, 1,
              [&](const Vec3d& p) -> geometry::Vec2d {
                const double c = (p[1] - at[1]) / v[1], b = (p[0] - at[0]) / size - 0.3 * c;
                return {1 - (1 - c) * (1 - c), b / (1 - c)};
              });
    add_small(family, "rectangle" + name, SphericalRectangle(at, u, v, {}), n, 1,
              [&](const Vec3d& p) -> geometry::Vec2d {
                return {0.5 + (p[0] - at[0]) / (2 * size), 0.5 + (p[1] - at[1]) / (6 * size)};
              });
    add_small(family, "disc" + name, SphericalEllipse(at, n, size, {}), n, 1,
              [&](const Vec3d& p) -> geometry::Vec2d {
                const double x = (p[0] - at[0]) / size, y = (p[1] - at[1]) / size;
                return {x * x + y * y, 0.5 + std::atan2(y, x) / (2 * pi)};
              });
  }
}

template <class Shape>
void expect_sound(const Shape& shape, Pcg32& random, const std::string& where) {
  ASSERT_TRUE(shape.solid_angle() >= 0 && shape.solid_angle() <= 4 * pi * (1 + 1e-15)) << where;
  if (!(shape.solid_angle() > 0)) return;
  constexpr double last = 1 - 0x1p-53;
  for (const auto& [u, v] : {std::pair{0.0, random.uniform<double>()},
                             {last, random.uniform<double>()},
                             {random.uniform<double>(), 0.0},
                             {random.uniform<double>(), last},
                             {random.uniform<double>(), random.uniform<double>()}})
    ASSERT_NEAR(length(shape.sample(u, v)), 1, 1e-12) << where << " " << u << " " << v;
}

TEST(SolidAngleSamplers, GiveUnitDirectionsFromCornersEdgesAndPlanesAtAnyScale) {
  Pcg32 random(11);
  const auto any = [&](double size) -> Vec3d {
    return {random.uniform(-size, size), random.uniform(-size, size), random.uniform(-size, size)};
  };
  for (int i = 0; i < 4000; ++i) {
    const double size = std::pow(10, random.uniform(-60.0, 60.0)),
                 off = size * std::pow(10, random.uniform(-20.0, 3.0));
    const Triangle3d t{any(size), any(size), any(size)};
    const Vec3d inner = t.a * 0.3 + t.b * 0.3 + t.c * 0.4, n = normalized(any(1)), middle = any(size);
    const geometry::Frame<double> frame(n);
    const double radius = size * random.uniform(0.01, 1.0);
    const Vec3d u = frame.x * radius, v = frame.y * (size * random.uniform(0.01, 1.0));
    const std::string name = std::to_string(i) + " of size " + std::to_string(std::log10(size));
    for (const Vec3d& from : {t.a, t.a + any(off), t.a * 0.3 + t.b * 0.7, inner,
                              inner + normalized(t.area_normal() / (size * size)) * off, any(10 * size)})
      expect_sound(SphericalTriangle(t, from), random, "triangle " + name);
    for (const Vec3d& from : {middle + u + v, middle + u + v + any(off), middle + u, middle + u * 0.3,
                              middle + u * 0.3 - v * 0.2 + n * off, any(10 * size)})
      expect_sound(SphericalRectangle(middle, u, v, from), random, "rectangle " + name);
    for (const Vec3d& from : {middle + u, middle + u + any(off), middle, middle + u * 0.5,
                              middle + u * 0.5 + n * off, any(10 * size)}) {
      expect_sound(SphericalEllipse(middle, n, radius, from), random, "disc " + name);
      expect_sound(SphericalCap(middle, radius, from), random, "ball " + name);
    }
  }
}

TEST(SolidAngleSamplers, TheTestsCanFail) {
  // By area instead of by solid angle, as found in the wild: a third as many samples near the far corner.
  const Triangle3d t{{-1, -1, 0}, {2, -1, 0.5}, {0, 3, 0}};
  const Vec3d from{0.1, 0.1, 0.8};
  const SphericalTriangle seen(t, from);
  const auto by_area = [&](Pcg32& random) -> std::optional<Vec3d> {
    const double u = random.uniform<double>();
    const Vec3d w = geometry::sample_triangle(u, random.uniform<double>());
    return normalized(t.a * w[0] + t.b * w[1] + t.c * w[2] - from);
  };
  const auto pdf = [&](const Vec3d& d) { return seen.contains(d) ? seen.pdf() : 0; };
  EXPECT_LT(test::chi_square_sphere(by_area, pdf, {{24, 12, samples, 7}, {0, 0, -1}, 1}).p, 1e-30);
  // A density that is a tenth too small.
  const auto low = [&](const Vec3d& d) { return 0.9 * pdf(d); };
  const auto right = [&](Pcg32& random) -> std::optional<Vec3d> {
    const double u = random.uniform<double>();
    return seen.sample(u, random.uniform<double>());
  };
  EXPECT_LT(test::chi_square_sphere(right, low, {{24, 12, samples, 7}, {0, 0, -1}, 1}).p, 1e-30);
}

TEST(ChiSquare, TailsAndPooling) {
  EXPECT_NEAR(test::chi_square_tail(18.307038, 10), 0.05, 1e-7);  // Abramowitz and Stegun, table 26.8
  EXPECT_NEAR(test::chi_square_tail(0.0157908, 1), 0.9, 1e-5);
  EXPECT_NEAR(test::chi_square_tail(149.4493, 100), 0.001, 1e-7);
  EXPECT_NEAR(test::chi_square_tail(7, 2), std::exp(-3.5), 1e-15);
  // 1 + 2 + 3 are pooled to 6; the rest stand alone: three groups, (9 - 6)² / 6 + (8 - 10)² / 10 + 1² / 20.
  const std::vector<double> expected{20, 1, 10, 2, 3}, counts{19, 4, 8, 3, 2};
  const test::ChiSquare r = test::chi_square(counts, expected);
  EXPECT_EQ(r.degrees, 2);
  EXPECT_NEAR(r.statistic, 1.5 + 0.4 + 0.05, 1e-12);
}

}  // namespace
}  // namespace treeline::shading::light
