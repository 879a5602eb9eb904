// The table of recipes, and generate().
#include <algorithm>
#include <array>
#include <stdexcept>

#include "datasets_gen/meshes/damage.hpp"
#include "datasets_gen/recipe.hpp"
#include "datasets_gen/rooms/room.hpp"
#include "datasets_gen/scenes/scene.hpp"
#include "datasets_gen/surfaces/surface.hpp"
#include "datasets_gen/textures/independent.hpp"
#include "geometry/adjacency.hpp"

namespace treeline::datasets {
namespace {

using MakeCloud = geometry::Cloud3f (*)(const Job&);
using MakePrecise = geometry::Cloud3d (*)(const Job&);
using MakeMesh = geometry::Mesh3f (*)(const Job&);
using MakeVectors = Vectors (*)(const Job&, std::size_t columns);
using MakeImage = shading::Image (*)(const Job&);

struct Entry {
  Recipe recipe;
  MakeCloud make_cloud = nullptr;
  MakePrecise make_precise = nullptr;
  MakeMesh make_mesh = nullptr;
  MakeVectors make_vectors = nullptr;
  std::size_t columns = 0;
  MakeImage make_image = nullptr;
  bool independent = false;  // pixels_are_independent()
};

Entry cloud(MakeCloud make, const char* name, const char* summary) {
  return {.recipe = {name, Kind::cloud, summary, false}, .make_cloud = make};
}
Entry precise(MakePrecise make, const char* name, const char* summary) {
  return {.recipe = {name, Kind::cloud, summary, false, true}, .make_precise = make};
}
Entry mesh(MakeMesh make, const char* name, bool closed, const char* summary) {
  return {.recipe = {name, Kind::mesh, summary, closed}, .make_mesh = make};
}
Entry vectors(MakeVectors make, const char* name, std::size_t columns, const char* summary) {
  return {.recipe = {name, Kind::vectors, summary, false}, .make_vectors = make, .columns = columns};
}

Entry image(MakeImage make, const char* name, const char* summary, bool independent = false) {
  return {.recipe = {name, Kind::image, summary, false}, .make_image = make, .independent = independent};
}

const std::array<Entry, 26>& table() {
  static const std::array<Entry, 26> entries{
      cloud(uniform_cube, "uniform_cube", "uniform in the unit cube"),
      cloud(uniform_ball, "uniform_ball", "uniform in the unit ball"),
      cloud(displaced_sphere, "displaced_sphere", "on the surface of a rough sphere"),
      cloud(clusters, "clusters", "64 Gaussian clusters, of sizes 1, 1/2, 1/3 … and uneven widths"),
      cloud(lidar, "lidar", "sweeps of a 64-ring scanner along a street: density falls with distance"),
      cloud(filaments, "filaments", "32 thin curved threads"),
      cloud(grid, "grid", "a regular grid: every distance tied"),
      precise(georeferenced, "georeferenced",
              "the street of lidar in UTM metres, to the millimetre: for doubles"),
      mesh(icosphere, "icosphere", true, "a rough sphere of even triangles, closed"),
      mesh(terrain, "terrain", false, "a height field of hills and ridges"),
      mesh(architecture, "architecture", false, "large walls, long thin beams and columns, fine ornament"),
      mesh(forest, "forest", false, "a soup of small leaves in tree crowns, no shared corners"),
      mesh(nested_shells, "nested_shells", true,
           "eight rough spheres, one inside the other, facing in turn, closed"),
      mesh(torus_knot, "torus_knot", true, "a knotted tube, closed"),
      vectors(descriptors, "descriptors_8", 8, "clusters of 8 latent dimensions, bent into 8 columns"),
      vectors(descriptors, "descriptors_32", 32, "clusters of 8 latent dimensions, bent into 32 columns"),
      vectors(descriptors, "descriptors_128", 128, "clusters of 8 latent dimensions, bent into 128 columns"),
      vectors(uniform_vectors, "uniform_8", 8, "uniform in the unit cube of 8 dimensions"),
      vectors(uniform_vectors, "uniform_32", 32, "uniform in the unit cube of 32 dimensions"),
      vectors(uniform_vectors, "uniform_128", 128, "uniform in the unit cube of 128 dimensions"),
      image(noise, "noise", "a random level of 256 in each pixel: nothing to compress, nothing to guess",
            true),
      image(ramp, "ramp", "a plane in floats, brighter to the right and downwards"),
      image(checkers, "checkers", "boards of squares of 1 to 64 pixels, black and white"),
      image(mask, "mask", "blobs and threads of black and white, as of leaves and fences"),
      image(star, "star", "spokes and rings whose frequency rises to one pixel"),
      image(marble, "marble", "veins of four channels, 8 bits each"),
  };
  return entries;
}

const std::array<Entry, 2>& special_table() {
  static const std::array<Entry, 2> entries{
      mesh(needles, "needles", false,
           "a soup of triangles with one short side, aspect ratios from 10 to 1e5"),
      mesh(caps, "caps", false, "a soup of triangles with one corner almost on the side across, 10 to 1e5"),
  };
  return entries;
}

template <class Table>
std::vector<Recipe> list_of(const Table& entries) {
  std::vector<Recipe> r;
  for (const Entry& e : entries) r.push_back(e.recipe);
  return r;
}

const Entry& entry_named(std::string_view name) {
  std::string known;
  for (const std::span<const Entry> entries :
       {std::span<const Entry>(table()), std::span<const Entry>(special_table())})
    for (const Entry& e : entries) {
      if (e.recipe.name == name) return e;
      known += (known.empty() ? "" : ", ") + e.recipe.name;
    }
  for (const Kind kind : {Kind::scene, Kind::room, Kind::surface})
    for (const KnobRecipe& recipe : knob_recipes(kind)) known += ", " + recipe.name;
  throw std::invalid_argument("no recipe is called '" + std::string(name) + "'; known: " + known);
}

constexpr std::size_t least_n = 1'000, largest_n = 10'000'000, largest_image = std::size_t{1} << 26;

/// A scene, a room or a surface.
Dataset generate_with_knobs(std::string_view name, std::string_view base, std::size_t n, std::uint64_t seed,
                            const Progress& progress) {
  if (name != base)
    throw std::invalid_argument("'" + std::string(base) + "' is no mesh; only meshes can be damaged");
  Dataset r;
  r.name = name, r.seed = seed;
  if (is_scene(base))
    r.kind = Kind::scene, r.scene = make_scene(name, n, seed, progress);
  else if (is_room(base))
    r.kind = Kind::room, r.room = make_room(name, n, seed, progress);
  else
    r.kind = Kind::surface, r.material = make_surface(name);
  return r;
}

}  // namespace

void Ticker::add(double share) {
  const double before = done_.fetch_add(share);
  if (!progress_) return;
  const std::unique_lock lock(mutex_, std::try_to_lock);
  if (!lock || Clock::now() < next_) return;
  next_ = Clock::now() + std::chrono::milliseconds(100);
  progress_(std::min(1.0, before + share));
}

std::span<const Recipe> recipes() {
  static const std::vector<Recipe> list = list_of(table());
  return list;
}

std::span<const Recipe> special_recipes() {
  static const std::vector<Recipe> list = list_of(special_table());
  return list;
}

bool pixels_are_independent(std::string_view recipe) {
  return std::ranges::any_of(table(),
                             [&](const Entry& e) { return e.independent && e.recipe.name == recipe; });
}

Dataset generate(std::string_view name, std::size_t n, std::uint64_t seed, const Progress& progress) {
  const std::string_view base = name.substr(0, name.find('+'));
  if (is_scene(base) || is_room(base) || is_surface(base))
    return generate_with_knobs(name, base, n, seed, progress);
  const Entry* const entry = &entry_named(base);
  std::vector<Damage> damages;
  for (std::string_view rest = name.substr(base.size()); !rest.empty();) {
    rest.remove_prefix(1);
    damages.push_back(damage_named(rest.substr(0, rest.find('+'))));
    rest = rest.substr(std::min(rest.find('+'), rest.size()));
  }
  if (!damages.empty() && entry->recipe.kind != Kind::mesh)
    throw std::invalid_argument("'" + std::string(base) + "' is no mesh; only meshes can be damaged");
  const std::size_t most = entry->make_image ? largest_image : largest_n;
  if (n < least_n || n > most)
    throw std::invalid_argument("n = " + std::to_string(n) + " is out of range: recipes make " +
                                std::to_string(least_n) + " to " + std::to_string(most) + " elements");
  Ticker ticker(progress);
  const Job job{n, seed, ticker};
  Dataset r;
  r.name = entry->recipe.name;
  r.kind = entry->recipe.kind;
  r.seed = seed;
  r.closed = entry->recipe.closed;
  if (entry->make_cloud)
    r.cloud = entry->make_cloud(job);
  else if (entry->make_precise)
    r.keep_precise(entry->make_precise(job));
  else if (entry->make_vectors)
    r.vectors = entry->make_vectors(job, entry->columns);
  else if (entry->make_image)
    r.image = entry->make_image(job);
  else
    r.mesh = entry->make_mesh(job);
  if (damages.empty()) return r;
  r.name = name;
  for (const Damage& damage : damages) r.mesh = damaged(r.mesh, damage, seed);
  const geometry::Adjacency adjacency(r.mesh);
  r.closed = adjacency.closed() && adjacency.oriented();
  return r;
}

}  // namespace treeline::datasets
