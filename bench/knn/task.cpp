#include "bench/knn/task.hpp"

#include <algorithm>

#include "bench/knn/block.hpp"
#include "bench/knn/slice_picture.hpp"
#include "datasets_gen/hard/hard_case.hpp"

namespace treeline::bench::knn {
namespace {

std::vector<std::string> cloud_names() {
  std::vector<std::string> names;
  for (const datasets::Recipe& r : datasets::recipes())
    if (r.kind == datasets::Kind::cloud) names.push_back(r.name);
  return names;
}

// The two clouds whose growth with n is charted: the textbook's and the engineer's.
const std::vector<std::string> charted_in_n{"uniform_cube", "lidar"};

// In the quick profile those that tell methods apart: near and off the cloud, in and out of order, by each
// kind of query; few enough for a block's 200 cells to take a quarter of a minute.
Asked asked(Profile profile) {
  switch (profile) {
    case Profile::smoke:
      return {100, {}};
    case Profile::quick:
      return {500,
              {"knn1_self", "knn8_self", "knn8_sorted", "knn32_self", "knn8_off", "knn8_far", "radius_self",
               "box_self"}};
    case Profile::full:
      return {20'000, {}};
  }
  throw std::invalid_argument("no such profile");
}

// It takes as long for any cloud; where time is short the charted ones tell how long.
bool asks_brute_force(const BlockSpec& spec, Profile profile) {
  return profile != Profile::quick || spec.n <= 20'000 || std::ranges::count(charted_in_n, spec.dataset) > 0;
}

// For thread scaling: batches of some ten milliseconds, against which waking a thread is nothing.
Asked asked_by_threads(Profile profile) {
  return {profile == Profile::smoke   ? 100u
          : profile == Profile::quick ? 10'000u
                                      : 100'000u,
          {"knn8_self", "radius_self"},
          "_threads"};
}

datasets::HardCase hard_case_named(const std::string& name) {
  for (datasets::HardCase& c : datasets::hard_cases())
    if (c.name == name && c.for_points()) return std::move(c);
  throw std::invalid_argument("no hard case for points is called '" + name + "'");
}

}  // namespace

KnnTask::KnnTask() : RegisteredTask(TREELINE_TASK_METHODS, TREELINE_TASK_NOT_BUILT) {}

std::vector<BlockSpec> KnnTask::blocks(Profile profile) const {
  std::vector<BlockSpec> r;
  const auto add = [&](const std::vector<std::string>& names, std::size_t n) {
    for (const std::string& name : names) r.push_back({name, n});
  };
  switch (profile) {
    case Profile::smoke:
      add(charted_in_n, 1'000);
      add({"georeferenced"}, 1'000);
      break;
    case Profile::quick:
      for (const std::string& name : cloud_names())
        add({name}, std::ranges::count(charted_in_n, name) > 0 ? 100'000 : 30'000);
      add(charted_in_n, 10'000);
      add({"lidar"}, 1'000'000);
      break;
    case Profile::full:
      for (const std::size_t n : {10'000u, 100'000u, 1'000'000u}) add(cloud_names(), n);
      add(charted_in_n, 10'000'000);
      break;
  }
  return r;
}

std::vector<BlockSpec> KnnTask::hard_blocks() const {
  std::vector<BlockSpec> r;
  for (const datasets::HardCase& c : datasets::hard_cases())
    if (c.for_points()) r.push_back({c.name, c.cloud.size(), true});
  return r;
}

std::vector<BlockSpec> KnnTask::scaling_blocks(Profile profile) const {
  if (profile == Profile::smoke) return {{"uniform_cube", 1'000}};
  if (profile == Profile::quick) return {{"uniform_cube", 100'000}};
  return {{"uniform_cube", 1'000'000}, {"lidar", 1'000'000}};
}

std::unique_ptr<Block> KnnTask::open(const BlockSpec& spec, const RunContext& context) const {
  if (spec.hard) return open_hard_block(registered(), hard_case_named(spec.dataset), version(), context);
  if (spec.scaling)
    return open_block(registered(), datasets::generate(spec.dataset, spec.n, context.seed),
                      asked_by_threads(context.profile), version(), context);
  Asked questions = asked(context.profile);
  questions.brute_force = asks_brute_force(spec, context.profile);
  return open_block(registered(), datasets::generate(spec.dataset, spec.n, context.seed), questions,
                    version(), context);
}

std::unique_ptr<Block> KnnTask::open(datasets::Dataset dataset, const RunContext& context) const {
  return open_block(registered(), std::move(dataset), asked(context.profile), version(), context);
}

void KnnTask::pictures(const BlockSpec& spec, const RunContext& context, const std::string& folder) const {
  const datasets::Dataset dataset = datasets::generate(spec.dataset, spec.n, context.seed);
  if (dataset.precise.size() > 0) return;  // what float makes of it would be a picture of rounding
  write_pictures(registered(), dataset.cloud.points, spec.label(), folder);
}

}  // namespace treeline::bench::knn
