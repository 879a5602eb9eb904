// The table of scenes, and the reading of their names.
#include <algorithm>
#include <charconv>
#include <stdexcept>

#include "datasets_gen/scenes/parts.hpp"

namespace treeline::datasets {
namespace {

struct Entry {
  SceneRecipe recipe;
  shading::Scene (*make)(const SceneJob&);
};

const std::vector<Entry>& table() {
  static const std::vector<Entry> entries{
      {{"tilted_plane",
        "a plane seen by the light at an angle: acne",
        {{"theta_deg", 60, 0, 89.9}, {"phi_deg", 0, -360, 360}}},
       tilted_plane},
      {{"wall_on_floor",
        "a thin wall that stands on the floor: contact gaps",
        {{"thickness_m", 0.1, 0.001, 2}}},
       wall_on_floor},
      {{"slab_and_sheet",
        "thin slabs and a sheet, some resting: midpoints",
        {{"thickness_m", 0.05, 0.0001, 1}}},
       slab_and_sheet},
      {{"half_plane_edge",
        "half a plane under a rectangle light: penumbrae",
        {{"height_m", 1, 0.05, 3.5}, {"light_m", 0.5, 0.001, 2}}},
       half_plane_edge},
      {{"sphere_over_floor", "a sphere under a disc light", {{"light_radius_m", 0.5, 0.001, 2}}},
       sphere_over_floor},
      {{"two_stacked", "two levels of occluders: leaks of two moments", {{"r", 0.5, 0.02, 20}}}, two_stacked},
      {{"three_layers", "three levels of occluders: leaks of four moments", {{"gap_m", 0.25, 0.02, 2}}},
       three_layers},
      {{"slit", "light through a slit: what two half shadows add up to", {{"offset", 0.25, 0.02, 1.5}}},
       slit},
      {{"picket_fence", "two fences of thin pickets: aliasing", {{"picket_m", 0.04, 0.01, 0.5}}},
       picket_fence},
      {{"leaves", "the leaves of forest on its ground", {}}, leaves},
      {{"city", "houses and streets, seen to the end of one: cascades", {}}, city},
      {{"open_casters", "casters that are not closed", {}}, open_casters},
      {{"non_manifold", "casters with edges of three and four faces, and a doubled one", {}}, non_manifold},
      {{"eye_inside_volume", "the eye in the shadow of a box", {{"slide_m", 0, -3, 3}}}, eye_inside_volume},
  };
  return entries;
}

constexpr std::size_t least_n = 12, largest_n = 10'000'000;

/// The entry whose name the text is or begins with, before knobs; null if there is none.
const Entry* entry_of(std::string_view name) {
  for (const Entry& e : table())
    if (name == e.recipe.name || name.starts_with(e.recipe.name + "_")) return &e;
  return nullptr;
}

std::string quoted(std::string_view text) { return std::string("'").append(text).append("'"); }

std::vector<double> read_knobs(std::string_view name, const SceneRecipe& recipe) {
  std::vector<double> knobs;
  for (const SceneKnob& knob : recipe.knobs) knobs.push_back(knob.value);
  std::string_view rest = name.substr(recipe.name.size());
  const auto refuse = [&](const std::string& why) {
    throw std::invalid_argument("scene '" + std::string(name) + "': " + why);
  };
  for (std::size_t k = 0; !rest.empty(); ++k) {
    rest.remove_prefix(1);
    const std::string_view text = rest.substr(0, rest.find('_'));
    rest.remove_prefix(text.size());
    if (k == knobs.size())
      refuse(quoted(text) + " is one too many, " + recipe.name + " has " + std::to_string(knobs.size()) +
             " knobs");
    const SceneKnob& knob = recipe.knobs[k];
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), knobs[k]);
    if (error != std::errc() || end != text.data() + text.size())
      refuse(quoted(text) + " is no number for " + knob.name);
    if (!(knobs[k] >= knob.low && knobs[k] <= knob.high))
      refuse(knob.name + " is " + std::string(text) + "; it must be from " + std::to_string(knob.low) +
             " to " + std::to_string(knob.high));
  }
  return knobs;
}

}  // namespace

std::span<const SceneRecipe> scene_recipes() {
  static const std::vector<SceneRecipe> list = [] {
    std::vector<SceneRecipe> r;
    for (const Entry& e : table()) r.push_back(e.recipe);
    return r;
  }();
  return list;
}

std::vector<std::string> scene_names() {
  std::vector<std::string> names;
  for (const Entry& e : table()) names.push_back(e.recipe.name);
  return names;
}

bool is_scene(std::string_view name) { return entry_of(name) != nullptr; }

shading::Scene make_scene(std::string_view name, std::size_t n, std::uint64_t seed,
                          const Progress& progress) {
  const Entry* const entry = entry_of(name);
  if (!entry) {
    std::string known;
    for (const Entry& e : table()) known += (known.empty() ? "" : ", ") + e.recipe.name;
    throw std::invalid_argument("no scene is called '" + std::string(name) + "'; known: " + known);
  }
  if (n < least_n || n > largest_n)
    throw std::invalid_argument("n = " + std::to_string(n) + " is out of range: scenes have " +
                                std::to_string(least_n) + " to " + std::to_string(largest_n) + " triangles");
  Ticker ticker(progress);
  const Job job{n, seed, ticker};
  shading::Scene scene = entry->make({job, read_knobs(name, entry->recipe)});
  scene.name = name;
  return scene;
}

}  // namespace treeline::datasets
