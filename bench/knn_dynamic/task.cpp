#include "bench/knn_dynamic/task.hpp"

#include <algorithm>
#include <stdexcept>

#include "bench/knn_dynamic/block.hpp"

namespace treeline::bench::knn_dynamic {
namespace {

constexpr std::size_t largest_hard_case = 200'000;  // points: larger ones tell the same, later

bool fits(const datasets::HardCase& c) {
  const auto finite = [](const Vec3f& p) { return geometry::is_finite(p); };
  return c.for_points() && c.expect == datasets::Expect::answers && c.k > 0 && c.cloud.size() >= 2 &&
         c.cloud.size() <= largest_hard_case && std::ranges::all_of(c.cloud.points, finite) &&
         std::ranges::all_of(c.queries, finite);
}

}  // namespace

KnnDynamicTask::KnnDynamicTask() : RegisteredTask(TREELINE_TASK_METHODS, TREELINE_TASK_NOT_BUILT) {}

std::vector<BlockSpec> KnnDynamicTask::blocks(Profile profile) const {
  switch (profile) {
    case Profile::smoke:
      return {{"uniform_cube", 1'000}};
    case Profile::quick:
      return {{"uniform_cube", 20'000}, {"lidar", 20'000}};
    case Profile::full:
      break;
  }
  std::vector<BlockSpec> r;
  for (const std::size_t n : {10'000u, 100'000u, 1'000'000u})
    for (const char* name : {"uniform_cube", "lidar"}) r.push_back({name, n});
  return r;
}

std::vector<BlockSpec> KnnDynamicTask::hard_blocks() const {
  std::vector<BlockSpec> r;
  for (const datasets::HardCase& c : datasets::hard_cases())
    if (fits(c)) r.push_back({c.name, c.cloud.size(), true});
  return r;
}

std::unique_ptr<Block> KnnDynamicTask::open(const BlockSpec& spec, const RunContext& context) const {
  if (!spec.hard) return open(datasets::generate(spec.dataset, 2 * spec.n, context.seed), context);
  for (datasets::HardCase& c : datasets::hard_cases())
    if (c.name == spec.dataset && fits(c)) return open_hard_block(registered(), std::move(c), context);
  throw std::invalid_argument("no hard case for points that come and go is called '" + spec.dataset + "'");
}

std::unique_ptr<Block> KnnDynamicTask::open(datasets::Dataset dataset, const RunContext& context) const {
  if (dataset.kind == datasets::Kind::mesh) {
    dataset.cloud.points = std::move(dataset.mesh.vertices);
    dataset.kind = datasets::Kind::cloud, dataset.mesh = {};
  }
  return open_block(registered(), std::move(dataset), context);
}

}  // namespace treeline::bench::knn_dynamic
