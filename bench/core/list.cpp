#include <fmt/format.h>

#include "bench/core/cells.hpp"
#include "bench/core/program.hpp"
#include "datasets_gen/knobs.hpp"

namespace treeline::bench {
namespace {

std::string variants(const std::vector<Knobs>& knobs) {
  std::string out;
  for (const Knobs& k : knobs) out += (out.empty() ? "" : " | ") + format_knobs(k);
  return out;
}

}  // namespace

std::string format_list(const Task& task, const Options& options) {
  std::string out;
  std::size_t k = 0;
  for (const BlockSpec& spec : task.blocks(options.context.profile))
    out += fmt::format("block {:>3}  {}\n", ++k, spec.label());
  k = 0;
  for (const BlockSpec& spec : task.hard_blocks())
    out += fmt::format("stress {:>2}  {}\n", ++k, spec.label());
  k = 0;
  for (const BlockSpec& spec : task.scaling_blocks(options.context.profile))
    out += fmt::format("scaling {:>1}  {}\n", ++k, spec.label());
  for (const MethodInfo& m : task.methods())
    out +=
        fmt::format("method  {:<20} {:<6} {:<5} {:<11} build {}  query {}{}\n", m.name, m.family,
                    to_string(m.source), to_string(m.claim), variants(m.build_knobs), variants(m.query_knobs),
                    m.largest_n == SIZE_MAX ? "" : fmt::format("  up to n = {}", m.largest_n));
  for (const auto& [method, package] : task.not_built())
    out += fmt::format("method  {:<20} not built: this build has no {}\n", method, package);
  for (const datasets::Recipe& recipe : datasets::recipes())
    if (recipe.kind == task.dataset_kind())
      out += fmt::format("dataset {:<20} {}\n", recipe.name, recipe.summary);
  for (const datasets::KnobRecipe& recipe : datasets::knob_recipes(task.dataset_kind()))
    out += fmt::format("dataset {:<20} {}\n", with_defaults(recipe), recipe.summary);
  return out;
}

}  // namespace treeline::bench
