// Shadows from distance fields: against closed forms, with the figures that theory gives for their failures.
#include <gtest/gtest.h>

#include "accel/bvh/wide_triangles.hpp"
#include "shading/shadow/area_rays.hpp"
#include "shading/shadow/distance_field_shadow.hpp"
#include "tests/accel/triangles_common.hpp"
#include "tests/shading/shadow_scenes.hpp"

namespace treeline::shading::shadow::test {
namespace {

using namespace shading::test;
using accel::field::AxisBox;
using accel::field::HalfSpace;
using accel::field::Sphere;
using accel::field::Union;
using geometry::Pcg32;
using Tree = accel::Bvh<accel::Triangles<float, geometry::Watertight>, accel::Wide>;

constexpr double tan_a = 0.1, height = 10, radius = tan_a * height;  // of the cone, at the edges

/// Straight up, so that sideways is x.
Light sun_above(double tangent = tan_a) {
  Light light;
  light.angle = std::atan(tangent);
  return light;
}
/// Seen from the origin, all that is to the left of an edge at that height: everything above it and left of
/// the plane through the origin and the edge, so that thick as it is no other edge shows. `turn` is -1 for
/// the right. The distance is exact.
struct Wedge {
  double edge, turn = 1;

  double distance(const Vec3d& p) const {
    const double x = turn * p[0], e = turn * edge, n = std::hypot(e, height);
    const double below = height - p[1], beside = (x * height - e * p[1]) / n;
    if (below <= 0 && beside <= 0) return std::max(below, beside);
    double r = std::hypot(x - e, below);
    if (below > 0 && x <= e) r = std::min(r, below);
    if (beside > 0 && (x - e) * e - below * height >= 0) r = std::min(r, beside);
    return r;
  }
  Vec3d gradient(const Vec3d&) const { return {}; }
  accel::field::FieldSample sample(const Vec3d& p) const { return {distance(p), 0, true}; }
  double lipschitz() const { return 1; }
};
/// x in radii of the cone, towards the hidden side.
Wedge half_plane(double x) { return {-x * radius}; }
/// The corner of a box, turned so that its faces are oblique to the light.
struct Corner {
  double x, angle;
  AxisBox box{{{-4, -4, -60}, {0, 0, 60}}};

