#include "datasets_gen/hard/hard_shadows.hpp"

#include <cmath>

#include "datasets_gen/scenes/parts.hpp"

namespace treeline::datasets {
namespace {

using shading::LightKind;

constexpr std::size_t scene_faces = 200;  // of the scenes with a name: they are flat, but for the sphere
constexpr int columns = 96, rows = 72;    // of their images
/// Of an image's angle: its pixels lie otherwise in texels each time. Where one falls on one, all see the
/// same.
constexpr double unlike_texels = 0.618034;
constexpr double behind_foot = 1e-3;  // metres: a receiver at the very foot is in the blocker's plane

/// Seen from above, a square of side 2 h of the floor fills the image.
shading::Camera from_above(double h, double height) {
  shading::Camera c;
  c.position = {0, height, 0}, c.target = {0, 0, 0}, c.up = {0, 0, -1};
  c.height_angle = 2 * std::atan(h / height);
  c.width = c.height = rows;
  return c;
}

HardShadow& named(std::vector<HardShadow>& all, std::string name, std::string source, std::string law) {
  HardShadow& c = all.emplace_back();
  c.name = std::move(name), c.source = std::move(source), c.law = std::move(law);
  c.scene.name = c.name;
  return c;
}
/// A scene of scenes/scene.hpp; its name, knobs and all, is that of the case.
HardShadow& of_scene(std::vector<HardShadow>& all, const std::string& scene, std::string source,
                     std::string law) {
  HardShadow& c = named(all, "shadow_" + scene, std::move(source), std::move(law));
  c.scene = make_scene(scene, scene_faces, 1);
  c.scene.camera.width = columns, c.scene.camera.height = rows;
  c.known = known_shadows(scene);
  return c;
}

void add_lit(std::vector<HardShadow>& all) {
  const char* const law = "a plane that nothing stands over is lit";
  for (const char* scene : {"tilted_plane_60_0", "tilted_plane_85_0", "tilted_plane_60_45"})
    of_scene(
        all, scene,
        "derivation: without bias half of a plane shadows itself, with b along the light ½ − b/(s tan θ)",
        law)
        .scene.camera.height_angle *= unlike_texels;
  of_scene(all, "tilted_plane_88_0", "derivation: marches that begin at a grazing floor are stopped by it",
           law);
  HardShadow& flat =
      named(all, "shadow_light_along_normal",
            "Aaltonen 2018: distances along the way double at each step, and h²/2h is all of h", law);
  Parts parts;
  parts.floor(8, scene_faces);
  flat.scene.mesh = std::move(parts.mesh);
  flat.scene.camera = from_above(2, 3);
  flat.scene.light = {.kind = LightKind::disc,
                      .position = {0, 5, 0},
                      .direction = {0, -1, 0},
                      .u = {1, 0, 0},
                      .v = {0, 0, 1}};
  flat.known.all_lit = true;
}

void add_lost(std::vector<HardShadow>& all) {
  of_scene(all, "wall_on_floor_0.01", "derivation: bias b along the light loses b sin θ at a foot",
           "the shadow of a wall begins at its foot");
  of_scene(all, "slab_and_sheet_0.01",
           "Woo 1992: midpoints in a slab of thickness T leave ½ − T/(2 s tan θ) of its top in false shadow",
           "slabs cast shadows, and their tops are lit");
  of_scene(all, "slab_and_sheet_0.0001",
           "derivation: a sheet thinner than a cell of a distance field is not there",
           "a sheet casts the shadow of its outline, however thin it is");
  of_scene(all, "picket_fence_0.01", "derivation: pickets narrower than a texel",
           "pickets cast the shadows that they are wide");
}

void add_leaks(std::vector<HardShadow>& all) {
  const char* const law = "what lies in the shadow of all layers is dark";
  for (const char* r : {"1", "0.5", "0.1"})
    of_scene(all, "two_stacked_" + std::string(r),
             "Lauritzen and McCool 2008; derivation: two depths leak up to 1/(1 + 2r)² through two moments",
             law);
  for (const char* gap : {"1", "0.25", "0.1"})
    of_scene(all, "three_layers_" + std::string(gap),
             "Peters and Klein 2015; derivation: three depths leak through four moments", law);
}

void add_soft(std::vector<HardShadow>& all) {
  const char* const law = "a penumbra is as wide as the formula has it";
  of_scene(all, "half_plane_edge_1_0.5", "closed form: a rectangle over an edge", law).frames = 5;
  of_scene(all, "half_plane_edge_3_0.5", "closed form: a rectangle over an edge, near the light", law);
  for (const char* light : {"0.05", "0.5", "1.5"})
    of_scene(all, "sphere_over_floor_" + std::string(light),
             "light taken out of the integral with its visibility", "a shadow is that of the whole light");
  of_scene(all, "slit_0.25", "closed form: the product or the least of two half shadows is not their union",
           law);

  // Under a light in the plane y = 10: two edges at depths 2 and 9, receivers at 10.
  const auto under_light = [&](const char* name, const char* source) -> HardShadow& {
    HardShadow& c = named(all, name, source, law);
    c.scene.camera = from_above(1.2, 0.9);
    c.scene.light = {.kind = LightKind::rectangle,
                     .position = {0, 10, 0},
                     .direction = {0, -1, 0},
                     .u = {0.5, 0, 0},
                     .v = {0, 0, 0.5}};
    return c;
  };
  HardShadow& two =
      under_light("shadow_edges_far_apart", "derivation: the mean of two blockers' depths is neither's");
  Parts parts;
  parts.floor(12, scene_faces);
  parts.sheet({-6, 8, -6}, {0, 0, 12}, {6.05, 0, 0}, scene_faces);
  parts.sheet({-6, 1, -6}, {0, 0, 12}, {6, 0, 0}, scene_faces);
  two.scene.mesh = std::move(parts.mesh);
  two.known.blockers = {{{{0.05, 8, 0}, {0, 0, 1}, {-1, 0, 0}}, {{0, 1, 0}, {0, 0, 1}, {-1, 0, 0}}}, true};
  two.known.lines.push_back({"edge", {-2, 0, 0.1}, {3, 0, 0.3}});

  HardShadow& strip =
      under_light("shadow_thin_strip", "derivation: sixteen taps of a blocker search miss a thin strip");
  parts = {};
  parts.floor(12, scene_faces);
  parts.sheet({-0.025, 1, -6}, {0, 0, 12}, {0.05, 0, 0}, scene_faces);
  strip.scene.mesh = std::move(parts.mesh);
  strip.known.blockers = {
      {{{0.025, 1, 0}, {0, 0, 1}, {-1, 0, 0}}, {{-0.025, 1, 0}, {0, 0, 1}, {-1, 0, 0}, -1}}, false};
}

void add_volumes(std::vector<HardShadow>& all) {
  for (const char* slide : {"0", "1.45"})
    of_scene(all, "eye_inside_volume_" + std::string(slide),
             "Heidmann 1991; Bilodeau and Songy 1999, Carmack 2000: counts from the eye are off where it is "
             "inside",
             "what the eye sees does not depend on what shadow it is in");
  of_scene(all, "open_casters", "Bergeron 1986: open casters",
           "a caster shadows as its faces do, closed or not");
  of_scene(all, "non_manifold", "Kim et al. 2008: edges of more faces than two",
           "a caster shadows as its faces do, manifold or not");
}

}  // namespace

bool is_scene_of(const std::string& scene, const std::string& name) {
  return scene == name || scene.starts_with(name + "_");
}

std::vector<double> scene_knobs(const std::string& scene, const std::string& name) {
  std::vector<double> out;
  for (const KnobRecipe& recipe : scene_recipes())
    if (recipe.name == name)
      for (const Knob& knob : recipe.knobs) out.push_back(knob.value);
  std::size_t at = name.size();
  for (double& value : out) {
    if (at >= scene.size()) break;
    const std::size_t end = std::min(scene.find('_', at + 1), scene.size());
    value = std::stod(scene.substr(at + 1, end - at - 1));
    at = end;
  }
  return out;
}

KnownShadows known_shadows(const std::string& scene) {
  KnownShadows k;
  if (is_scene_of(scene, "tilted_plane")) k.all_lit = true;
  if (is_scene_of(scene, "half_plane_edge")) {
    const auto knobs = scene_knobs(scene, "half_plane_edge");
    k.blockers.planes.push_back({{0, knobs[0], 0}, {0, 0, 1}, {-1, 0, 0}});
    const double w = knobs[1] * knobs[0] / (4 - knobs[0]), reach = 1.5 * w + 0.05;
    k.lines.push_back({"edge", {-reach, 0, 0}, {reach, 0, 0.2}});
  }
  if (is_scene_of(scene, "slit")) {
    const double half = 0.5 * scene_knobs(scene, "slit")[0];
    k.blockers.planes = {{{-half, 2, 0}, {0, 0, 1}, {-1, 0, 0}}, {{half, 2, 0}, {0, 0, 1}, {1, 0, 0}}};
  }
  if (is_scene_of(scene, "wall_on_floor")) {
    const double half = 0.5 * scene_knobs(scene, "wall_on_floor")[0];
    k.lines.push_back({"contact", {half + behind_foot, 0, 0}, {half + 0.5, 0, 0.1}});
  }
  if (is_scene_of(scene, "slab_and_sheet")) {
    const double top = 1 + scene_knobs(scene, "slab_and_sheet")[0];
    k.lines.push_back({"top", {-2.05, top, -0.85}, {-0.45, top, 0.85}});
  }
  if (is_scene_of(scene, "two_stacked")) k.lines.push_back({"leak", {-1.5, 0, 0.1}, {0.9, 0, -0.1}});
  if (is_scene_of(scene, "three_layers")) k.lines.push_back({"leak", {-1, 0, -0.9}, {1, 0, 0.9}});
  return k;
}

std::vector<HardShadow> hard_shadows() {
  std::vector<HardShadow> all;
  add_lit(all), add_lost(all), add_leaks(all), add_soft(all), add_volumes(all);
  return all;
}

}  // namespace treeline::datasets
