#include "bench/brdf_integral/queries.hpp"

#include <charconv>
#include <cmath>
#include <numbers>

#include "geometry/random.hpp"
#include "geometry/sampling.hpp"

namespace treeline::bench::brdf_integral {
namespace {

using geometry::Pcg32;

using std::numbers::pi;
constexpr double golden_angle = 2.399963229728653;
// The small light: as wide as a lamp of 35 cm two metres away.
constexpr double light_half_angle = 5 * pi / 180, light_elevation = 45 * pi / 180, light_azimuth = 0.5;

Vec3d direction(double cosine, double azimuth) {
  const double s = std::sqrt((1 - cosine) * (1 + cosine));
  return {s * std::cos(azimuth), s * std::sin(azimuth), cosine};
}

Sky small_light() {
  Sky sky{SkyKind::cap, direction(std::cos(light_elevation), light_azimuth), std::cos(light_half_angle)};
  sky.radiance =
      pi / sky.solid_angle();  // a white diffuse surface that faces it is as bright as under a sky of 1
  return sky;
}

std::vector<Vec3d> repeated(const std::vector<Vec3d>& views, std::size_t times) {
  std::vector<Vec3d> r;
  for (const Vec3d& w : views) r.insert(r.end(), times, w);
  return r;
}

Set integral(std::string name, Sky sky, const std::vector<Vec3d>& views, std::size_t repeats) {
  Set s;
  s.name = std::move(name), s.channels = 3, s.sky = sky;
  s.views = repeated(views, repeats), s.repeats = repeats;
  return s;
}

/// What methods get: near the critical angle, an angle's last digit is worth a thousandth of the light.
double as_float(double x) { return double(static_cast<float>(x)); }

/// So that numbers in names read as they were written.
std::string text(double x) {
  char digits[32];
  return {digits, std::to_chars(digits, digits + sizeof digits, x).ptr};
}

}  // namespace

std::vector<Set> make_integral_sets(const Amount& amount, std::uint64_t seed) {
  std::vector<Vec3d> around, opposite;
  Pcg32 random(seed, 70);
  for (std::size_t k = 0; k < amount.views; ++k) {
    const double cosine = (double(k) + 0.5) / double(amount.views);
    around.push_back(direction(cosine, golden_angle * double(k)));
    opposite.push_back(direction(cosine, light_azimuth + pi + random.uniform(-0.3, 0.3)));
  }
  std::vector<Set> sets;
  sets.push_back(integral("albedo", {}, around, amount.repeats));
  sets.push_back(integral("cosine_sky", {SkyKind::cosine}, around, amount.repeats));
  sets.push_back(integral("small_light", small_light(), opposite, amount.repeats));
  Set average;
  average.name = "average", average.channels = 3, average.averages = amount.averages;
  average.repeats = amount.averages;
  sets.push_back(std::move(average));
  return sets;
}

std::vector<Set> make_hard_integral_sets(std::span<const double> cosines, std::uint64_t seed) {
  std::vector<Vec3d> around, opposite;
  Pcg32 random(seed, 71);
  for (std::size_t k = 0; k < cosines.size(); ++k) {
    around.push_back(direction(cosines[k], golden_angle * double(k)));
    opposite.push_back(direction(cosines[k], light_azimuth + pi + random.uniform(-0.1, 0.1)));
  }
  return {integral("albedo", {}, around, 16), integral("small_light", small_light(), opposite, 16)};
}

std::vector<Set> make_kernel_sets(const Material& m, std::size_t n, std::uint64_t seed) {
  Set evaluate, sample;
  evaluate.name = "evaluate", sample.name = "sample";
  sample.samples = true;
  Pcg32 random(seed, 72);
  const auto anywhere = [&] {
    const double u = random.uniform(), v = random.uniform();
    return geometry::sample_hemisphere(u, v);
  };
  while (evaluate.wo.x.size() < n) {
    const Vec3d wo = anywhere();
    Vec3d wi = anywhere();
    if (evaluate.wo.x.size() % 2 == 0 && m.kind == shading::SurfaceKind::microfacet) {
      const double r = std::sqrt(1 / (1 - 0.99 * random.uniform()) - 1), turn = random.uniform(0.0, 2 * pi);
      const Vec3d h = normalized(Vec3d{m.alpha_x * r * std::cos(turn), m.alpha_y * r * std::sin(turn), 1});
      wi = h * (2 * dot(wo, h)) - wo;
      if (wi[2] < 1e-3) continue;
    }
    evaluate.wi.add(wi), evaluate.wo.add(wo);
    const std::size_t viewer = sample.wo.x.size() % kernel_viewers;
    sample.wo.add(direction((double(viewer) + 0.5) / kernel_viewers, golden_angle * double(viewer)));
    sample.u.push_back(random.uniform<float>()), sample.v.push_back(random.uniform<float>());
  }
  return {std::move(evaluate), std::move(sample)};
}

std::vector<Set> make_furnace_sets(bool all) {
  std::vector<Set> sets;
  const auto add = [&](double alpha, double reflectance) {
    Set s;
    s.name = reflectance == 1 ? "white_" + text(alpha) : "colour_" + text(alpha) + "_" + text(reflectance);
    s.alpha = alpha, s.reflectance = reflectance;
    sets.push_back(std::move(s));
  };
  if (!all) return add(0.5, 1), add(0.5, 0.5), sets;
  for (const double alpha : {0.05, 0.1, 0.25, 0.5, 0.75, 1.0}) add(alpha, 1);
  for (const double alpha : {0.25, 0.5, 1.0})
    for (const double reflectance : {0.2, 0.5, 0.8}) add(alpha, reflectance);
  return sets;
}

std::vector<Set> make_fresnel_sets(std::size_t angles) {
  const std::pair<const char*, Medium> media[] = {
      {"index_1.05", {1.05}},       {"index_1.33", {1.33}},
      {"index_1.5", {1.5}},         {"index_3", {3}},
      {"leaving_1.5", {1 / 1.5}},   {"aluminium", {0.97, 6.40}},
      {"chromium", {3.18, 3.33}},   {"tungsten", {3.50, 2.72}},
      {"gold_green", {0.92, 2.45}}, {"index_0.2_0.2", {0.2, 0.2}}};
  std::vector<Set> sets;
  for (const auto& [name, medium] : media) {
    Set s;
    s.name = name, s.medium = {as_float(medium.index), as_float(medium.extinction)};
    for (std::size_t k = 0; k < angles; ++k)
      s.cosines.push_back(as_float(std::max(0.0, std::cos(0.5 * pi * double(k) / double(angles - 1)))));
    sets.push_back(std::move(s));
  }
  return sets;
}

std::vector<Set> make_solid_angle_sets(std::size_t each, std::uint64_t seed) {
  constexpr double aspect = 0.5, most_tilt = 75 * pi / 180;
  const std::pair<const char*, ShapeKind> flat[] = {
      {"disc", ShapeKind::disc}, {"triangle", ShapeKind::triangle}, {"rectangle", ShapeKind::rectangle}};
  Pcg32 random(seed, 73);
  const auto towards = [&] {
    const double u = random.uniform(), v = random.uniform();
    return geometry::sample_sphere(u, v);
  };
  std::vector<Set> sets;
  const auto add = [&](std::string name, auto&& make) {
    Set s;
    s.name = std::move(name);
    for (std::size_t k = 0; k < each; ++k) s.shapes.push_back(make());
    sets.push_back(std::move(s));
  };
  /// A flat shape whose normal is `tilt` off the direction to the viewer.
  const auto flat_shape = [&](ShapeKind kind, double distance, double tilt) {
    const Vec3d d = towards();
    const geometry::Frame<double> f(d);
    const double turn = random.uniform(0.0, 2 * pi), spin = random.uniform(0.0, 2 * pi);
    const Vec3d n = d * std::cos(tilt) + (f.x * std::cos(turn) + f.y * std::sin(turn)) * std::sin(tilt);
    const geometry::Frame<double> g(normalized(n));
    const Vec3d u = g.x * std::cos(spin) + g.y * std::sin(spin), v = cross(g.z, u);
    Shape s{kind, d * distance, u, v};
    if (kind == ShapeKind::rectangle)
      s.u = u * (1 / std::hypot(1, aspect)), s.v = v * (aspect / std::hypot(1, aspect));
    if (kind == ShapeKind::triangle) {  // with all corners on the circle; its middle is as far as the others'
      const double third = 2 * pi / 3;
      const auto corner = [&](double a) { return u * std::cos(a) + v * std::sin(a); };
      s.centre = d * distance + corner(0);
      s.u = corner(third) - corner(0), s.v = corner(2 * third) - corner(0);
    }
    return s;
  };
  for (const double distance : {1.0, 3.0, 10.0, 30.0}) {
    const std::string at = "_" + text(distance);
    // A sphere of which the viewer is one radius away from its surface, and so on.
    add("sphere" + at, [&] { return Shape{ShapeKind::sphere, towards() * (1 + distance), {1, 0, 0}, {}}; });
    for (const auto& [name, kind] : flat) {
      add(name + at, [&] { return flat_shape(kind, distance, 0); });
      add(name + ("_tilted" + at),
          [&] { return flat_shape(kind, distance, random.uniform(0.0, most_tilt)); });
    }
    add("box" + at, [&] { return Shape{ShapeKind::box, towards() * (1 + distance), {0.4, 0.5, 0.6}, {}}; });
  }
  Set hemisphere, sphere;  // a disc that touches the viewer, and a box around
  hemisphere.name = "hemisphere", hemisphere.shapes = {flat_shape(ShapeKind::disc, 1e-9, 0)};
  sphere.name = "all_around", sphere.shapes = {Shape{ShapeKind::box, {0.1, 0.2, -0.1}, {0.4, 0.5, 0.6}, {}}};
  sets.push_back(std::move(hemisphere)), sets.push_back(std::move(sphere));
  return sets;
}

}  // namespace treeline::bench::brdf_integral