  double distance(const Vec3d& p) const {
    const double c = std::cos(angle), s = std::sin(angle), u = p[0] + x * radius, v = p[1] - height;
    return box.distance({c * u + s * v, s * u - c * v, p[2]});
  }
  Vec3d gradient(const Vec3d&) const { return {}; }
  accel::field::FieldSample sample(const Vec3d& p) const { return {distance(p), 0, true}; }
  double lipschitz() const { return 1; }
};

FieldShadowOptions options(FieldShadowForm form, double cone_step = 0.02) {
  FieldShadowOptions o;
  o.form = form, o.cone_step = cone_step, o.max_distance = 40, o.max_steps = 100000;
  o.tolerance = o.min_step = 1e-9;
  return o;
}
template <class Field>
float seen_from_origin(const Field& field, const FieldShadowOptions& o, double tangent = tan_a) {
  return DistanceFieldShadow(field, sun_above(tangent), o).visibility({{0, 0, 0}, {0, 1, 0}});
}

struct Errors {
  double rms = 0, bias = 0, most = 0;
};
/// Over edges that lie anywhere in the light's cone.
Errors half_plane_errors(const FieldShadowOptions& o) {
  Errors e;
  const int n = 400;
  for (int i = 0; i < n; ++i) {
    const double x = 2 * (i + 0.5) / n - 1;  // towards the hidden side, in radii
    const double error = double(seen_from_origin(half_plane(x), o)) - disc_over_edge(x);
    e.rms += error * error, e.bias += error, e.most = std::max(e.most, std::abs(error));
  }
  e.rms = std::sqrt(e.rms / n), e.bias /= n;
  return e;
}

TEST(FieldShadows, FormsOverAHalfPlane) {
  const auto errors = [](FieldShadowForm form, double cone_step = 0.02) {
    const Errors e = half_plane_errors(options(form, cone_step));
    std::printf("form %d, cone step %.2f: rms %.4f bias %.4f most %.4f\n", int(form), cone_step, e.rms,
                e.bias, e.most);
    return e;
  };
  const Errors one = errors(FieldShadowForm::one_sided), two = errors(FieldShadowForm::two_sided),
               disc = errors(FieldShadowForm::disc);
  EXPECT_NEAR(one.rms, 0.29, 0.01);
  EXPECT_NEAR(one.bias, -0.25, 0.01);
  EXPECT_NEAR(one.most, 0.5, 0.02);
  EXPECT_NEAR(two.rms, 0.028, 0.003);
  EXPECT_LT(disc.rms, 0.01);
  EXPECT_LT(errors(FieldShadowForm::disc, 0.25).rms, 0.06);
}

// The closed forms alone, without a march.
TEST(FieldShadows, TheTwoSidedPolynomialIsNearTheDisc) {
  double rms = 0;
  const int n = 1000;
  for (int i = 0; i < n; ++i) {
    const double x = 2 * (i + 0.5) / n - 1, error = 0.25 * (1 + x) * (1 + x) * (2 - x) - disc_over_edge(x);
    rms += error * error / n;
  }
  EXPECT_NEAR(std::sqrt(rms), 0.028, 0.001);
}

TEST(FieldShadows, ASlitIsSeenAsTheNearerOfItsEdges) {
  const Union slit{Wedge{-0.25 * radius}, Wedge{0.25 * radius, -1}};
  const double truth = 2 * disc_over_edge(0.25) - 1;
  EXPECT_NEAR(truth, 0.315, 0.001);
  EXPECT_NEAR(seen_from_origin(slit, options(FieldShadowForm::one_sided)), 0.25, 0.01);
  EXPECT_NEAR(seen_from_origin(slit, options(FieldShadowForm::disc)), 0.657, 0.01);
  EXPECT_NEAR(seen_from_origin(slit, options(FieldShadowForm::two_sided)), 0.684, 0.01);
}

// Straight up from a floor every ball holds the one before: without the guard, all is in shadow.
TEST(FieldShadows, AaltonensStepOverAFloor) {
  const HalfSpace floor{{{0, 1, 0}, 0}};
  for (const double offset : {0.0, 0.01}) {
    FieldShadowOptions o = options(FieldShadowForm::disc, 0);
    o.offset = offset, o.nearest = NearestThing::between;
    EXPECT_EQ(seen_from_origin(floor, o), 1);
    o.guard = false;
    EXPECT_NEAR(seen_from_origin(floor, o), 0.5, 1e-3);  // bias -0.50
    o.form = FieldShadowForm::one_sided;
    EXPECT_NEAR(seen_from_origin(floor, o), 0, 1e-3);
    o.nearest = NearestThing::at_samples;
    EXPECT_EQ(seen_from_origin(floor, o), 1);
  }
}

struct Steps {
  double at_samples = 0, between = 0;  // root mean squares
  double at_samples_bias = 0, between_bias = 0;
};
/// What either way of finding the nearest thing adds to the error of the form itself, for things that the way
/// to the light passes at x radii.
template <class Make>
Steps errors_of_steps(double cone_step, Make&& make) {
  Pcg32 random(6);
  Steps e;
  const int n = 2000;
  for (int i = 0; i < n; ++i) {
    const auto field = make(random.uniform(0.05, 0.95), random);
    FieldShadowOptions o = options(FieldShadowForm::one_sided, cone_step);
    o.start = random.uniform(0.05, 1.0);
    const double truth = seen_from_origin(field, options(FieldShadowForm::one_sided, 0.005));
    const double a = seen_from_origin(field, o) - truth;
    o.nearest = NearestThing::between;
    const double b = seen_from_origin(field, o) - truth;
    e.at_samples += a * a / n, e.between += b * b / n;
    e.at_samples_bias += a / n, e.between_bias += b / n;
  }
  e.at_samples = std::sqrt(e.at_samples), e.between = std::sqrt(e.between);
  return e;
}

// Where the balls of two steps meet is beside the way, and never behind what both touch: too dark. At corners
// that pays for samples that are too light, if steps are as long as the cone is wide; not where the field's
// own steps slow down before them.
TEST(FieldShadows, AaltonensStepAtACorner) {
  const auto corner = [](double x, Pcg32& random) { return Corner{x, random.uniform(0.35, 1.22)}; };
  const Steps fine = errors_of_steps(0, corner), coarse = errors_of_steps(1, corner);
  for (const Steps& e : {fine, coarse})
    std::printf("corner: at samples %.4f (bias %.4f), between %.4f (bias %.4f)\n", e.at_samples,
                e.at_samples_bias, e.between, e.between_bias);
  EXPECT_LT(fine.at_samples, 0.02);
  EXPECT_LT(std::abs(fine.at_samples_bias), 0.005);
  EXPECT_NEAR(fine.between_bias, -0.025, 0.01);
  EXPECT_GT(coarse.at_samples_bias, 0.03);
  EXPECT_LT(std::abs(coarse.between_bias), coarse.at_samples_bias);
}
TEST(FieldShadows, AaltonensStepBesideABall) {
  const Steps e = errors_of_steps(0, [](double x, Pcg32&) { return Sphere{{3 + x * radius, height, 0}, 3}; });
  EXPECT_LT(e.at_samples, 0.002);
  EXPECT_NEAR(e.between_bias, -0.045, 0.015);
}

// Over a plane the light is above by gamma, d / t = sin gamma: the plane hides the light from itself as soon
// as that is less than tan a, though all of the disc is above the horizon.
TEST(FieldShadows, AGrazedFloorHidesTheLightUnlessSineExceedsTangent) {
  for (const double share : {0.7, 0.9, 0.99, 1.01, 1.1}) {
    const double sine = share * tan_a, cosine = std::sqrt(1 - sine * sine);
    const HalfSpace floor{{{-cosine, sine, 0}, 0}};  // tilted, in place of the light
    const float seen = seen_from_origin(floor, options(FieldShadowForm::one_sided));
    EXPECT_NEAR(seen, std::min(1.0, share), 1e-3);
    EXPECT_EQ(seen == 1, sine > tan_a);
  }
}
/// A field that is wrong by as much as samples may be.
struct Shifted {
  HalfSpace floor;
  double by;
  double distance(const Vec3d& p) const { return floor.distance(p) - by; }
  Vec3d gradient(const Vec3d& p) const { return floor.gradient(p); }
  accel::field::FieldSample sample(const Vec3d& p) const { return {distance(p), by, true}; }
  double lipschitz() const { return 1; }
};
// With an error e of the field the march must start at t0 ≥ e / (sin gamma - tan a), or that far off the
// floor.
TEST(FieldShadows, TheStartMustBeClearOfTheFieldsError) {
  const double sine = 0.3, cosine = std::sqrt(1 - sine * sine), error = 0.01;
  const Shifted floor{HalfSpace{{{-cosine, sine, 0}, 0}}, error};
  const double needed = error / (sine - tan_a);
  for (const double share : {0.5, 0.95, 1.05, 2.0}) {
    FieldShadowOptions o = options(FieldShadowForm::disc);
    o.start = share * needed;
    EXPECT_EQ(seen_from_origin(floor, o) == 1, share > 1) << share;
  }
  FieldShadowOptions o = options(FieldShadowForm::disc);
  o.offset = error;
  EXPECT_EQ(DistanceFieldShadow(floor, sun_above(), o).visibility({{0, 0, 0}, floor.floor.plane.normal}), 1);
}

TEST(FieldShadows, DiscsRectanglesAndPoints) {
  const Wedge wedge = half_plane(0.3);
  FieldShadowOptions o = options(FieldShadowForm::disc);
  o.max_distance = INFINITY;
  Light light;
  light.kind = LightKind::disc, light.position = {0, 20, 0};
  light.u = {2, 0, 0}, light.v = {0, 0, 2};  // as large as the sun above
  const auto seen = [&] { return DistanceFieldShadow(wedge, light, o).visibility({{0, 0, 0}, {0, 1, 0}}); };
  const float sun = seen_from_origin(wedge, options(FieldShadowForm::disc));
  EXPECT_NEAR(seen(), sun, 1e-3);
  light.kind = LightKind::rectangle;
  light.u = light.u * std::sqrt(std::numbers::pi / 4), light.v = light.v * std::sqrt(std::numbers::pi / 4);
  EXPECT_NEAR(seen(), sun, 1e-3);
  light.kind = LightKind::point;
  EXPECT_EQ(seen(), 1);
  light.position = {-2, 20, 0};
  EXPECT_EQ(seen(), 0);
  light.position = {-2, 9, 0};  // before it
  EXPECT_EQ(seen(), 1);
}

// As in that engine: what is left of the steps bounds the light that is left.
TEST(FieldShadows, ClampedFormsCone) {
  const Wedge wedge = half_plane(0.5);
  FieldShadowOptions o = options(FieldShadowForm::clamped);
  EXPECT_NEAR(seen_from_origin(wedge, o), 0.5, 0.01);
  o.min_radius = 2 * radius;
  EXPECT_NEAR(seen_from_origin(wedge, o), 0.25, 0.01);
  o.min_radius = 0, o.max_radius = 0.5 * radius;
  EXPECT_NEAR(seen_from_origin(wedge, o), 1, 0.01);
  o.max_steps = 8;
  const FieldShadow dark = DistanceFieldShadow(wedge, sun_above(), o).trace({{0, 0, 0}, {0, 1, 0}});
  EXPECT_EQ(dark.steps, 8);
  EXPECT_TRUE(dark.exhausted);
  EXPECT_EQ(dark.visibility, 0);
}

TEST(FieldShadows, RefuseWhatIsNone) {
  const Sphere ball;
  FieldShadowOptions o;
  EXPECT_THROW(DistanceFieldShadow(ball, sun_above(), o), InvalidScene);  // no end
  o.max_distance = 10, o.start = 0;
  EXPECT_THROW(DistanceFieldShadow(ball, sun_above(), o), InvalidScene);
  o.start = 1e-3, o.max_steps = 0;
  EXPECT_THROW(DistanceFieldShadow(ball, sun_above(), o), InvalidScene);
  o.max_steps = 8, o.min_radius = 2, o.max_radius = 1;
  EXPECT_THROW(DistanceFieldShadow(ball, sun_above(), o), InvalidScene);
}

// ---- samples of a mesh ------------------------------------------------------------------------------------

struct Sampled {
  Scene scene;
  Tree tree;
  accel::field::DenseSamples samples;
  accel::field::Trilinear<accel::field::DenseSamples> field{samples};

