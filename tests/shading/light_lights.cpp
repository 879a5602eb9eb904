// Lights: the irradiance that their samples bring against closed forms, samples against densities, where
// nothing arrives, and what is refused.
#include <gtest/gtest.h>

#include "shading/light/directional_light.hpp"
#include "shading/light/disc_light.hpp"
#include "shading/light/irradiance.hpp"
#include "shading/light/mesh_light.hpp"
#include "shading/light/point_light.hpp"
#include "shading/light/rectangle_light.hpp"
#include "shading/light/sphere_light.hpp"
#include "tests/shading/chi_square.hpp"

namespace treeline::shading::light {
namespace {

using geometry::Pcg32;
using std::numbers::pi;
const Vec3d radiance{1, 2, 0.5};

struct Estimate {
  double mean = 0, error = 0, relative_variance = 0;
};
/// Of the irradiance at p, of the first channel.
template <class Sample>
Estimate irradiance(const Sample& sample, const Vec3d& normal, int n = 40'000) {
  Pcg32 random(3);
  double sum = 0, squares = 0;
  for (int i = 0; i < n; ++i) {
    const double u = random.uniform<double>();
    const LightSample s = sample(u, random.uniform<double>());
    const double x = s.weight()[0] * std::max(0.0, dot(s.direction, normal));
    sum += x, squares += x * x;
  }
  const double mean = sum / n, variance = squares / n - mean * mean;
  return {mean, std::sqrt(variance / n), variance / (mean * mean)};
}
/// 4.5 standard errors: one of 15 fails by chance once in 10^4.
template <AnyLight L>
void expect_irradiance(const L& light, const Vec3d& p, const Vec3d& normal, double expected) {
  const Estimate e = irradiance([&](double u, double v) { return light.sample(p, u, v); }, normal);
  EXPECT_NEAR(e.mean, expected, 4.5 * e.error + 1e-12 * expected);
  EXPECT_LT(e.error, 0.03 * expected);
}

TEST(Lights, RectanglesBringWhatLambertSays) {
  const Vec3d middle{0, 0, 2}, u{1, 0, 0}, v{0, -0.5, 0};  // facing down
  const RectangleLight light(middle, u, v, radiance);
  for (const auto& [p, n] : {std::pair{Vec3d{0, 0, 0}, Vec3d{0, 0, 1}},
                             {{1.5, 1, 1.9}, normalized(Vec3d{-1, 0, 1})},
                             {{0.2, 0.1, 1.99}, {1, 0, 0}}})
    expect_irradiance(light, p, n,
                      polygon_cosine_angle(
                          std::array{middle - u - v, middle + u - v, middle + u + v, middle - u + v}, p, n));
  EXPECT_NEAR(light.power()[1], pi * 2 * 2, 1e-14);
}

TEST(Lights, DiscsBringWhatTheirViewFactorSays) {
  const DiscLight light({0, 0, 2}, {0, 0, -3}, 1.5, radiance);
  const Vec3d up{0, 0, 1};
  for (const double h : {0.01, 0.5, 2.0})  // on the axis: pi R² / (R² + h²)
    expect_irradiance(light, {0, 0, 2 - h}, up, pi * 1.5 * 1.5 / (1.5 * 1.5 + h * h));
  // Off the axis, parallel: pi / 2 (1 - (h² + d² - R²) / √((h² + d² + R²)² - 4 d² R²)).
  const double h = 0.7, d = 1.2, r = 1.5, q = h * h + d * d;
  expect_irradiance(light, {d, 0, 2 - h}, up,
                    pi / 2 * (1 - (q - r * r) / std::sqrt((q + r * r) * (q + r * r) - 4 * d * d * r * r)));
  EXPECT_NEAR(light.power()[2], pi * pi * 2.25 * 0.5, 1e-14);
}

TEST(Lights, SpheresBringTheirCap) {
  const SphereLight light({0, 0, 3}, 1, radiance);
  for (const Vec3d& n : {Vec3d{0, 0, 1}, normalized(Vec3d{1, 0, 0.2}), normalized(Vec3d{1, 0, -0.2})})
    expect_irradiance(light, {0, 0, 0}, n, ball_cosine_angle(1, 3, n[2]));
  expect_irradiance(light, {0, 0, 1.999}, {0, 0, 1}, ball_cosine_angle(1, 1.001, 1));
  EXPECT_NEAR(light.power()[0], 4 * pi * pi, 1e-13);
}

/// middle ± u ± v, facing cross(u, v).
void add_quad(geometry::Mesh3f& mesh, const Vec3d& middle, const Vec3d& u, const Vec3d& v) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (const Vec3d& p : {middle - u - v, middle + u - v, middle + u + v, middle - u + v})
    mesh.vertices.push_back(geometry::Vec3f(p));
  mesh.faces.push_back({first, first + 1, first + 2}), mesh.faces.push_back({first, first + 2, first + 3});
}
/// A box, seen from outside, and a second one apart from it.
geometry::Mesh3f boxes() {
  geometry::Mesh3f mesh;
  for (const Vec3d& middle : {Vec3d{0, 0, 2}, {0, 2.5, 2}})
    for (int axis = 0; axis < 3; ++axis)
      for (const int end : {0, 1}) {
        const BoxFace f =
            box_face({middle - Vec3d{0.5, 0.25, 0.5}, middle + Vec3d{0.5, 0.25, 0.5}}, axis, end);
        add_quad(mesh, f.middle, f.u, f.v);
      }
  return mesh;
}

TEST(Lights, MeshesBringWhatTheirFrontsDo) {
  const geometry::Mesh3f mesh = boxes();
  const MeshLight light(mesh, Rgb(radiance));
  const Vec3d p{0.2, -0.8, 1.2}, n = normalized(Vec3d{0, 1, 0.5});
  double expected = 0;
  for (std::size_t i = 0; i < mesh.size(); ++i) {
    const Triangle3d t(mesh.triangle(i));
    if (dot(p - t.a, t.area_normal()) > 0) expected += polygon_cosine_angle(std::array{t.a, t.b, t.c}, p, n);
  }
  expect_irradiance(light, p, n, expected);  // nothing in between: a box does not hide the other
  EXPECT_NEAR(light.power()[0], pi * 2 * (2 * (0.5 + 1 + 0.5)), 1e-5);
}

TEST(Lights, SamplesLieOnThemAtTheDensityTheyTell) {
  const RectangleLight rectangle({1, 0, 2}, {1, 0, 0}, {0, -0.5, 0}, radiance);
  const DiscLight disc({1, 0, 2}, {0, 0, -1}, 1.5, radiance);
  const SphereLight sphere({1, 0, 3}, 1, radiance);
  const geometry::Mesh3f mesh = boxes();
  const MeshLight mesh_light(mesh, Rgb(radiance));
  const Vec3d p{0.1, 0.2, 0.3};
  Pcg32 random(1);
  for (int i = 0; i < 2000; ++i) {
    const double u = random.uniform<double>(), v = random.uniform<double>();
    const LightSample a = rectangle.sample(p, u, v), b = disc.sample(p, u, v), c = sphere.sample(p, u, v),
                      d = mesh_light.sample(p, u, v);
    const Vec3d on_a = p + a.direction * a.distance, on_b = p + b.direction * b.distance,
                on_c = p + c.direction * c.distance;
    EXPECT_NEAR(on_a[2], 2, 1e-13);
    EXPECT_NEAR(on_a[0], 1, 1 + 1e-13);
    EXPECT_NEAR(on_a[1], 0, 0.5 + 1e-13);
    EXPECT_NEAR(on_b[2], 2, 1e-13);
    EXPECT_LT(distance(on_b, Vec3d{1, 0, 2}), 1.5 + 1e-13);
    EXPECT_NEAR(distance(on_c, Vec3d{1, 0, 3}), 1, 1e-7);
    EXPECT_LT(c.distance, distance(p, Vec3d{1, 0, 3}));  // of its two surfaces, the nearer
    EXPECT_EQ(a.value, radiance);
    EXPECT_FALSE(a.delta || b.delta || c.delta || d.delta);
    EXPECT_NEAR(a.pdf / rectangle.pdf(p, a.direction), 1, 1e-12);
    EXPECT_NEAR(b.pdf / disc.pdf(p, b.direction), 1, 1e-12);
    EXPECT_NEAR(c.pdf / sphere.pdf(p, c.direction), 1, 1e-12);
    if (d.pdf > 0) {
      EXPECT_NEAR(d.pdf / mesh_light.pdf(p, d.direction), 1, 1e-6);
    }
  }
  EXPECT_EQ(rectangle.pdf(p, {0, 0, -1}), 0);
  EXPECT_EQ(disc.pdf(p, {-1, 0, 0}), 0);
  EXPECT_EQ(sphere.pdf(p, {-1, 0, 0}), 0);
  EXPECT_EQ(mesh_light.pdf(p, Vec3d{-1, 0, 0}), 0);

  test::TestFamily family;
  family.add("mesh",
             test::chi_square_sphere(
                 [&](Pcg32& r) -> std::optional<Vec3d> {
                   const double u = r.uniform<double>();
                   const LightSample s = mesh_light.sample(p, u, r.uniform<double>());
                   if (!(s.pdf > 0)) return std::nullopt;
                   return s.direction;
                 },
                 [&](const Vec3d& d) { return mesh_light.pdf(p, d); }, {{12, 6, 20'000, 7}, {0, 0, 1}, 0.5}));
}

TEST(Lights, WithoutExtentAreExact) {
  const PointLight point({0, 0, 2}, radiance);
  const LightSample s = point.sample({0, 1, 1}, 0.3, 0.7);
  EXPECT_TRUE(s.delta);
  EXPECT_NEAR(s.distance, std::sqrt(2.0), 1e-15);
  EXPECT_NEAR(s.weight()[1], 1, 1e-15);  // 2 / r²
  EXPECT_NEAR(s.direction[2], std::sqrt(0.5), 1e-15);
  EXPECT_EQ(point.sample({0, 0, 2}, 0.3, 0.7).weight(), Vec3d{});
  EXPECT_EQ(point.pdf({}, {0, 0, 1}), 0);
  EXPECT_NEAR(point.power()[0], 4 * pi, 1e-14);
  const DirectionalLight sun({0, 0, -1e-200}, radiance, 10);
  EXPECT_EQ(sun.sample({}, 0, 0).direction, (Vec3d{0, 0, 1}));
  EXPECT_EQ(sun.sample({}, 0, 0).weight(), radiance);
  EXPECT_TRUE(std::isinf(sun.sample({}, 0, 0).distance));
  EXPECT_NEAR(sun.power()[0], 100 * pi, 1e-12);
}

TEST(Lights, ShowNothingFromBehindFromTheirPlaneOrFromWithin) {
  const RectangleLight rectangle({}, {1, 0, 0}, {0, 1, 0}, radiance);
  const DiscLight disc({}, {0, 0, 1}, 1, radiance);
  const SphereLight sphere({}, 1, radiance);
  for (const double z : {-1.0, 0.0}) {
    EXPECT_EQ(rectangle.sample({0.1, 0.2, z}, 0.5, 0.5).pdf, 0);
    EXPECT_EQ(disc.sample({0.1, 0.2, z}, 0.5, 0.5).weight(), Vec3d{});
    EXPECT_EQ(rectangle.pdf({0.1, 0.2, z}, {0, 0, 1}), 0);
    EXPECT_EQ(disc.pdf({0.1, 0.2, z}, {0, 0, 1}), 0);
  }
  EXPECT_EQ(sphere.sample({0.1, 0, 0}, 0.5, 0.5).pdf, 0);
  EXPECT_EQ(sphere.sample({1, 0, 0}, 0.5, 0.5).pdf, 0);
  EXPECT_EQ(sphere.pdf({0.1, 0, 0}, {0, 0, 1}), 0);
}

TEST(Lights, SolidAnglesEndTheBlowUpNearContact) {
  // A unit square above the middle of a diffuse receiver. By area: weights cos cos' A / r², whose relative
  // variance is A / (3 pi h²) - 1 as h → 0; by solid angle no more than a cosine's 1/3.
  LitScene scene;
  add_quad(scene.mesh, {}, {0.5, 0, 0}, {0, 0.5, 0});
  scene.face_materials = {0, 0};
  scene.materials.emplace_back().emission = Rgb::filled(1);
  const Emitters emitters(scene);
  for (const double h : {0.1, 0.03}) {
    const Vec3d p{0, 0, h}, down{0, 0, -1};
    Pcg32 choice(8);
    const Estimate by_area = irradiance(
        [&](double u, double v) -> LightSample {
          const EmitterSample s = emitters.sample(choice.uniform<double>(), float(u), float(v));
          const Vec3d to = Vec3d(s.point) - p;
          const double r = length(to);
          return {to / r, r, Vec3d(s.emission), s.pdf_area * r * r * r / dot(Vec3d(s.normal), -to), false};
        },
        down, 400'000);
    const RectangleLight light({}, {0.5, 0, 0}, {0, 0.5, 0}, {1, 1, 1});
    const Estimate by_angle =
        irradiance([&](double u, double v) { return light.sample(p, u, v); }, down, 40'000);
    const double theory = 1 / (3 * pi * h * h) - 1;
    EXPECT_NEAR(by_area.relative_variance / theory, 1, 0.15) << h;  // pi stands for an irradiance a bit below
    EXPECT_LT(by_angle.relative_variance, 1.0 / 3) << h;
    EXPECT_NEAR(by_angle.mean, by_area.mean, 4 * (by_angle.error + by_area.error)) << h;
  }
}

template <class Make>
std::string refusal(const Make& make) {
  try {
    make();
  } catch (const InvalidLight& e) {
    return e.what();
  }
  return "";
}

TEST(Lights, RefusalsNameTheLightAndItsFault) {
  const double nan = std::numeric_limits<double>::quiet_NaN(),
               infinity = std::numeric_limits<double>::infinity();
  const Vec3d x{1, 0, 0}, y{0, 1, 0};
  EXPECT_EQ(refusal([&] { PointLight({nan, 0, 0}, radiance); }), "point light: its position is not finite");
  EXPECT_EQ(refusal([&] {
              PointLight({}, {0, -1, 0});
            }),
            "point light: its intensity is -1.000000 in channel 1; it must be finite and not negative");
  EXPECT_EQ(refusal([&] { DirectionalLight({}, radiance, 1); }), "directional light: its direction is zero");
  EXPECT_NE(refusal([&] { DirectionalLight(x, radiance, -1); }), "");
  EXPECT_NE(refusal([&] { DirectionalLight(x, {infinity, 0, 0}, 1); }), "");
  EXPECT_EQ(refusal([&] { RectangleLight({}, x, {}, radiance); }),
            "rectangle light: its half side v is zero");
  EXPECT_NE(refusal([&] { RectangleLight({}, x, x + y, radiance); }).find("not perpendicular"),
            std::string::npos);
  EXPECT_NE(refusal([&] { RectangleLight({}, x, y, {nan, 0, 0}); }), "");
  EXPECT_EQ(refusal([&] { DiscLight({}, x, 0, radiance); }),
            "disc light: its radius is 0.000000; it must be finite and above 0");
  EXPECT_NE(refusal([&] { DiscLight({}, {nan, 0, 0}, 1, radiance); }), "");
  EXPECT_NE(refusal([&] { SphereLight({}, nan, radiance); }), "");
  EXPECT_NE(refusal([&] { SphereLight({infinity, 0, 0}, 1, radiance); }), "");
  EXPECT_EQ(refusal([&] { MeshLight({}, {1, 1, 1}); }), "mesh light: its mesh has no area");
  geometry::Mesh3f mesh = boxes();
  EXPECT_NE(refusal([&] { MeshLight(mesh, {1, -1, 1}); }), "");
  mesh.vertices[2][0] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_NE(refusal([&] { MeshLight(mesh, {1, 1, 1}); }).find("vertex 2"), std::string::npos);
}

}  // namespace
}  // namespace treeline::shading::light
