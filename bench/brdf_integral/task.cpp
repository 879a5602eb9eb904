#include "bench/brdf_integral/task.hpp"

#include <stdexcept>

#include "bench/brdf_integral/block.hpp"
#include "bench/core/all_threads.hpp"
#include "datasets_gen/hard/hard_surfaces.hpp"

namespace treeline::bench::brdf_integral {
namespace {

constexpr std::size_t kernels_from = 10000;
constexpr std::size_t quick_pairs = 1 << 14, full_pairs = 1 << 18;

/// What has no surface is told apart by its name.
bool special(const std::string& name) {
  return name == "furnace" || name == "fresnel" || name == "solid_angles";
}

BlockInput special_input(const std::string& name, const RunContext& context) {
  const Profile p = context.profile;
  BlockInput input;
  if (name == "furnace") {
    input.asks = Asks::furnace;
    input.sets = make_furnace_sets(p != Profile::smoke);
    input.walks = p == Profile::smoke ? 1 << 12 : p == Profile::quick ? 1 << 15 : 1 << 21;
  } else if (name == "fresnel") {
    input.asks = Asks::fresnel;
    input.sets = make_fresnel_sets(p == Profile::full ? 9001 : 901);
  } else {
    input.asks = Asks::solid_angles;
    input.sets = make_solid_angle_sets(p == Profile::smoke   ? 8
                                       : p == Profile::quick ? 64
                                                             : 1024,
                                       context.seed);
  }
  // What it is about stands in for the content of a dataset.
  input.dataset.kind = datasets::Kind::vectors;
  input.dataset.vectors.columns = 1;
  for (const Set& s : input.sets)
    for (const double x : {s.alpha, s.reflectance, s.medium.index, s.medium.extinction, double(s.queries())})
      input.dataset.vectors.scalars.push_back(static_cast<float>(x));
  input.dataset.name = name, input.dataset.seed = context.seed;
  return input;
}

}  // namespace

BrdfIntegralTask::BrdfIntegralTask() : RegisteredTask(TREELINE_TASK_METHODS, TREELINE_TASK_NOT_BUILT) {}

std::vector<BlockSpec> BrdfIntegralTask::blocks(Profile profile) const {
  if (profile == Profile::smoke)
    return {{"ggx_0.3", 1}, {"lambert", 1}, {"compensated_ggx_0.5_0.5", kernels_from},
            {"furnace", 1}, {"fresnel", 1}, {"solid_angles", 1}};
  std::vector<BlockSpec> r;
  const bool full = profile == Profile::full;
  for (const char* name : {"ggx_0.1", "beckmann_0.1", "ggx_0.05_0.4", "gold_0.4"}) r.push_back({name, 1});
  if (full)
    for (const char* name :
         {"lambert", "ggx_0.02", "ggx_0.3", "ggx_0.5", "ggx_1", "separable_ggx_0.5", "beckmann_0.02",
          "beckmann_0.3", "beckmann_1", "separable_beckmann_0.5", "beckmann_0.05_0.4", "compensated_ggx_0.8",
          "turquin_ggx_0.8", "aluminium", "chromium", "dielectric_1.5_0.2"})
      r.push_back({name, 1});
  for (const char* name :
       {"lambert", "ggx_0.25", "separable_ggx_0.25", "beckmann_0.25", "separable_beckmann_0.25",
        "ggx_0.1_0.5", "dielectric_1.5_0.25", "gold_0.25", "compensated_ggx_0.5_0.5", "textbook_ggx_0.5_0.5",
        "directional_ggx_0.5_0.5", "turquin_ggx_0.5_0.5"})
    r.push_back({name, full ? full_pairs : quick_pairs});
  for (const char* name : {"furnace", "fresnel", "solid_angles"}) r.push_back({name, 1});
  return r;
}

std::vector<BlockSpec> BrdfIntegralTask::hard_blocks() const {
  std::vector<BlockSpec> r;
  for (const datasets::HardSurface& c : datasets::hard_surfaces()) r.push_back({c.name, 0, true});
  return r;
}

std::unique_ptr<Block> BrdfIntegralTask::open(const BlockSpec& spec, const RunContext& context) const {
  if (!spec.hard) {
    if (!special(spec.dataset)) {
      datasets::Dataset dataset = datasets::generate(spec.dataset, spec.n, context.seed);
      BlockInput input;
      input.dataset = std::move(dataset);
      input.threads = all_threads();
      input.seed = context.seed;
      input.quick = context.profile == Profile::quick;
      if (spec.n >= kernels_from) {
        input.asks = Asks::kernels, input.n = spec.n;
        input.sets = make_kernel_sets(input.dataset.material, spec.n, context.seed);
      } else {
        Amount amount;
        if (context.profile == Profile::smoke) amount = {4, 4, 16};
        if (context.profile == Profile::full) amount = {24, 32, 384};
        input.sets = make_integral_sets(amount, context.seed);
      }
      return open_block(registered(), std::move(input));
    }
    BlockInput input = special_input(spec.dataset, context);
    input.threads = all_threads(), input.seed = context.seed, input.quick = context.profile == Profile::quick;
    return open_block(registered(), std::move(input));
  }
  for (const datasets::HardSurface& c : datasets::hard_surfaces()) {
    if (c.name != spec.dataset) continue;
    BlockInput input;
    input.dataset.material = c.material;
    input.dataset.kind = datasets::Kind::surface;
    input.dataset.name = c.name, input.dataset.seed = input.seed = context.seed;
    input.sets = make_hard_integral_sets(c.cosines, context.seed);
    input.must_answer = c.expect == datasets::Expect::answers;
    input.hard = true;  // hard cases run in children of a fork: no thread pool here
    return open_block(registered(), std::move(input));
  }
  throw std::invalid_argument("no hard case for surfaces is called '" + spec.dataset + "'");
}

std::unique_ptr<Block> BrdfIntegralTask::open(datasets::Dataset dataset, const RunContext&) const {
  throw std::invalid_argument("'" + dataset.name +
                              "' is no surface; the task brdf_integral takes recipes alone");
}

}  // namespace treeline::bench::brdf_integral
