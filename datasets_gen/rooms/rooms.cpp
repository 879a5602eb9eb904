// The table of rooms.
#include <stdexcept>
#include <vector>

#include "datasets_gen/recipe_table.hpp"
#include "datasets_gen/rooms/painted.hpp"

namespace treeline::datasets {
namespace {

struct Entry {
  KnobRecipe recipe;
  shading::LitScene (*make)(const SceneJob&);
};

const std::vector<Entry>& table() {
  static const std::vector<Entry> entries{
      {{"furnace_room", "a box of walls that emit: radiance is 1 everywhere", {{"albedo", 0.5, 0, 0.99}}},
       furnace_room},
      {{"furnace_spheres",
        "the same with a mirror, glass and a ball in it",
        {{"albedo", 0.5, 0, 0.99}, {"index", 1.5, 1.01, 4}}},
       furnace_spheres},
      {{"closed_box",
        "a box with a lamp in its ceiling: mean radiance is 1",
        {{"albedo", 0.75, 0, 0.99}, {"lamp_m", 0.6, 0.005, 1.9}}},
       closed_box},
      {{"near_contact", "a floor that a square lamp all but touches", {{"height_m", 0.01, 1e-5, 1}}},
       near_contact},
      {{"cornell_box", "a red and a green wall, and two blocks", {}}, cornell_box},
      {{"glass_and_mirror", "a glass and a mirror ball in the same box", {{"index", 1.5, 1.01, 4}}},
       glass_and_mirror},
      {{"mirror_hall", "two mirrors that face each other", {{"reflectance", 0.9, 0, 1}}}, mirror_hall},
      {{"glass_panes", "panes of glass before a lit wall: rays that split", {{"panes", 3, 1, 20}}},
       glass_panes},
      {{"plates_and_lamps", "plates of growing roughness that mirror lamps of growing size", {}},
       plates_and_lamps},
      {{"architecture_under_sky", "the building of `architecture`, lit through its windows", {}},
       architecture_under_sky},
  };
  return entries;
}

constexpr std::size_t least_n = 12, largest_n = 10'000'000;

}  // namespace

std::span<const KnobRecipe> room_recipes() {
  static const std::vector<KnobRecipe> list = recipes_in(table());
  return list;
}

bool is_room(std::string_view name) { return find_entry(table(), name) != nullptr; }

shading::LitScene make_room(std::string_view name, std::size_t n, std::uint64_t seed,
                            const Progress& progress) {
  const Entry& entry = entry_called(table(), "room", name);
  if (n < least_n || n > largest_n)
    throw std::invalid_argument("n = " + std::to_string(n) + " is out of range: rooms have " +
                                std::to_string(least_n) + " to " + std::to_string(largest_n) + " triangles");
  Ticker ticker(progress);
  const Job job{n, seed, ticker};
  shading::LitScene room = entry.make({job, read_knobs("room", name, entry.recipe)});
  room.name = name;
  return room;
}

}  // namespace treeline::datasets
