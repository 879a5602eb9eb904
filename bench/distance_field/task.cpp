#include "bench/distance_field/task.hpp"

#include <algorithm>
#include <iostream>
#include <stdexcept>

#include "bench/core/all_threads.hpp"
#include "bench/distance_field/block.hpp"
#include "datasets_gen/hard/hard_case.hpp"

namespace treeline::bench::distance_field {
namespace {

/// Damage that a field must stand or tell, and meshes of more than one shell.
constexpr const char* damaged[] = {"nested_shells",          "icosphere+nested",     "icosphere+hole_2",
                                   "icosphere+missing_1",    "icosphere+flipped_10", "icosphere+duplicated_1",
                                   "icosphere+degenerate_1", "icosphere+unwelded",   "icosphere+inside_out"};
constexpr std::size_t damaged_size = 5000;

/// Those of the task ray that differ in their mesh, not in their rays; where one size is telling. (Not
/// closed_sphere_at_1e5: there single precision has room for four places a cell, and ours refuse, by
/// contract.)
constexpr const char* of_rays[] = {"points_as_triangles",
                                   "segments_as_triangles",
                                   "repeated_corner_index",
                                   "needle_fan_wall",
                                   "caps",
                                   "coincident_triangles",
                                   "closed_sphere_at_1e3",
                                   "vertex_at_1e25",
                                   "one_triangle",
                                   "nan_vertices",
                                   "box_at_random"};

/// Of a damaged mesh, the mesh before: it tells the sides. Empty where the damaged mesh is closed and tells
/// its own.
geometry::Mesh3f before_damage(const std::string& name, std::size_t n, std::uint64_t seed) {
  const std::size_t plus = name.find('+');
  if (plus == std::string::npos || name.ends_with("+inside_out") || name.ends_with("+nested")) return {};
  return datasets::generate(name.substr(0, plus), n, seed).mesh;
}

/// Whether a closed mesh goes around less than nothing.
bool inside_out(const geometry::Mesh3f& mesh) {
  double volume = 0;  // six times
  for (std::size_t i = 0; i < mesh.size(); ++i) {
    const geometry::Triangle3d t(mesh.triangle(i));
    volume += dot(t.a, cross(t.b, t.c));
  }
  return volume < 0;
}

/// What nobody says who sees distances alone. Empty: nothing.
std::string note_on(const datasets::Dataset& dataset) {
  if (!dataset.closed) return "not closed: distances are judged, on which side they are is not";
  return inside_out(dataset.mesh) ? "inside out: nothing is inside; turn its faces around" : "";
}

}  // namespace

DistanceFieldTask::DistanceFieldTask() : RegisteredTask(TREELINE_TASK_METHODS, TREELINE_TASK_NOT_BUILT) {}

std::vector<BlockSpec> DistanceFieldTask::blocks(Profile profile) const {
  switch (profile) {
    case Profile::smoke:
      return {{"icosphere", 1'000}};
    case Profile::quick:
      return {{"icosphere", 100'000}, {"nested_shells", 10'000}, {"icosphere+hole_2", 10'000}};
    case Profile::full:
      break;
  }
  std::vector<BlockSpec> r;
  for (const std::size_t n : {10'000u, 100'000u, 1'000'000u})
    for (const char* name : {"icosphere", "nested_shells", "torus_knot", "architecture", "icosphere+hole_2"})
      r.push_back({name, n});
  return r;
}

std::vector<BlockSpec> DistanceFieldTask::hard_blocks() const {
  std::vector<BlockSpec> r;
  for (const char* name : damaged) r.push_back({name, damaged_size, true});
  for (const datasets::HardCase& c : datasets::hard_cases())
    if (std::ranges::find(of_rays, std::string_view(c.name)) != std::end(of_rays))
      r.push_back({c.name, c.mesh.size(), true});
  return r;
}

std::unique_ptr<Block> DistanceFieldTask::open(const BlockSpec& spec, const RunContext& context) const {
  BlockInput input;
  input.seed = context.seed;
  input.quick = context.profile != Profile::full;
  if (context.profile == Profile::smoke || spec.hard) input.points = input.rays = 500;
  if (context.profile == Profile::full && !spec.hard) input.points = input.rays = 65536;
  input.threads = spec.hard ? 1 : all_threads();  // hard cases run in children of a fork: no thread pool here
  if (spec.hard) {
    for (datasets::HardCase& c : datasets::hard_cases())
      if (c.name == spec.dataset &&
          std::ranges::find(of_rays, std::string_view(c.name)) != std::end(of_rays)) {
        input.dataset.kind = datasets::Kind::mesh;
        input.dataset.mesh = std::move(c.mesh);
        // Sides are asked of a closed sphere and a box alone.
        input.dataset.closed = c.name.starts_with("closed_sphere") || c.name.starts_with("box");
        return open_block(registered(), std::move(input));
      }
    if (std::ranges::find(damaged, std::string_view(spec.dataset)) == std::end(damaged))
      throw std::invalid_argument("no hard case for distance fields is called '" + spec.dataset + "'");
  }
  input.dataset = datasets::generate(spec.dataset, spec.n, context.seed);
  input.whole = before_damage(spec.dataset, spec.n, context.seed);
  if (input.whole.faces.empty()) input.note = note_on(input.dataset);
  return open_block(registered(), std::move(input));
}

std::unique_ptr<Block> DistanceFieldTask::open(datasets::Dataset dataset, const RunContext& context) const {
  if (dataset.kind != datasets::Kind::mesh || dataset.mesh.faces.empty())
    throw std::invalid_argument("'" + dataset.name +
                                "' has no triangles; the task distance_field needs a mesh of triangles");
  BlockInput input;
  input.note = note_on(dataset);
  if (!input.note.empty()) std::cerr << dataset.name << ": " << input.note << "\n";
  input.dataset = std::move(dataset);
  input.seed = context.seed, input.threads = all_threads();
  input.quick = context.profile != Profile::full;
  if (context.profile == Profile::full) input.points = input.rays = 65536;
  return open_block(registered(), std::move(input));
}

}  // namespace treeline::bench::distance_field
