#include "bench/core/selection.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "datasets_gen/knobs.hpp"

namespace treeline::bench {
namespace {

constexpr std::size_t default_n = 100000;  // of a recipe that the profile does not have
constexpr std::size_t default_scene_n = 5000;

struct Wish {
  std::string name;
  std::size_t n = 0;  // 0: not said
};

Wish parse_wish(const std::string& text) {
  const std::size_t colon = text.find(':');
  Wish wish{text.substr(0, colon), 0};
  if (colon == std::string::npos) return wish;
  double n = 0;  // so that 1e6 works, too
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data() + colon + 1, end, n);
  if (error != std::errc() || stop != end || !(n >= 1 && n <= 1e9) || n != std::floor(n))
    throw UsageError(
        fmt::format("--dataset {}: '{}' is no number of elements", text, text.substr(colon + 1)));
  wish.n = static_cast<std::size_t>(n);
  return wish;
}

std::vector<BlockSpec> hard_of(const Task& task, const std::string& text) {
  const std::string name = text.starts_with("hard/") ? text.substr(5) : text;
  std::vector<BlockSpec> out = task.hard_blocks();
  std::erase_if(out, [&](const BlockSpec& spec) { return spec.dataset != name; });
  if (out.empty())
    throw UsageError(fmt::format("--dataset {}: {} has no such hard case (see --list)", text, task.name()));
  return out;
}

std::vector<BlockSpec> blocks_of(const Task& task, Profile profile, const std::string& text) {
  const Wish wish = parse_wish(text);
  std::vector<BlockSpec> out = task.blocks(profile);
  const bool in_profile =
      std::any_of(out.begin(), out.end(), [&](const auto& b) { return b.dataset == wish.name; });
  if (in_profile && wish.n == 0) {
    std::erase_if(out, [&](const BlockSpec& spec) { return spec.dataset != wish.name; });
    return out;
  }
  const auto with_knobs = datasets::knob_recipes(task.dataset_kind());
  std::vector<std::string> known;
  for (const datasets::KnobRecipe& recipe : with_knobs) known.push_back(recipe.name);
  for (const datasets::Recipe& recipe : datasets::recipes())
    if (recipe.kind == task.dataset_kind()) known.push_back(recipe.name);
  const bool is_known = std::find(known.begin(), known.end(), wish.name) != known.end() ||
                        std::any_of(with_knobs.begin(), with_knobs.end(),
                                    [&](const auto& recipe) { return names(wish.name, recipe); });
  if (!in_profile && !is_known)
    throw UsageError(fmt::format("--dataset {}: {} has no dataset '{}'; it has {}", text, task.name(),
                                 wish.name, fmt::join(known, ", ")));
  const std::size_t n = with_knobs.empty() ? default_n : default_scene_n;
  return {{wish.name, wish.n == 0 ? n : wish.n, false}};
}

}  // namespace

std::vector<BlockSpec> select_blocks(const Task& task, const Options& options) {
  std::vector<BlockSpec> out;
  for (const std::string& text : options.datasets) {
    const auto more = options.stress ? hard_of(task, text) : blocks_of(task, options.context.profile, text);
    for (const BlockSpec& spec : more)
      if (std::none_of(out.begin(), out.end(), [&](const auto& b) { return b.label() == spec.label(); }))
        out.push_back(spec);
  }
  if (options.datasets.empty())
    out = options.stress    ? task.hard_blocks()
          : options.scaling ? task.scaling_blocks(options.context.profile)
                            : task.blocks(options.context.profile);
  for (BlockSpec& spec : out) spec.scaling = options.scaling;
  if (out.empty()) throw UsageError(task.name() + " has no blocks here");
  if (options.block == 0) return out;
  if (options.block > out.size())
    throw UsageError(fmt::format("--block {}: there are blocks 1 to {}", options.block, out.size()));
  return {out[options.block - 1]};
}

}  // namespace treeline::bench
