#include "bench/closest_point/task.hpp"

#include <algorithm>
#include <stdexcept>

#include "bench/closest_point/block.hpp"
#include "bench/closest_point/pictures.hpp"
#include "datasets_gen/hard/hard_case.hpp"

namespace treeline::bench::closest_point {
namespace {

using datasets::Dataset;

/// A batch is repeated, and what one pass leaves in the caches must not be all that the next one needs: of
/// queries near the surface, which touch little each, many are asked.
SetSizes set_sizes(std::size_t n, Profile profile) {
  const bool large = n > 300'000;
  switch (profile) {
    case Profile::smoke:
      return {256, 256, 256};
    case Profile::quick:
      if (large) return {8192, 512, 128};
      return n > 50'000 ? SetSizes{4096, 256, 64} : SetSizes{1024, 256, 64};
    case Profile::full:
      return large ? SetSizes{262144, 32768, 8192} : SetSizes{65536, 16384, 4096};
  }
  return {};
}

constexpr std::size_t scaling_factor = 4;  // so many times the queries where threads share them

/// Queries a set that are judged: as many as brute force answers in a second or two.
std::size_t judged_queries(std::size_t n, Profile profile) {
  const double tests = profile == Profile::full ? 2e9 : 1e8;
  return std::clamp(static_cast<std::size_t>(tests / static_cast<double>(std::max<std::size_t>(n, 1))),
                    std::size_t{128}, std::size_t{profile == Profile::full ? 8192u : 1024u});
}

/// For thread scaling: queries near the surface and anywhere, in batches against which waking a thread is
/// nothing.
void ask_by_threads(std::vector<PointSet>& sets) {
  keep_for_threads(sets, {"near", "uniform"}, [](PointSet& set, std::size_t i) { set.truth = i; });
}

std::unique_ptr<Block> open_hard(const std::string& name, const RunContext& context, int version,
                                 const std::vector<Method>& methods) {
  for (datasets::HardCase& c : datasets::hard_cases()) {
    if (c.name != name || !c.for_closest_points()) continue;
    BlockInput input;
    take_hard_mesh(input, std::move(c.mesh), context, version);
    input.sets.push_back({.name = "closest", .points = Queries(std::move(c.probes))});
    auto block = std::make_unique<ClosestPointBlock>(std::move(input), methods);
    block->find_truth();  // once, for all the children
    return block;
  }
  throw std::invalid_argument("no hard case for closest points is called '" + name + "'");
}

}  // namespace

ClosestPointTask::ClosestPointTask() : RegisteredTask(TREELINE_TASK_METHODS, TREELINE_TASK_NOT_BUILT) {}

std::vector<BlockSpec> ClosestPointTask::blocks(Profile profile) const {
  switch (profile) {
    case Profile::smoke:
      return {{"icosphere", 1'000}, {"forest", 1'000}, {"caps", 1'000}};
    case Profile::quick:
      return {{"icosphere", 1'000},     {"icosphere", 10'000}, {"icosphere", 100'000},
              {"icosphere", 1'000'000}, {"terrain", 10'000},   {"architecture", 10'000},
              {"architecture", 30'000}, {"forest", 30'000},    {"nested_shells", 10'000},
              {"needles", 1'000},       {"caps", 1'000}};
    case Profile::full:
      break;
  }
  std::vector<BlockSpec> blocks;
  const auto add = [&](const std::string& name) {
    for (const std::size_t n : {1'000, 10'000, 100'000, 1'000'000, 10'000'000}) blocks.push_back({name, n});
  };
  for (const auto& recipe : datasets::recipes())
    if (recipe.kind == datasets::Kind::mesh) add(recipe.name);
  for (const auto& recipe : datasets::special_recipes())
    if (recipe.kind == datasets::Kind::mesh) add(recipe.name);
  return blocks;
}

std::vector<BlockSpec> ClosestPointTask::hard_blocks() const {
  std::vector<BlockSpec> blocks;
  for (const auto& c : datasets::hard_cases())
    if (c.for_closest_points()) blocks.push_back({c.name, 0, true});
  return blocks;
}

std::vector<BlockSpec> ClosestPointTask::scaling_blocks(Profile profile) const {
  if (profile == Profile::smoke) return {{"icosphere", 1'000}};
  if (profile == Profile::quick) return {{"icosphere", 100'000}};
  return {{"icosphere", 1'000'000}, {"architecture", 1'000'000}, {"forest", 1'000'000}};
}

std::unique_ptr<Block> ClosestPointTask::open(const BlockSpec& spec, const RunContext& context) const {
  if (spec.hard) return open_hard(spec.dataset, context, version(), registered());
  return open(datasets::generate(spec.dataset, spec.n, context.seed), context, spec.scaling);
}

std::unique_ptr<Block> ClosestPointTask::open(Dataset dataset, const RunContext& context) const {
  return open(std::move(dataset), context, false);
}

std::unique_ptr<Block> ClosestPointTask::open(Dataset dataset, const RunContext& context,
                                              bool scaling) const {
  require_triangles(dataset, "the task closest_point needs a mesh of triangles");
  BlockInput input;
  const std::size_t n = dataset.mesh.size();
  SetSizes sizes = set_sizes(n, context.profile);
  if (scaling) sizes.near *= scaling_factor, sizes.other *= scaling_factor;
  input.sets = make_point_sets(dataset.mesh, sizes, context.seed);
  if (scaling) ask_by_threads(input.sets);
  input.judged = judged_queries(n, context.profile);
  take_mesh(input, std::move(dataset), context, version());
  return std::make_unique<ClosestPointBlock>(std::move(input), registered());
}

void ClosestPointTask::pictures(const BlockSpec& spec, const RunContext& context,
                                const std::string& folder) const {
  const auto mesh = datasets::generate(spec.dataset, spec.n, context.seed).mesh;
  draw_pictures(registered(), spec.dataset, mesh, context.threads, folder);
}

}  // namespace treeline::bench::closest_point
