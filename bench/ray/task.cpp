#include "bench/ray/task.hpp"

#include <algorithm>

#include "bench/ray/block.hpp"
#include "bench/ray/moving.hpp"
#include "bench/ray/pictures.hpp"
#include "datasets_gen/hard/hard_case.hpp"

namespace treeline::bench::ray {
namespace {

using datasets::Dataset;

/// Of a large mesh more rays are asked: a batch is repeated, and what one pass leaves in the caches must not
/// be all that the next one needs.
std::size_t rays_per_set(std::size_t n, Profile profile) {
  const bool large = n > 300'000;
  switch (profile) {
    case Profile::smoke:
      return 256;
    case Profile::quick:
      return large ? 8192 : 2048;
    case Profile::full:
      return large ? 262144 : 65536;
  }
  return 0;
}

constexpr std::size_t scaling_factor = 8;  // so many times the rays where threads share them

/// Where vertices move, too: each build of a method is made anew for each frame, so not everywhere.
bool moves(const std::string& dataset, std::size_t n, Profile profile) {
  if (profile == Profile::smoke) return dataset == "icosphere";
  return n > 50'000 && n < 200'000 && (profile == Profile::full || dataset == "icosphere");
}

/// For thread scaling: rays that keep together and rays that go anywhere, batches of tens of milliseconds,
/// against which waking a thread is nothing.
void ask_by_threads(std::vector<RaySet>& sets) {
  keep_for_threads(sets, {"camera", "random", "shadow"}, [](RaySet& set, std::size_t i) { set.truth = i; });
}

/// Rays a set that are judged: as many as brute force answers in a second or two.
std::size_t judged_rays(std::size_t n, Profile profile) {
  const double tests = profile == Profile::full ? 2e9 : 2e8;
  return std::clamp(static_cast<std::size_t>(tests / static_cast<double>(std::max<std::size_t>(n, 1))),
                    std::size_t{128}, std::size_t{profile == Profile::full ? 8192u : 2048u});
}

datasets::HardCase hard_case(const std::string& name) {
  for (auto& c : datasets::hard_cases())
    if (c.name == name && c.for_rays()) return c;
  throw std::invalid_argument("no hard case for rays is called '" + name + "'");
}

std::unique_ptr<Block> open_hard(const std::string& name, const RunContext& context, int version,
                                 const std::vector<Method>& methods) {
  datasets::HardCase c = hard_case(name);
  BlockInput input;
  take_hard_mesh(input, std::move(c.mesh), context, version);
  if (!c.rays.empty()) {
    input.sets.push_back({.name = "closest", .rays = c.rays, .truth = 0});
    input.sets.push_back({.name = "any", .any = true, .rays = c.rays, .truth = 0});
  }
  for (datasets::RaysOut& out : c.outward)
    input.sets.push_back(
        {.name = out.name, .rays = std::move(out.rays), .truth = input.sets.size(), .outward = true});
  input.from_inside = c.from_inside;
  input.judged = c.judged;
  auto block = std::make_unique<RayBlock>(std::move(input), methods);
  block->find_truth();  // once, for all the children
  return block;
}

}  // namespace

RayTask::RayTask() : RegisteredTask(TREELINE_TASK_METHODS, TREELINE_TASK_NOT_BUILT) {}

std::vector<BlockSpec> RayTask::blocks(Profile profile) const {
  if (profile == Profile::smoke) return {{"icosphere", 1'000}, {"forest", 1'000}};
  if (profile == Profile::quick)
    return {{"icosphere", 10'000},    {"icosphere", 100'000},    {"icosphere", 1'000'000},
            {"architecture", 10'000}, {"architecture", 100'000}, {"terrain", 30'000},
            {"forest", 30'000},       {"nested_shells", 30'000}};
  std::vector<BlockSpec> blocks;
  for (const auto& recipe : datasets::recipes())
    if (recipe.kind == datasets::Kind::mesh)
      for (const std::size_t n : {1'000, 10'000, 100'000, 1'000'000, 10'000'000})
        blocks.push_back({recipe.name, n});
  return blocks;
}

std::vector<BlockSpec> RayTask::hard_blocks() const {
  std::vector<BlockSpec> blocks;
  for (const auto& c : datasets::hard_cases())
    if (c.for_rays()) blocks.push_back({c.name, 0, true});
  return blocks;
}

std::vector<BlockSpec> RayTask::scaling_blocks(Profile profile) const {
  if (profile == Profile::smoke) return {{"icosphere", 1'000}};
  if (profile == Profile::quick) return {{"icosphere", 100'000}};
  return {{"icosphere", 1'000'000}, {"architecture", 1'000'000}, {"forest", 1'000'000}};
}

std::unique_ptr<Block> RayTask::open(const BlockSpec& spec, const RunContext& context) const {
  if (spec.hard) return open_hard(spec.dataset, context, version(), registered());
  return open(datasets::generate(spec.dataset, spec.n, context.seed), context, spec.scaling);
}

std::unique_ptr<Block> RayTask::open(Dataset dataset, const RunContext& context) const {
  return open(std::move(dataset), context, false);
}

std::unique_ptr<Block> RayTask::open(Dataset dataset, const RunContext& context, bool scaling) const {
  require_triangles(dataset, "the task ray needs a mesh of triangles");
  BlockInput input;
  const std::size_t n = dataset.mesh.size();
  const std::size_t count = rays_per_set(n, context.profile) * (scaling ? scaling_factor : 1);
  input.sets = make_ray_sets(dataset.mesh, count, context.seed, all_threads());
  if (scaling) {
    ask_by_threads(input.sets);
  } else if (moves(dataset.name, n, context.profile)) {
    const std::vector<std::size_t> frames = moving_frames(context.profile != Profile::full);
    for (const std::size_t frame : frames) input.moved.push_back(twisted(dataset.mesh, frame));
    add_moving_sets(input.sets, input.moved, frames, count, context.seed);
  }
  input.closed = dataset.closed;
  input.judged = judged_rays(n, context.profile);
  take_mesh(input, std::move(dataset), context, version());
  return std::make_unique<RayBlock>(std::move(input), registered());
}

void RayTask::pictures(const BlockSpec& spec, const RunContext& context, const std::string& folder) const {
  draw_pictures(registered(), spec, context, folder);
}

}  // namespace treeline::bench::ray
