// The table of surfaces.
#include <stdexcept>
#include <vector>

#include "datasets_gen/surfaces/surface.hpp"

namespace treeline::datasets {
namespace {

using Numbers = std::vector<double>;

struct Entry {
  KnobRecipe recipe;
  shading::Material (*make)(const Numbers& knobs);
};

shading::Material lambert(const Numbers& knobs) {
  shading::Material m;
  m.reflectance = shading::Rgb::filled(static_cast<float>(knobs[0]));
  return m;
}

const std::vector<Entry>& table() {
  static const std::vector<Entry> entries{
      {{"lambert", "the same radiance in all directions", {{"albedo", 0.5, 0, 1}}}, lambert},
  };
  return entries;
}

const Entry* entry_of(std::string_view name) {
  for (const Entry& e : table())
    if (names(name, e.recipe)) return &e;
  return nullptr;
}

}  // namespace

std::span<const KnobRecipe> surface_recipes() {
  static const std::vector<KnobRecipe> list = [] {
    std::vector<KnobRecipe> r;
    for (const Entry& e : table()) r.push_back(e.recipe);
    return r;
  }();
  return list;
}

bool is_surface(std::string_view name) { return entry_of(name) != nullptr; }

shading::Material make_surface(std::string_view name) {
  const Entry* const entry = entry_of(name);
  if (!entry) {
    std::string known;
    for (const Entry& e : table()) known += (known.empty() ? "" : ", ") + e.recipe.name;
    throw std::invalid_argument("no surface is called '" + std::string(name) + "'; known: " + known);
  }
  shading::Material material = entry->make(read_knobs("surface", name, entry->recipe));
  material.name = name;
  return material;
}

}  // namespace treeline::datasets
