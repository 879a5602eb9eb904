#include "bench/light_transport/task.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>

#include "bench/core/all_threads.hpp"
#include "bench/light_transport/pictures.hpp"
#include "datasets_gen/hard/hard_light.hpp"
#include "datasets_gen/rooms/room.hpp"

namespace treeline::bench::light_transport {
namespace {

/// Rooms that show how rays split say nothing of ways to reach lamps.
constexpr std::array of_splitting{"whitted", "mis", "mis_embree"};
/// Lamps that a path meets by chance once in ten thousand times, or mirrors so smooth that aiming fails.
constexpr std::array seldom{"plates_and_lamps"};

int pixels(Profile profile, bool scaling) {
  const int plain = profile == Profile::smoke ? 128 : profile == Profile::quick ? 800 : 12'000;
  return scaling ? (profile == Profile::quick ? 2 : 8) * plain : plain;
}

TruthOptions truth_options(Profile profile, std::uint64_t seed) {
  TruthOptions o;
  o.seed = seed;
  if (profile == Profile::smoke) o.most = 256;
  if (profile == Profile::full) o.most = 16384;
  return o;
}

bool is_of(const std::string& name, std::string_view recipe) {
  return name == recipe || name.starts_with(std::string(recipe) + "_");
}

void take_room(BlockInput& input, datasets::Dataset&& dataset, const RunContext& context, int version) {
  input.dataset_hash = dataset.hash(), input.seed = dataset.seed;
  input.room = std::move(dataset.room);
  input.truth_cache = context.truth_cache, input.version = version;
}

}  // namespace

LightTransportTask::LightTransportTask() : RegisteredTask(TREELINE_TASK_METHODS, TREELINE_TASK_NOT_BUILT) {}

std::vector<BlockSpec> LightTransportTask::blocks(Profile profile) const {
  if (profile == Profile::smoke)
    return {{"closed_box", 100}, {"glass_and_mirror", 600}, {"plates_and_lamps", 500}};
  std::vector<BlockSpec> out{{"furnace_spheres", 3'000},  {"closed_box", 200},
                             {"cornell_box", 1'000},      {"glass_and_mirror", 5'000},
                             {"mirror_hall", 3'000},      {"glass_panes", 200},
                             {"plates_and_lamps", 5'000}, {"architecture_under_sky", 50'000}};
  if (profile == Profile::full) {
    out.push_back({"cornell_box", 1'000'000});
    out.push_back({"architecture_under_sky", 1'000'000});
  }
  return out;
}

std::vector<BlockSpec> LightTransportTask::hard_blocks() const {
  std::vector<BlockSpec> out;
  for (const datasets::HardLight& c : datasets::hard_lights()) out.push_back({c.name, 0, true});
  return out;
}

std::vector<BlockSpec> LightTransportTask::scaling_blocks(Profile profile) const {
  if (profile == Profile::smoke) return {{"cornell_box", 200, false, true}};
  return {{"cornell_box", 1'000, false, true}};
}

std::unique_ptr<Block> LightTransportTask::open(const BlockSpec& spec, const RunContext& context) const {
  if (!spec.hard) return open(datasets::generate(spec.dataset, spec.n, context.seed), context, spec.scaling);
  for (const datasets::HardLight& c : datasets::hard_lights()) {
    if (c.name != spec.dataset) continue;
    datasets::Dataset dataset;
    dataset.kind = datasets::Kind::room, dataset.seed = context.seed, dataset.room = c.make();
    const std::string name = dataset.room.name;
    BlockInput input;
    take_room(input, std::move(dataset), context, version());
    if (c.by_name) input.form = radiance_form(name, input.room), input.walls = box_of_walls(name, input.room);
    if (c.radiance) input.form = [radiance = *c.radiance](const geometry::Rayf&) { return radiance; };
    input.truth = truth_options(Profile::quick, context.seed);
    input.must_answer = c.expect == datasets::Expect::answers && !c.meaningless;
    input.must_refuse = c.meaningless, input.seldom = c.seldom;
    auto block = std::make_unique<LightBlock>(registered(), std::move(input));
    block->find_truth();  // once, for all the children
    return block;
  }
  throw std::invalid_argument("no hard case for light is called '" + spec.dataset + "'");
}

std::unique_ptr<Block> LightTransportTask::open(datasets::Dataset dataset, const RunContext& context) const {
  return open(std::move(dataset), context, false);
}

std::unique_ptr<Block> LightTransportTask::open(datasets::Dataset dataset, const RunContext& context,
                                                bool scaling) const {
  if (dataset.kind != datasets::Kind::room || dataset.room.mesh.faces.empty())
    throw std::invalid_argument("'" + dataset.name +
                                "' is no room with triangles; the task light_transport needs one");
  resize(dataset.room.camera, pixels(context.profile, scaling));
  BlockInput input;
  const std::string name = dataset.room.name;
  take_room(input, std::move(dataset), context, version());
  if (datasets::is_room(name)) {  // not a user's mesh, whatever the name of its file
    input.form = radiance_form(name, input.room);
    if (!scaling) input.walls = box_of_walls(name, input.room);
    input.seldom = std::ranges::any_of(seldom, [&](const char* recipe) { return is_of(name, recipe); });
    if (is_of(name, "glass_panes")) input.only = {of_splitting.begin(), of_splitting.end()};
  }
  if (scaling) input.suffix = "_threads";
  input.truth = truth_options(context.profile, context.seed);
  input.threads = all_threads();
  input.quick = context.profile != Profile::full;
  if (context.profile == Profile::smoke) input.wall_repeats /= 4;
  return std::make_unique<LightBlock>(registered(), std::move(input));
}

void LightTransportTask::pictures(const BlockSpec& spec, const RunContext& context,
                                  const std::string& folder) const {
  datasets::Dataset dataset = datasets::generate(spec.dataset, spec.n, context.seed);
  draw_pictures(registered(), dataset.room, spec.dataset, context.seed,
                context.profile == Profile::smoke ? 128 : picture_pixels, all_threads(), folder);
}

}  // namespace treeline::bench::light_transport
