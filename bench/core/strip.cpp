#include "bench/core/strip.hpp"

#include <algorithm>
#include <map>

namespace treeline::bench {

const Knobs& value_at(const Configuration& c, const std::string& knob) {
  return c.query.contains(knob) ? c.query.at(knob) : c.build.at(knob);
}

std::optional<Strip> strip_of(std::span<const Configuration> all, std::size_t least) {
  Strip best;
  const auto try_knob = [&](const std::string& knob, Knobs Configuration::*where) {
    std::map<std::string, std::vector<std::size_t>> runs;  // by all that is not the knob
    for (std::size_t i = 0; i < all.size(); ++i) {
      const Knobs& knobs = all[i].*where;
      if (!knobs.contains(knob) || !knobs.at(knob).is_number()) continue;
      Configuration rest{all[i].build, all[i].query};
      (rest.*where).erase(knob);
      runs[rest.build.dump() + rest.query.dump()].push_back(i);
    }
    for (auto& [rest, run] : runs) {
      if (run.size() <= best.steps.size()) continue;
      std::ranges::sort(run, {},
                        [&](std::size_t i) { return (all[i].*where).at(knob).template get<double>(); });
      best.knob = knob, best.steps = run;
    }
  };
  for (const Configuration& c : all) {
    for (const auto& [knob, value] : c.query.items()) try_knob(knob, &Configuration::query);
    for (const auto& [knob, value] : c.build.items()) try_knob(knob, &Configuration::build);
  }
  if (best.steps.size() < least) return std::nullopt;
  const auto error = [&](std::size_t i) { return all[i].error; };
  const auto [low, high] = std::ranges::minmax(best.steps, {}, error);
  best.change = error(high) - error(low);
  return best;
}

}  // namespace treeline::bench
