#include "bench/inside/task.hpp"

#include <algorithm>
#include <stdexcept>

#include "bench/inside/block.hpp"
#include "datasets_gen/hard/hard_insides.hpp"
#include "geometry/closedness.hpp"
#include "geometry/mesh_check.hpp"

namespace treeline::bench::inside {
namespace {

using datasets::Dataset;

constexpr const char* damages[] = {"hole_2",       "missing_1", "flipped_1", "flipped_10", "duplicated_1",
                                   "degenerate_1", "unwelded",  "nested",    "inside_out"};
constexpr std::size_t damaged_n = 5'000, damaged_n_quick = 2'000;

/// A batch is repeated, and what one pass leaves in the caches must not be all that the next one needs.
SetSizes set_sizes(std::size_t n, Profile profile) {
  const bool large = n > 300'000;
  switch (profile) {
    case Profile::smoke:
      return {256, 256};
    case Profile::quick:
      return large ? SetSizes{16384, 4096} : SetSizes{n > 50'000 ? 4096u : 2048u, 1024};
    case Profile::full:
      return large ? SetSizes{131072, 32768} : SetSizes{65536, 16384};
  }
  return {};
}

constexpr std::size_t scaling_factor = 8;  // so many times the queries where threads share them

/// For thread scaling: queries near the surface and anywhere.
void ask_by_threads(std::vector<PointSet>& sets) {
  keep_for_threads(sets, {"near", "uniform"}, [](PointSet&, std::size_t) {});
}

/// What such a mesh, or a part of it, goes around -1 times or twice is inside to some methods and not to
/// others: nothing is measured by asking them.
void refuse_wrong_way(const Dataset& dataset) {
  if (dataset.kind != datasets::Kind::mesh || dataset.mesh.faces.empty()) return;
  const geometry::MeshCheck found = geometry::check_mesh(dataset.mesh, 1);
  const char* const remedy = "; turn the faces around (treeline_gen --check lists what is wrong)";
  if (found.inside_out())
    throw std::invalid_argument("'" + dataset.name + "' is inside out: its faces look inward" + remedy);
  if (const auto& parts = found.misnested_components; parts.count > 0)
    throw std::invalid_argument("'" + dataset.name + "' has " + std::to_string(parts.count) +
                                (parts.count == 1 ? " part that looks" : " parts that look") +
                                " the wrong way, the first with face " +
                                std::to_string(parts.first[0].faces[0]) + remedy);
}

std::unique_ptr<Block> open_hard(const std::string& name, const RunContext& context, int version,
                                 const std::vector<Method>& methods) {
  for (datasets::HardInside& c : datasets::hard_insides()) {
    if (c.name != name) continue;
    BlockInput input;
    take_hard_mesh(input, std::move(c.mesh), context, version);
    input.sets.push_back({"inside", std::move(c.points)});
    input.must_answer = c.expect == datasets::Expect::answers;
    input.coincident = c.coincident;
    auto block = std::make_unique<InsideBlock>(std::move(input), methods);
    block->find_truth();  // once, for all the children
    return block;
  }
  throw std::invalid_argument("no hard case for inside and outside is called '" + name + "'");
}

}  // namespace

InsideTask::InsideTask() : RegisteredTask(TREELINE_TASK_METHODS, TREELINE_TASK_NOT_BUILT) {}

std::vector<BlockSpec> InsideTask::blocks(Profile profile) const {
  if (profile == Profile::smoke)
    return {{"icosphere", 1'000}, {"nested_shells", 1'000}, {"icosphere+hole_2", 1'000}};
  std::vector<BlockSpec> blocks;
  if (profile == Profile::quick)
    blocks = {{"icosphere", 1'000},
              {"icosphere", 10'000},
              {"icosphere", 100'000},
              {"nested_shells", 10'000},
              {"torus_knot", 10'000}};
  else
    for (const auto& recipe : datasets::recipes())
      if (recipe.kind == datasets::Kind::mesh && recipe.closed)
        for (const std::size_t n : {1'000, 10'000, 100'000, 1'000'000, 10'000'000})
          blocks.push_back({recipe.name, n});
  for (const char* damage : damages)
    blocks.push_back(
        {std::string("icosphere+") + damage, profile == Profile::quick ? damaged_n_quick : damaged_n});
  return blocks;
}

std::vector<BlockSpec> InsideTask::hard_blocks() const {
  std::vector<BlockSpec> blocks;
  for (const auto& c : datasets::hard_insides()) blocks.push_back({c.name, 0, true});
  return blocks;
}

std::vector<BlockSpec> InsideTask::scaling_blocks(Profile profile) const {
  if (profile == Profile::smoke) return {{"icosphere", 1'000}};
  if (profile == Profile::quick) return {};
  return {{"icosphere", 1'000'000}, {"nested_shells", 1'000'000}};
}

std::unique_ptr<Block> InsideTask::open(const BlockSpec& spec, const RunContext& context) const {
  if (spec.hard) return open_hard(spec.dataset, context, version(), registered());
  std::optional<geometry::Mesh3f> whole;
  if (const std::size_t plus = spec.dataset.find('+'); plus != std::string::npos)
    whole = datasets::generate(spec.dataset.substr(0, plus), spec.n, context.seed).mesh;
  return open(datasets::generate(spec.dataset, spec.n, context.seed), std::move(whole), context, spec.scaling,
              false);
}

std::unique_ptr<Block> InsideTask::open(Dataset dataset, const RunContext& context) const {
  refuse_wrong_way(dataset);
  return open(std::move(dataset), std::nullopt, context, false, true);
}

std::unique_ptr<Block> InsideTask::open(Dataset dataset, std::optional<geometry::Mesh3f> whole,
                                        const RunContext& context, bool scaling, bool given) const {
  require_triangles(dataset, "the task inside needs a closed mesh of triangles");
  BlockInput input;
  const auto closedness = geometry::closedness(dataset.mesh);
  if (!whole && !(closedness.closed && closedness.oriented))
    throw std::invalid_argument(
        "'" + dataset.name + "' is " + (closedness.closed ? "not oriented alike everywhere" : "not closed") +
        "; nothing says what is inside of it (treeline_gen --check lists what is wrong)");
  SetSizes sizes = set_sizes(dataset.mesh.size(), context.profile);
  if (scaling) sizes.near *= scaling_factor, sizes.other *= scaling_factor;
  input.sets = make_point_sets(whole ? *whole : dataset.mesh, sizes, whole.has_value(), dataset.seed);
  if (scaling) ask_by_threads(input.sets);
  input.whole = std::move(whole), input.given = given;
  take_mesh(input, std::move(dataset), context, version());
  return std::make_unique<InsideBlock>(std::move(input), registered());
}

}  // namespace treeline::bench::inside