  static accel::field::FieldOptions options(int resolution) {
    accel::field::FieldOptions o;
    o.resolution = resolution, o.band = INFINITY, o.support = accel::field::Support::trilinear;
    return o;
  }
  Sampled(const Scene& s, int resolution)
      : scene(s),
        tree(s.mesh),
        samples(accel::field::sample_mesh<accel::field::DenseSamples>(s.mesh, tree, options(resolution))) {}
  double cell() const { return samples.lattice().spacing; }
};

/// A floor slab, and a closed sheet of that thickness above it; `cells` of them along the floor.
Scene sheet_scene(double thickness, double angle) {
  Scene scene;
  accel::test::add_box(scene.mesh, geometry::Box3f{{-2, -0.4f, -2}, {2, 0, 2}});
  accel::test::add_box(scene.mesh,
                       geometry::Box3f{{-0.9f, 0.65f, -0.9f}, {0.9f, 0.65f + float(thickness), 0.9f}});
  scene.camera.position = {0, 2, 4};
  scene.light = sun_above(std::tan(angle));
  return scene;
}

/// Of the floor below the sheet, where all light is hidden: the shares that are said to see more than half,
/// by the one-sided form and by the disc's.
std::array<double, 2> missed_shares(double cells) {
  const int resolution = 32, n = 300;
  const Sampled s(sheet_scene(cells * 4 / resolution, 0.02), resolution);
  EXPECT_NEAR(s.cell(), 4.0 / resolution, 1e-9);
  const AreaRays rays(s.tree, s.scene);
  std::array<double, 2> missed{};
  Pcg32 random(1);
  for (int i = 0; i < n; ++i) {
    const Receiver r{{random.uniform(-0.7, 0.7), 0, random.uniform(-0.7, 0.7)}, {0, 1, 0}};
    EXPECT_EQ(rays.visibility(r), 0);
    for (const std::size_t k : {0, 1}) {
      FieldShadowOptions o = field_shadow_options(s.field);
      o.form = k == 0 ? FieldShadowForm::one_sided : FieldShadowForm::disc;
      missed[k] += DistanceFieldShadow(s.field, s.scene.light, o).visibility(r) > 0.5 ? 1.0 / n : 0;
    }
  }
  return missed;
}

TEST(FieldShadows, ASheetThinnerThanACellHidesNothing) {
  const auto thin = missed_shares(0.2), thick = missed_shares(2.5);
  EXPECT_GT(thin[0], 0.95);
  EXPECT_GT(thin[1], 0.95);
  EXPECT_EQ(thick[0], 0);
  EXPECT_EQ(thick[1], 0);
}

// A floor and a roof that both look up, which bound nothing: whether the roof hides the light is up to where
// the lattice's bricks lie. It is centred on the box's middle, y = 1/2. Of 32 cells (1/4) there are two
// bricks on end, which meet there: the upper one is below the roof, inside. Of 64 (1/8) there are three, and
// the middle one's samples, from 1/16 to 15/16, are all above the floor. A slab of 2½ of the coarser cells
// hides it from both. Away from the diagonal, where samples are nearest to an edge, and a ray decides.
TEST(FieldShadows, AnOpenRoofHidesByWhereTheBricksLie) {
  Scene open;
  for (const float y : {0.f, 1.f}) {
    const auto n = static_cast<std::uint32_t>(open.mesh.vertices.size());
    const std::array<Vec3f, 4> corners{{{-4, y, -4}, {-4, y, 4}, {4, y, 4}, {4, y, -4}}};
    open.mesh.vertices.insert(open.mesh.vertices.end(), corners.begin(), corners.end());
    open.mesh.faces.insert(open.mesh.faces.end(), {{n, n + 1, n + 2}, {n, n + 2, n + 3}});
  }
  open.light.kind = LightKind::point, open.light.position = {-2.7, 4, 2.2};
  Scene closed = open;
  closed.mesh = {};
  accel::test::add_box(closed.mesh, geometry::Box3f{{-4, -0.625f, -4}, {4, 0, 4}});
  accel::test::add_box(closed.mesh, geometry::Box3f{{-4, 1, -4}, {4, 1.625f, 4}});
  const auto seen = [](const Sampled& s) {
    FieldShadowOptions o = field_shadow_options(s.field);
    o.form = FieldShadowForm::one_sided;
    return DistanceFieldShadow(s.field, s.scene.light, o).visibility({{-2.7, 0, 2.2}, {0, 1, 0}});
  };
  const Sampled coarse(open, 32), fine(open, 64);
  EXPECT_FALSE(coarse.samples.report().closed || fine.samples.report().closed);
  const Vec3d below_the_roof{-2.7, 0.9, 2.2};
  EXPECT_LT(coarse.field.distance(below_the_roof), 0);
  EXPECT_EQ(seen(coarse), 0);
  EXPECT_NEAR(fine.field.distance(below_the_roof), 0.1, 1e-6);
  EXPECT_NEAR(fine.field.distance({-2.7, 0.99, 2.2}), 0.5 * fine.cell(), 1e-6);  // and on to the roof
  EXPECT_EQ(seen(fine), 1);
  for (const int resolution : {32, 64}) EXPECT_EQ(seen(Sampled(closed, resolution)), 0) << resolution;
}

// Against rays, over a scene with penumbras: the disc's form beats the textbook's.
TEST(FieldShadows, FormsAgainstRays) {
  Scene scene;
  accel::test::add_box(scene.mesh, geometry::Box3f{{-2, -0.4f, -2}, {2, 0, 2}});
  accel::test::add_box(scene.mesh, geometry::Box3f{{-1.2f, 0, -1}, {-0.5f, 0.8f, -0.2f}});
  append(scene.mesh, accel::test::sphere<float>(4, {0.4f, 1, 0.2f}, 0.5f));
  scene.camera.position = {0, 2, 4};
  scene.light.direction = normalized(Vec3d{0.4, -1, 0.3}), scene.light.angle = 0.12;
  const Sampled s(scene, 64);
  AreaRayOptions many;
  many.samples = 256;
  const AreaRays rays(s.tree, scene, many);
  Pcg32 random(1);
  std::vector<Receiver> receivers;
  for (int i = 0; i < 3000; ++i)
    receivers.push_back({{random.uniform(-1.9, 1.9), 0, random.uniform(-1.9, 1.9)}, {0, 1, 0}});
  std::erase_if(receivers, [](const Receiver& r) {  // below the box
    return r.position[0] > -1.25 && r.position[0] < -0.45 && r.position[2] > -1.05 && r.position[2] < -0.15;
  });
  std::vector<float> truth(receivers.size());
  rays.visibility(receivers, truth);
  const auto rms = [&](FieldShadowForm form) {
    FieldShadowOptions o = field_shadow_options(s.field);
    o.form = form;
    const DistanceFieldShadow shadow(s.field, scene.light, o);
    double sum = 0, steps = 0;
    for (std::size_t i = 0; i < receivers.size(); ++i) {
      const FieldShadow f = shadow.trace(receivers[i]);
      sum += std::pow(double(f.visibility) - double(truth[i]), 2), steps += f.steps;
    }
    std::printf("form %d against rays: rms %.4f, %.1f steps\n", int(form),
                std::sqrt(sum / double(receivers.size())), steps / double(receivers.size()));
    return std::sqrt(sum / double(receivers.size()));
  };
  const double one = rms(FieldShadowForm::one_sided), disc = rms(FieldShadowForm::disc);
  rms(FieldShadowForm::two_sided);
  EXPECT_LT(disc, 0.5 * one);
  EXPECT_LT(disc, 0.06);
}

}  // namespace
}  // namespace treeline::shading::shadow::test
