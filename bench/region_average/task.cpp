#include "bench/region_average/task.hpp"

#include <algorithm>
#include <stdexcept>

#include "bench/core/all_threads.hpp"
#include "bench/region_average/block.hpp"
#include "bench/region_average/pictures.hpp"
#include "datasets_gen/hard/hard_textures.hpp"
#include "datasets_gen/textures/independent.hpp"

namespace treeline::bench::region_average {
namespace {

constexpr std::size_t one_k = 1024 * 1024;
constexpr const char* textures[] = {"noise", "ramp", "checkers", "mask", "star", "marble"};

std::size_t queries(Profile profile) {
  return profile == Profile::smoke ? 256 : profile == Profile::quick ? 4096 : 65536;
}

}  // namespace

RegionAverageTask::RegionAverageTask() : RegisteredTask(TREELINE_TASK_METHODS, TREELINE_TASK_NOT_BUILT) {}

std::vector<BlockSpec> RegionAverageTask::blocks(Profile profile) const {
  switch (profile) {
    case Profile::smoke:
      return {{"mask", 256 * 256}, {"marble", 64 * 64}};
    case Profile::quick:
      return {{"mask", one_k},      {"noise", one_k},         {"noise", 4 * one_k}, {"marble", one_k},
              {"ramp", one_k / 16}, {"checkers", one_k / 16}, {"star", one_k / 16}};
    case Profile::full:
      break;
  }
  std::vector<BlockSpec> r;
  for (const std::size_t n : {one_k / 16, one_k, 4 * one_k, 16 * one_k})
    for (const char* name : textures) r.push_back({name, n});
  return r;
}

std::vector<BlockSpec> RegionAverageTask::hard_blocks() const {
  std::vector<BlockSpec> r;
  for (const datasets::HardTexture& c : datasets::hard_textures()) r.push_back({c.name, 0, true});
  return r;
}

std::vector<BlockSpec> RegionAverageTask::scaling_blocks(Profile profile) const {
  if (profile == Profile::smoke) return {{"noise", 128 * 128}};
  if (profile == Profile::quick) return {{"noise", 4 * one_k}};
  return {{"noise", 4 * one_k}, {"noise", 16 * one_k}, {"marble", 4 * one_k}};
}

std::unique_ptr<Block> RegionAverageTask::open(const BlockSpec& spec, const RunContext& context) const {
  if (!spec.hard)
    return open(datasets::generate(spec.dataset, spec.n, context.seed), context, spec.scaling,
                datasets::pixels_are_independent(spec.dataset));
  for (const datasets::HardTexture& c : datasets::hard_textures()) {
    if (c.name != spec.dataset) continue;
    BlockInput input;
    Image& image = input.dataset.image = c.make();
    input.sets = make_hard_sets(image.width, image.height, 200, context.seed);
    if (c.independent)
      for (FootprintSet& set : make_whole_sets(image.width, image.height, 4096, context.seed))
        input.sets.push_back(std::move(set));
    input.must_answer = c.expect == datasets::Expect::answers;
    input.moments = c.moments, input.independent = c.independent;
    input.dataset.name = c.name, input.dataset.kind = datasets::Kind::image,
    input.dataset.seed = context.seed;
    input.threads = 1;  // hard cases run in children of a fork: no thread pool here
    return open_block(registered(), std::move(input));
  }
  throw std::invalid_argument("no hard case for textures is called '" + spec.dataset + "'");
}

std::unique_ptr<Block> RegionAverageTask::open(datasets::Dataset dataset, const RunContext& context) const {
  return open(std::move(dataset), context, false, false);
}

std::unique_ptr<Block> RegionAverageTask::open(datasets::Dataset dataset, const RunContext& context,
                                               bool scaling, bool independent) const {
  if (dataset.kind != datasets::Kind::image)
    throw std::invalid_argument("'" + dataset.name + "' is no image; the task region_average needs one");
  BlockInput input;
  const std::size_t each = queries(context.profile) * (scaling ? 8 : 1);
  input.sets = make_sets(dataset.image.width, dataset.image.height, each, dataset.seed);
  if (context.profile != Profile::full)  // time is short: the order is told of boxes
    std::erase_if(input.sets, [](const FootprintSet& s) { return !s.boxes && s.name.ends_with("_sorted"); });
  if (scaling) {
    std::erase_if(input.sets,
                  [](const FootprintSet& s) { return s.name != "square24" && s.name != "build"; });
    for (FootprintSet& s : input.sets) s.name += "_threads";
  }
  input.independent = independent;
  input.dataset = std::move(dataset);
  input.threads = all_threads();
  input.quick = context.profile == Profile::quick;
  return open_block(registered(), std::move(input));
}

// Textures that no block of the profile measures are drawn with its first.
void RegionAverageTask::pictures(const BlockSpec& spec, const RunContext& context,
                                 const std::string& folder) const {
  constexpr std::size_t pixels = 128 * 128;
  const auto draw = [&](const std::string& name) {
    write_pictures(registered(), datasets::generate(name, std::min(spec.n, pixels), context.seed), folder);
  };
  draw(spec.dataset);
  const auto measured = blocks(context.profile);
  if (spec.dataset != measured.front().dataset) return;
  for (const char* name : textures)
    if (std::ranges::find(measured, name, &BlockSpec::dataset) == measured.end()) draw(name);
}

}  // namespace treeline::bench::region_average
