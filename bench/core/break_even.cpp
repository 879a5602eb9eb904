#include "bench/core/break_even.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "bench/core/cells.hpp"
#include "bench/core/table.hpp"

namespace treeline::bench {
namespace {

bool is_brute(const Rung& rung) { return rung.rows.front().family == "brute"; }

std::optional<double> build_s(const Rung& rung) { return rung.rows.front().build_s; }

/// Of the rungs that meet the tolerance: the cheapest to build, among brute force or among the rest.
const Rung* cheapest_build(const Advice& advice, bool brute) {
  const Rung* best = nullptr;
  for (const Rung& rung : advice.rungs) {
    if (&rung == &advice.rungs[*advice.chosen] || is_brute(rung) != brute) continue;
    if (!rung.limit.empty() || !std::isfinite(rung.cost_ns) || !build_s(rung)) continue;
    if (!best || *build_s(rung) < *build_s(*best)) best = &rung;
  }
  return best;
}

std::string format_line(const Rung& advised, const Rung* other, const char* what, const char* article = "") {
  if (!other) return fmt::format("  few    no {} that meets the tolerance was measured here\n", what);
  const std::optional<double> queries = break_even(advised, *other);
  if (!queries)
    return fmt::format("  few    the build of {} has no known time\n", advised.rows.front().method);
  const Row& row = other->rows.front();
  const std::string name = row.method + (row.build_knobs.empty() ? "" : ", " + format_knobs(row.build_knobs));
  const std::string build = format_time_ns(*row.build_s * 1e9);
  if (*queries < 1 && *row.build_s >= *build_s(advised))
    return fmt::format("  few    {} builds no faster ({}: build {})\n",
                       other->rows.front().family == "brute" ? what : "nothing measured", name, build);
  if (*queries < 1)
    return fmt::format("  few    not even for one query of each set does {}{} cost less ({}: build {})\n",
                       article, what, name, build);
  if (std::isinf(*queries))
    return fmt::format("  few    {} answers as fast and always costs less (build {})\n", name, build);
  return fmt::format("  few    for up to {:.0f} {} of each set {} costs less (build {})\n",
                     std::floor(*queries), *queries < 2 ? "query" : "queries", name, build);
}

}  // namespace

std::optional<double> break_even(const Rung& advised, const Rung& other) {
  const auto a = build_s(advised), b = build_s(other);
  if (!a || !b || !std::isfinite(advised.cost_ns) || !std::isfinite(other.cost_ns)) return std::nullopt;
  const double saved_ns = (*a - *b) * 1e9, lost_ns = other.cost_ns - advised.cost_ns;
  if (saved_ns <= 0) return 0;
  return lost_ns > 0 ? saved_ns / lost_ns : std::numeric_limits<double>::infinity();
}

std::string format_break_even(const Advice& advice) {
  if (!advice.chosen) return "";
  const Rung& advised = advice.rungs[*advice.chosen];
  std::string out;
  if (!is_brute(advised)) out += format_line(advised, cheapest_build(advice, true), "brute force");
  return out + format_line(advised, cheapest_build(advice, false), "cheaper build", "a ");
}

}  // namespace treeline::bench
