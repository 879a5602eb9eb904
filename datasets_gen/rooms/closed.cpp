// Closed rooms, whose light has an answer in closed form or by quadrature.
#include "datasets_gen/rooms/painted.hpp"

namespace treeline::datasets {
namespace {

/// All of it is of one albedo and emits: radiance is 1 on all surfaces, in all directions.
Material furnace_wall(double albedo) {
  const Rgb reflected = Rgb::filled(static_cast<float>(albedo));
  return lamp("wall", Rgb::filled(1) - reflected, reflected);
}

constexpr shading::Camera inside{.position = {0, 1, 0.9}, .target = {0, 1, 0}, .height_angle = 1};

}  // namespace

/// A closed box seen from inside.
LitScene furnace_room(const SceneJob& j) {
  Painted parts;
  parts.box({-1, 0, -1}, {1, 2, 1}, box_cells(j.job.n));
  parts.turn_over();
  parts.paint(furnace_wall(j.knobs[0]));
  return parts.take({.position = {0, 1, 0.9}, .target = {0, 1, 0}});
}

/// The same with what does not absorb: a mirror, glass and a diffuse sphere that emits. None of them is to be
/// seen.
LitScene furnace_spheres(const SceneJob& j) {
  Painted parts;
  const std::size_t each = j.job.n / 4;
  parts.box({-1, 0, -1}, {1, 2, 1}, box_cells(each));
  parts.turn_over();
  parts.paint(furnace_wall(j.knobs[0]));
  parts.sphere(j.job, {-0.5, 1.3, -0.3}, 0.35, each), parts.paint(mirror("mirror", 1));
  parts.sphere(j.job, {0.5, 1.3, -0.2}, 0.35, each), parts.paint(glass("glass", j.knobs[1]));
  Material ball = furnace_wall(0.8);
  ball.name = "ball";
  parts.sphere(j.job, {0, 0.6, -0.4}, 0.35, each), parts.paint(ball);
  return parts.take(inside);
}

/// A box with a lamp flush with its ceiling; lamp and walls are of the same albedo. The lamp's radiance makes
/// the mean radiance over all its surfaces 1: what is emitted, π L A, is (1 - ρ) of what leaves all of them.
/// Each wall has a material of its own, so that it can be judged alone.
LitScene closed_box(const SceneJob& j) {
  const Rgb albedo = Rgb::filled(static_cast<float>(j.knobs[0]));
  const double side = j.knobs[1];
  const std::size_t each = j.job.n / 6;
  Painted parts;
  box_room::floor(parts, each), parts.paint(diffuse("floor", albedo));
  box_room::left(parts, each), parts.paint(diffuse("left", albedo));
  box_room::right(parts, each), parts.paint(diffuse("right", albedo));
  box_room::back(parts, each), parts.paint(diffuse("back", albedo));
  box_room::front(parts, each), parts.paint(diffuse("front", albedo));
  box_room::ceiling(parts, side, each), parts.paint(diffuse("ceiling", albedo));
  box_room::ceiling_lamp(parts, side, 2);
  parts.paint(lamp("lamp", (Rgb::filled(1) - albedo) * static_cast<float>(24 / (side * side)), albedo));
  return parts.take({.position = {0, 0.9, 0.98}, .target = {0, 0.95, 0}, .height_angle = 1.6});
}

/// A floor under a square lamp of side 1 m that all but touches it, seen from between them: rays to the
/// lamp's points, chosen by area, seldom reach it where it is near. Neither lamp nor background reflects, so
/// that the floor's light is direct.
LitScene near_contact(const SceneJob& j) {
  const double h = j.knobs[0];
  Painted parts;
  parts.floor(2, j.job.n), parts.paint(diffuse("floor", Rgb::filled(0.5f)));
  parts.sheet({-0.5, h, -0.5}, {1, 0, 0}, {0, 0, 1}, 2), parts.paint(lamp("lamp", Rgb::filled(1)));
  return parts.take({.position = {0, 0.5 * h, 0.1}, .target = {0, 0, 0.1 - 0.3 * h}, .height_angle = 0.9});
}

}  // namespace treeline::datasets
