// The table of rooms.
#include <stdexcept>
#include <vector>

#include "datasets_gen/rooms/room.hpp"
#include "datasets_gen/scenes/parts.hpp"

namespace treeline::datasets {
namespace {

struct Entry {
  KnobRecipe recipe;
  shading::LitScene (*make)(const SceneJob&);
};

/// A closed box seen from inside: all of it is of one albedo and emits.
shading::LitScene furnace_room(const SceneJob& job) {
  shading::LitScene room;
  Parts parts;
  parts.box({-1, 0, -1}, {1, 2, 1}, box_cells(job.job.n));
  room.mesh = std::move(parts.mesh);
  for (auto& face : room.mesh.faces) std::swap(face[1], face[2]);  // seen from inside
  shading::Material wall;
  wall.name = "wall";
  const auto albedo = static_cast<float>(job.knobs[0]);
  wall.reflectance = shading::Rgb::filled(albedo), wall.emission = shading::Rgb::filled(1 - albedo);
  room.materials = {wall};
  room.face_materials.assign(room.mesh.size(), 0);
  room.camera = {.position = {0, 1, 0.9}, .target = {0, 1, 0}};
  return room;
}

const std::vector<Entry>& table() {
  static const std::vector<Entry> entries{
      {{"furnace_room", "a box of walls that emit: radiance is 1 everywhere", {{"albedo", 0.5, 0, 0.99}}},
       furnace_room},
  };
  return entries;
}

constexpr std::size_t least_n = 12, largest_n = 10'000'000;

const Entry* entry_of(std::string_view name) {
  for (const Entry& e : table())
    if (names(name, e.recipe)) return &e;
  return nullptr;
}

}  // namespace

std::span<const KnobRecipe> room_recipes() {
  static const std::vector<KnobRecipe> list = [] {
    std::vector<KnobRecipe> r;
    for (const Entry& e : table()) r.push_back(e.recipe);
    return r;
  }();
  return list;
}

bool is_room(std::string_view name) { return entry_of(name) != nullptr; }

shading::LitScene make_room(std::string_view name, std::size_t n, std::uint64_t seed,
                            const Progress& progress) {
  const Entry* const entry = entry_of(name);
  if (!entry) {
    std::string known;
    for (const Entry& e : table()) known += (known.empty() ? "" : ", ") + e.recipe.name;
    throw std::invalid_argument("no room is called '" + std::string(name) + "'; known: " + known);
  }
  if (n < least_n || n > largest_n)
    throw std::invalid_argument("n = " + std::to_string(n) + " is out of range: rooms have " +
                                std::to_string(least_n) + " to " + std::to_string(largest_n) + " triangles");
  Ticker ticker(progress);
  const Job job{n, seed, ticker};
  shading::LitScene room = entry->make({job, read_knobs("room", name, entry->recipe)});
  room.name = name;
  return room;
}

}  // namespace treeline::datasets
