// Rooms of the kind that light transport is shown with: boxes with one side open, mirrors, glass, lamps of
// many sizes, a building under a sky.
#include <algorithm>

#include "datasets_gen/rooms/painted.hpp"

namespace treeline::datasets {
namespace {

const Rgb white{0.73f, 0.73f, 0.73f}, red{0.63f, 0.06f, 0.05f}, green{0.14f, 0.45f, 0.09f},
    warm{18, 13, 6.5f};

/// After the box at Cornell (Goral et al. 1984): white, a red and a green wall, a warm lamp.
void cornell_walls(Painted& parts, std::size_t faces) {
  constexpr double lamp_side = 0.5;
  const std::size_t each = faces / 5;
  box_room::floor(parts, each), parts.paint(diffuse("floor", white));
  box_room::back(parts, each), parts.paint(diffuse("back", white));
  box_room::ceiling(parts, lamp_side, each), parts.paint(diffuse("ceiling", white));
  box_room::left(parts, each), parts.paint(diffuse("left", red));
  box_room::right(parts, each), parts.paint(diffuse("right", green));
  box_room::ceiling_lamp(parts, lamp_side, 2), parts.paint(lamp("lamp", warm, white));
}

}  // namespace

LitScene cornell_box(const SceneJob& j) {
  Painted parts;
  cornell_walls(parts, j.job.n / 2);
  parts.block(-0.35, -0.35, 0.3, 1.2, 0.05, j.job.n / 4), parts.paint(diffuse("tall", white));
  parts.block(0.35, 0.3, 0.3, 0.6, -0.047, j.job.n / 4), parts.paint(diffuse("short", white));
  return parts.take(box_room::outside());
}

/// The same box with a mirror and a glass sphere: light that is bundled by them reaches the floor by no ray
/// that aims at the lamp.
LitScene glass_and_mirror(const SceneJob& j) {
  Painted parts;
  cornell_walls(parts, j.job.n / 3);
  parts.sphere(j.job, {-0.45, 0.45, -0.4}, 0.45, j.job.n / 3), parts.paint(mirror("mirror", 0.95f));
  parts.sphere(j.job, {0.45, 0.45, 0.35}, 0.45, j.job.n / 3), parts.paint(glass("glass", j.knobs[0]));
  return parts.take(box_room::outside());
}

/// A long hall whose two long walls are mirrors: a ball and a lamp, seen again and again.
LitScene mirror_hall(const SceneJob& j) {
  const auto reflectance = static_cast<float>(j.knobs[0]);
  const std::size_t each = j.job.n / 7;
  Painted parts;
  box_room::floor(parts, each), parts.paint(diffuse("floor", {0.6f, 0.5f, 0.4f}));
  box_room::ceiling(parts, 0.4, each), parts.paint(diffuse("ceiling", white));
  box_room::back(parts, each), parts.paint(diffuse("back", {0.4f, 0.5f, 0.7f}));
  box_room::front(parts, each), parts.paint(diffuse("front", white));
  box_room::left(parts, each), box_room::right(parts, each), parts.paint(mirror("mirrors", reflectance));
  parts.sphere(j.job, {0.25, 0.3, -0.3}, 0.3, each), parts.paint(diffuse("ball", red));
  box_room::ceiling_lamp(parts, 0.4, 2), parts.paint(lamp("lamp", Rgb::filled(12)));
  return parts.take({.position = {0.75, 0.9, 0.9}, .target = {-0.6, 0.6, -0.4}, .height_angle = 1.1});
}

/// Panes of glass one behind the other before a lit wall, and nothing else: at each of their surfaces a ray
/// becomes two.
LitScene glass_panes(const SceneJob& j) {
  const auto panes = static_cast<std::size_t>(j.knobs[0]);
  constexpr double half = 1, thick = 0.04;
  Painted parts;
  for (std::size_t k = 0; k < panes; ++k) {
    const double z = -0.15 * double(k);
    parts.box({-half, -half, z - thick}, {half, half, z}, box_cells(j.job.n / panes));
  }
  parts.paint(glass("panes", 1.5));
  const double end = -0.15 * double(panes) - 0.2;
  parts.sheet({-3, -3, end}, {6, 0, 0}, {0, 6, 0}, 2), parts.paint(lamp("wall", {1, 0.9f, 0.7f}));
  LitScene room = parts.take({.position = {0, 0, 2}, .target = {0.3, 0.2, 0}, .height_angle = 0.6});
  room.background = {0.1f, 0.15f, 0.3f};
  return room;
}

/// After Veach 1995: four plates of growing roughness that mirror four lamps of growing size, turned so that
/// they meet. Small lamps are found by aiming at them, wide ones in smooth plates by the plate's own
/// reflection.
LitScene plates_and_lamps(const SceneJob& j) {
  constexpr double alpha[] = {0.005, 0.02, 0.07, 0.2}, radius[] = {0.03, 0.1, 0.27, 0.6};
  constexpr double pitch = 1.7, lamp_height = 3.2;
  const Vec3d eye{0, 2.2, 8};
  Painted parts;
  const std::size_t each = j.job.n / 10;
  parts.sheet({-6, -1.2, -4}, {0, 0, 12}, {12, 0, 0}, each);
  parts.sheet({-6, -1.2, -4}, {12, 0, 0}, {0, 8, 0}, each);
  parts.paint(diffuse("stage", Rgb::filled(0.4f)));
  for (std::size_t k = 0; k < 4; ++k) {
    // Middle, and a normal halfway between the eye and the lamps.
    const Vec3d middle{0, -0.9 + 0.5 * double(3 - k), 3.2 - 1.1 * double(3 - k)};
    const Vec3d to_eye = unit_portable(sum(eye, scaled(middle, -1)));
    const Vec3d to_lamps = unit_portable(sum({0, lamp_height, -1}, scaled(middle, -1)));
    const Vec3d across{1, 0, 0}, deep = unit_portable(cross_portable(across, sum(to_eye, to_lamps)));
    const double half = 0.42;
    const Vec3d corner = sum(middle, sum({-3, 0, 0}, scaled(deep, half)));
    parts.sheet(corner, {6, 0, 0}, scaled(deep, -2 * half), each);
    parts.paint(metal("plate " + std::to_string(k), Rgb::filled(0.8f), alpha[k]));
    // As much light from each.
    const auto radiance = static_cast<float>(0.5 / (radius[k] * radius[k]));
    parts.sphere(j.job, {pitch * (double(k) - 1.5), lamp_height, -1}, radius[k], each);
    constexpr float tint[4][3] = {{1, 0.7f, 0.4f}, {1, 1, 0.8f}, {0.7f, 1, 0.8f}, {0.7f, 0.8f, 1}};
    parts.paint(lamp("lamp " + std::to_string(k), Rgb{tint[k][0], tint[k][1], tint[k][2]} * radiance));
  }
  return parts.take({.position = eye, .target = {0, 0.2, 0}, .height_angle = 0.85});
}

/// The mesh `architecture` in the light of an even sky, from inside: it comes in by windows alone.
LitScene architecture_under_sky(const SceneJob& j) {
  Painted parts;
  parts.add(architecture(j.job));
  for (auto& p : parts.mesh.vertices) p = {p[0], p[2], -p[1]};  // it stands on z
  parts.paint(diffuse("building", {0.7f, 0.65f, 0.6f}));
  LitScene room = parts.take({.position = {1.2, 1.7, -4.6}, .target = {9, 1.4, -2.2}, .height_angle = 1});
  room.background = {0.8f, 0.95f, 1.2f};
  return room;
}

/// A floor, a lamp above and an even sky for any mesh.
LitScene room_of_mesh(geometry::Mesh3f mesh, std::string name) {
  const std::size_t faces = mesh.size();
  const shading::Scene staged = scene_of_mesh(std::move(mesh), name);
  const auto box = staged.mesh.box();
  LitScene room;
  room.name = std::move(name), room.mesh = staged.mesh, room.camera = staged.camera;
  room.materials = {diffuse("mesh", {0.7f, 0.6f, 0.5f}), diffuse("floor", Rgb::filled(0.5f)),
                    lamp("lamp", Rgb::filled(12))};
  room.face_materials.assign(faces, 0);
  room.face_materials.resize(room.mesh.size(), 1);
  // A square of a tenth of the floor's width, above it to the side, that looks down.
  const double width = double(box.extent()[0]), side = 0.1 * width;
  const Vec3d centre(box.centre());
  const double top = double(box.high[1]) + 0.2 * width;
  Parts square;
  square.sheet({centre[0] - 0.2 * width, top, centre[2]}, {side, 0, 0}, {0, 0, side}, 2);
  Parts all;
  all.mesh = std::move(room.mesh), all.add(square.mesh);
  room.mesh = std::move(all.mesh);
  room.face_materials.resize(room.mesh.size(), 2);
  room.background = {0.3f, 0.35f, 0.45f};
  return room;
}

}  // namespace treeline::datasets
