// Scenes of planes and one sphere, each with one failure whose size has a closed form.
#include "datasets_gen/scenes/parts.hpp"

namespace treeline::datasets {
namespace {

using shading::Light;
using shading::LightKind;
using shading::Scene;

constexpr double side = 8;  ///< of the floors

Light rectangle_above(const Vec3d& middle, double width, double depth) {
  return {.kind = LightKind::rectangle,
          .position = middle,
          .direction = {0, -1, 0},
          .u = {0.5 * width, 0, 0},
          .v = {0, 0, 0.5 * depth}};
}
Light disc_above(const Vec3d& middle, double radius) {
  return {.kind = LightKind::disc,
          .position = middle,
          .direction = {0, -1, 0},
          .u = {radius, 0, 0},
          .v = {0, 0, radius}};
}
Scene scene(Parts&& parts, const Light& light, const Vec3d& eye, const Vec3d& target,
            double height_angle = 0.7) {
  Scene r;
  r.mesh = std::move(parts.mesh), r.light = light;
  r.camera.position = eye, r.camera.target = target, r.camera.height_angle = height_angle;
  return r;
}
/// A level sheet over [x0, x1] × [z0, z1], its normal up.
void level(Parts& to, double y, double x0, double x1, double z0, double z1, std::size_t faces) {
  to.sheet({x0, y, z0}, {0, 0, z1 - z0}, {x1 - x0, 0, 0}, faces);
}

}  // namespace

/// Light falls straight down on a square of side 2 (seen from above) whose normal is off it by theta. phi:
/// between the slope and an axis of the shadow map. False shadow of a map without bias: half of it, for any
/// theta > 0.
Scene tilted_plane(const SceneJob& j) {
  const SinCos theta = sincos_turns(j.knobs[0] / 360), phi = sincos_turns(j.knobs[1] / 360);
  const Vec3d normal{theta.sin * phi.cos, theta.cos, theta.sin * phi.sin};
  const auto at = [&](double x, double z) {
    return Vec3d{x, -(normal[0] * x + normal[2] * z) / normal[1], z};
  };
  Parts parts;
  const Vec3d corner = at(-1, -1);
  parts.sheet(corner, sum(at(-1, 1), scaled(corner, -1)), sum(at(1, -1), scaled(corner, -1)), j.job.n);
  Scene r = scene(std::move(parts), sun({0, -1, 0}), scaled(normal, 4), {}, 0.4);
  // Along the plane's level lines, so that it is never the line of sight, and then turned a little: or all
  // pixels of a column would lie alike in their texels, and few columns would stand for the whole plane.
  const Vec3d level{-phi.sin, 0, phi.cos}, down{normal[1] * phi.cos, -theta.sin, normal[1] * phi.sin};
  const SinCos turn = sincos_turns(1.0 / 32);
  r.camera.up = sum(scaled(level, turn.cos), scaled(down, turn.sin));
  return r;
}

/// The shadow of a thin wall that stands on the floor begins at its foot: what a bias makes of that is the
/// contact gap.
Scene wall_on_floor(const SceneJob& j) {
  const double half = 0.5 * j.knobs[0];
  Parts parts;
  parts.floor(side, j.job.n - j.job.n / 4);
  parts.box({-half, 0, -1.5}, {half, 1.5, 1.5}, box_cells(j.job.n / 4));
  return scene(std::move(parts), sun({1, -1, 0.3}), {5, 4, 4}, {0.7, 0, 0.2});
}

/// Above the floor a slab and a sheet without thickness, and a second slab that rests on the floor: midpoints
/// of depth lie in the first, beneath the second, and in the floor under the third.
Scene slab_and_sheet(const SceneJob& j) {
  const double thick = j.knobs[0];
  Parts parts;
  parts.floor(side, j.job.n / 2);
  const std::size_t cells = box_cells(j.job.n / 6);
  parts.box({-2.2, 1, -1}, {-0.3, 1 + thick, 1}, cells);
  level(parts, 1, 0.3, 2.2, -1, 1, j.job.n / 6);
  parts.box({-1, 0, 1.8}, {1, thick, 3}, cells);
  return scene(std::move(parts), sun({0.4, -1, 0.3}), {2, 4, 6.5}, {0, 0.3, 0.5});
}

/// A half-plane over x < 0, under a rectangle right above its edge: at x, and away from its ends, the floor
/// sees the share clamp(1/2 + x/w, 0, 1) of the light, with w = width · height / (4 - height).
Scene half_plane_edge(const SceneJob& j) {
  const double height = j.knobs[0], width = j.knobs[1];
  Parts parts;
  parts.floor(side, j.job.n - j.job.n / 2);
  level(parts, height, -side / 2, 0, -side / 2, side / 2, j.job.n / 2);
  return scene(std::move(parts), rectangle_above({0, 4, 0}, width, width), {2.5, 2.2 * height, 2}, {0, 0, 0},
               0.6);
}

Scene sphere_over_floor(const SceneJob& j) {
  Parts parts;
  parts.floor(side, j.job.n - j.job.n / 2);
  parts.sphere(j.job, {0, 1.5, 0}, 0.8, j.job.n / 2);
  return scene(std::move(parts), disc_above({0.8, 5, 0.5}, j.knobs[0]), {3.5, 3.5, 5}, {-0.1, 0.5, 0});
}

/// Two levels of occluders, the lower covering more, over a floor in their full shadow. r: the distance of
/// the floor from the lower one, in units of their own. Variance shadow maps leak up to 1/(1+2r)² around x =
/// 0.
Scene two_stacked(const SceneJob& j) {
  const double r = j.knobs[0], upper = 4, lower = upper * r / (1 + r);
  Parts parts;
  parts.floor(side, j.job.n - 2 * (j.job.n / 4));
  level(parts, lower, -2, 1, -2, 2, j.job.n / 4);
  level(parts, upper, -2, 0, -2, 2, j.job.n / 4);
  return scene(std::move(parts), sun({0, -1, 0}), {5, std::min(3.0, 4 * lower), 0.5}, {0.2, 0, 0}, 0.4);
}

/// Three levels at gaps of 1, 1 and g from the floor, whose edges cross above one point of it: in the full
/// shadow of all, four moments leak there.
Scene three_layers(const SceneJob& j) {
  const double g = j.knobs[0];
  Parts parts;
  const std::size_t share = j.job.n / 5;
  parts.floor(side, j.job.n - 3 * share);
  level(parts, g, -2, 1.5, -2, 1.5, share);
  level(parts, g + 1, -2, 1.5, -2, 0, share);
  level(parts, g + 2, -2, 0, -2, 1.5, share);
  return scene(std::move(parts), sun({0, -1, 0}), {6, std::min(3.0, 3 * g), 0.5}, {0.2, 0, 0}, 0.4);
}

/// Two half-planes with a slit between them, under a disc of radius 1 at twice their height: seen from the
/// floor below its middle, the slit's edges stand at ± offset of the disc's radius. The share of the disc in
/// it is 2(x√(1-x²) + asin x)/π at that offset x: .315 for .25.
Scene slit(const SceneJob& j) {
  const double height = 2, half = 0.5 * j.knobs[0];
  Parts parts;
  parts.floor(side, j.job.n - 2 * (j.job.n / 4));
  level(parts, height, -side / 2, -half, -side / 2, side / 2, j.job.n / 4);
  level(parts, height, half, side / 2, -side / 2, side / 2, j.job.n / 4);
  return scene(std::move(parts), disc_above({0, 2 * height, 0}, 1), {2.5, 1.4, 2}, {0, 0, 0});
}

}  // namespace treeline::datasets
