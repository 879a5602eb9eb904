// The table of scenes.
#include <algorithm>
#include <stdexcept>

#include "datasets_gen/recipe_table.hpp"
#include "datasets_gen/scenes/parts.hpp"

namespace treeline::datasets {
namespace {

struct Entry {
  KnobRecipe recipe;
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

}  // namespace

std::span<const KnobRecipe> scene_recipes() {
  static const std::vector<KnobRecipe> list = recipes_in(table());
  return list;
}

std::vector<std::string> scene_names() {
  std::vector<std::string> names;
  for (const Entry& e : table()) names.push_back(e.recipe.name);
  return names;
}

bool is_scene(std::string_view name) { return find_entry(table(), name) != nullptr; }

shading::Scene make_scene(std::string_view name, std::size_t n, std::uint64_t seed,
                          const Progress& progress) {
  const Entry& entry = entry_called(table(), "scene", name);
  if (n < least_n || n > largest_n)
    throw std::invalid_argument("n = " + std::to_string(n) + " is out of range: scenes have " +
                                std::to_string(least_n) + " to " + std::to_string(largest_n) + " triangles");
  Ticker ticker(progress);
  const Job job{n, seed, ticker};
  shading::Scene scene = entry.make({job, read_knobs("scene", name, entry.recipe)});
  scene.name = name;
  return scene;
}

}  // namespace treeline::datasets
