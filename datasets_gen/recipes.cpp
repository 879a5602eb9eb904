// The table of recipes, and generate().
#include <algorithm>
#include <array>
#include <stdexcept>

#include "datasets_gen/recipe.hpp"

namespace treeline::datasets {
namespace {

using MakeCloud = geometry::Cloud3f (*)(const Job&);
using MakePrecise = geometry::Cloud3d (*)(const Job&);
using MakeMesh = geometry::Mesh3f (*)(const Job&);
using MakeVectors = Vectors (*)(const Job&, std::size_t columns);

struct Entry {
  Recipe recipe;
  MakeCloud make_cloud = nullptr;
  MakePrecise make_precise = nullptr;
  MakeMesh make_mesh = nullptr;
  MakeVectors make_vectors = nullptr;
  std::size_t columns = 0;
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

const std::array<Entry, 20>& table() {
  static const std::array<Entry, 20> entries{
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
  };
  return entries;
}

constexpr std::size_t least_n = 1'000, largest_n = 10'000'000;

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
  static const std::vector<Recipe> list = [] {
    std::vector<Recipe> r;
    for (const Entry& e : table()) r.push_back(e.recipe);
    return r;
  }();
  return list;
}

Dataset generate(std::string_view name, std::size_t n, std::uint64_t seed, const Progress& progress) {
  const auto entry = std::ranges::find(table(), name, [](const Entry& e) { return e.recipe.name; });
  if (entry == table().end()) {
    std::string known;
    for (const Recipe& r : recipes()) known += (known.empty() ? "" : ", ") + r.name;
    throw std::invalid_argument("no recipe is called '" + std::string(name) + "'; known: " + known);
  }
  if (n < least_n || n > largest_n)
    throw std::invalid_argument("n = " + std::to_string(n) + " is out of range: recipes make " +
                                std::to_string(least_n) + " to " + std::to_string(largest_n) + " elements");
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
  else
    r.mesh = entry->make_mesh(job);
  return r;
}

}  // namespace treeline::datasets
