#include "datasets_gen/hard/hard_light.hpp"

#include <limits>

#include "datasets_gen/rooms/painted.hpp"

namespace treeline::datasets {
namespace {

constexpr int side = 20;  // of the images, in pixels
constexpr std::size_t room_faces = 300;
const Rgb one = Rgb::filled(1);

LitScene sized(LitScene room) {
  room.camera.width = room.camera.height = side;
  return room;
}
LitScene of(const std::string& recipe) { return sized(make_room(recipe, room_faces, 1)); }

/// A furnace, scaled and moved: its vertices are rounded, and it stays closed.
LitScene furnace_at(double scale, double away) {
  LitScene room = of("furnace_room");
  const auto placed = [&](const Vec3d& p) { return sum(scaled(p, scale), {away, away, away}); };
  for (auto& v : room.mesh.vertices) v = rounded(placed(Vec3d(v)));
  room.camera.position = placed(room.camera.position), room.camera.target = placed(room.camera.target);
  return room;
}

/// A furnace with something more in it.
template <class Add>
LitScene furnace_with(const Add& add) {
  Painted parts;
  parts.box({-1, 0, -1}, {1, 2, 1});
  parts.turn_over();
  parts.paint(lamp("wall", Rgb::filled(0.5f), Rgb::filled(0.5f)));
  add(parts);
  return sized(parts.take({.position = {0, 1, 0.9}, .target = {0, 1, 0}, .height_angle = 1}));
}

void sphere(Painted& parts, std::size_t n, const Material& material) {
  const Progress none;
  Ticker ticker(none);
  const Job job{n, 1, ticker};
  parts.sphere(job, {0, 1, -0.2}, 0.5, n), parts.paint(material);
}

LitScene lamp_alone() {
  Painted parts;
  parts.sheet({-4, -4, 0}, {8, 0, 0}, {0, 8, 0}, 2), parts.paint(lamp("lamp", one));
  return sized(parts.take({.position = {0, 0, 1}, .target = {0, 0, 0}}));
}

LitScene dark() {
  LitScene room = of("cornell_box");
  for (Material& m : room.materials) m.emission = {};
  return room;
}

/// One of the box's materials or faces is none.
template <class Break>
std::function<LitScene()> broken(const Break& change) {
  return [change] {
    LitScene room = of("closed_box");
    change(room);
    return room;
  };
}

void add_contact(std::vector<HardLight>& all) {
  for (const char* height : {"0.1", "0.01", "0.001"}) {
    HardLight c;
    c.name = std::string("light_contact_") + height;
    c.source =
        "derivation: points of a lamp of area A, drawn evenly, at height h have a relative variance of "
        "A/(3 π h²) − 1";
    c.law = "a floor that a lamp all but touches gets its light from it";
    c.make = [room = std::string("near_contact_") + height] { return of(room); };
    c.by_name = true, c.seldom = true;
    all.push_back(std::move(c));
  }
}

void add_furnaces(std::vector<HardLight>& all) {
  const char* const law = "where all surfaces emit 1 less their albedo, radiance is 1";
  const auto add = [&](std::string name, std::string source, std::function<LitScene()> make) {
    HardLight& c = all.emplace_back();
    c.name = std::move(name), c.source = std::move(source), c.law = law, c.make = std::move(make);
    c.radiance = one;
  };
  add("light_albedo_0.95", "Russian roulette: paths are sixty surfaces long",
      [] { return of("furnace_room_0.95"); });
  add("light_far_away", "float: at 10 km places are a millimetre apart", [] { return furnace_at(1, 1e4); });
  add("light_tiny_room", "offsets of rays that are lengths and no shares of the scene",
      [] { return furnace_at(1e-6, 0); });
  add("light_huge_room", "the same, and squares of distances", [] { return furnace_at(1e6, 0); });
  add("light_glass_and_mirror", "Veach 1995: only mirrors and glass count what they meet by chance",
      [] { return of("furnace_spheres"); });
  add("light_smooth_metal", "float: GGX at h = n overflows at a roughness of 1e-4 in the textbook's form",
      [] { return furnace_with([](Painted& p) { sphere(p, room_faces, metal("metal", one, 1e-4)); }); });
  all.back().seldom = true;
  add("light_flat_lamps", "faces without area have no point to be drawn, and no normal", [] {
    return furnace_with([](Painted& p) {
      const auto first = static_cast<std::uint32_t>(p.mesh.vertices.size());
      for (const float x : {-0.5f, 0.0f, 0.5f}) p.mesh.vertices.push_back({x, 1, -0.5f});
      p.mesh.faces.push_back({first, first + 1, first + 2}), p.mesh.faces.push_back({first, first, first});
      p.paint(lamp("flat", Rgb::filled(100)));
    });
  });
}

void add_lamps(std::vector<HardLight>& all) {
  HardLight tiny;
  tiny.name = "light_tiny_lamp",
  tiny.source = "fireflies: a lamp of 2 cm, met by chance once in 10^5 bounces";
  tiny.law = "rare samples are as bright as they are rare";
  tiny.make = [] { return of("closed_box_0.75_0.02"); };
  tiny.by_name = true, tiny.seldom = true;
  all.push_back(std::move(tiny));
  HardLight seen;
  seen.name = "light_lamp_alone", seen.source = "the textbook's path tracer: what is seen first never emits";
  seen.law = "a lamp is seen as it emits";
  seen.make = lamp_alone, seen.radiance = one;
  all.push_back(std::move(seen));
  HardLight none;
  none.name = "light_none", none.source = "no lamp to draw a point of", none.law = "without light it is dark";
  none.make = dark, none.radiance = Rgb{};
  all.push_back(std::move(none));
  HardLight mirrors;
  mirrors.name = "light_endless_mirrors";
  mirrors.source = "two mirrors that lose nothing: only chance ends a path between them";
  mirrors.law = "each image of the lamp in them is as bright as itself";
  mirrors.make = [] { return of("mirror_hall_1"); };
  all.push_back(std::move(mirrors));
}

void add_meaningless(std::vector<HardLight>& all) {
  const auto add = [&](const char* name, const char* law, auto change) {
    HardLight& c = all.emplace_back();
    c.name = name, c.source = "derivation: no radiance solves it", c.law = law, c.make = broken(change);
    c.expect = Expect::answers_or_refuses, c.meaningless = true;
  };
  add("light_nan_emission", "emission that is no number is refused",
      [](LitScene& room) { room.materials.back().emission[1] = std::numeric_limits<float>::quiet_NaN(); });
  add("light_negative_emission", "a lamp that takes light away is refused",
      [](LitScene& room) { room.materials.back().emission[0] = -1; });
  add("light_albedo_above_1", "a wall that gives back more than it gets is refused",
      [](LitScene& room) { room.materials.front().reflectance[2] = 1.5f; });
  add("light_face_without_material", "a face of no material is refused",
      [](LitScene& room) { room.face_materials.pop_back(); });
  add("light_unknown_material", "a face of a material that is not there is refused",
      [](LitScene& room) { room.face_materials.front() = 99; });
  for (const auto& [name, scale] : {std::pair("light_room_of_1e-20", 1e-20), {"light_room_of_1e20", 1e20}}) {
    add(name, "a room so small or large that squares of distances leave float's range is refused",
        [](LitScene&) {});
    all.back().source = "float: squares of distances";
    all.back().make = [scale = scale] { return furnace_at(scale, 0); };
  }
}

}  // namespace

std::vector<HardLight> hard_lights() {
  std::vector<HardLight> all;
  add_contact(all), add_furnaces(all), add_lamps(all), add_meaningless(all);
  return all;
}

}  // namespace treeline::datasets
