#include "bench/core/advice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>
#include <utility>

#include "bench/core/break_even.hpp"
#include "bench/core/cells.hpp"
#include "bench/core/table.hpp"

namespace treeline::bench {
namespace {

/// A truth that is itself off by more is no rounding: what agrees with it is not exact for that.
constexpr double coarse_floor = 1e-5;

/// The first limit that a row breaks; empty: none.
std::string broken_limit(const Row& row, double tolerance) {
  if (row.status != Status::ok) {
    const std::string why = row.reason.empty() ? "" : ": " + row.reason;
    return fmt::format("{} is {}{}", row.query_set, to_string(row.status), why);
  }
  const Errors& e = row.errors;
  const double allowed = std::max(tolerance, e.floor.value_or(0));
  const auto bias = e.bias ? std::optional(std::abs(*e.bias)) : std::nullopt;
  const std::pair<const char*, std::optional<double>> stated[] = {{"error", e.error},
                                                                  {"error_max", e.max},
                                                                  {"error_p99", e.p99},
                                                                  {"error_mean", e.mean},
                                                                  {"|bias|", bias}};
  for (const auto& [name, value] : stated)
    if (value && !(*value <= allowed))
      return fmt::format("{} of {} is {:.3g}, allowed {:.3g}", name, row.query_set, *value, allowed);
  if (!e.error) return fmt::format("nothing tells how far off the answers of {} are", row.query_set);
  return "";
}

/// Whether the claim holds for queries that were not measured. A bound by epsilon, or by a grid's resolution,
/// allows for errors, whether or not this sample has any.
bool promises(const Row& row) {
  const bool by_epsilon = row.query_knobs.contains("epsilon") && row.query_knobs.at("epsilon") != 0;
  const bool by_resolution = row.build_knobs.contains("resolution");
  return row.claim == Claim::exact || (row.claim == Claim::bounded && !by_epsilon && !by_resolution);
}

/// Why a rung whose measured errors all meet the tolerance may not be advised; empty: it may.
std::string unpromised_limit(const Row& row, double tolerance) {
  if (promises(row) || tolerance > row.errors.floor.value_or(0)) return "";
  return fmt::format("its claim is {}: no error on these queries of {} promises none on others",
                     to_string(row.claim), row.query_set);
}

const Row* row_of_set(const std::vector<Row>& rows, const std::string& set) {
  const auto found = std::find_if(rows.begin(), rows.end(), [&](const Row& r) { return r.query_set == set; });
  return found == rows.end() ? nullptr : &*found;
}

std::string rung_name(const Row& row) {
  std::string name = row.method;
  if (!row.build_knobs.empty()) name += ", build " + format_knobs(row.build_knobs);
  if (!row.query_knobs.empty()) name += ", query " + format_knobs(row.query_knobs);
  return name;
}

/// The largest of one error over the rung's query sets.
std::optional<double> worst(const Rung& rung, std::optional<double> Errors::*error) {
  std::optional<double> out;
  for (const Row& row : rung.rows)
    if (row.errors.*error) out = std::max(out.value_or(0), *(row.errors.*error));
  return out;
}

std::string escaped(const std::string& text) {
  std::string out;
  for (char c : text) {
    if (std::string_view(".[]{}()\\*+?|^$").find(c) != std::string_view::npos) out += '\\';
    out += c;
  }
  return out;
}

std::string filter_of(const Rung& rung) {
  const Row& row = rung.rows.front();
  return fmt::format("/{}$", escaped(fmt::format("{}/{}/{}", row.method, format_knobs(row.build_knobs),
                                                 format_knobs(row.query_knobs))));
}

std::string cost_of(const Rung& rung) {
  std::string out;
  for (const Row& row : rung.rows)
    out +=
        fmt::format("{}{} {}", out.empty() ? "" : ", ", row.query_set, row.query_ns ? format_time(row) : "?");
  return out;
}

/// Lowest and highest cost that the repetitions leave; nothing if a row has no interval.
std::optional<std::pair<double, double>> interval_of(const Rung& rung) {
  std::pair<double, double> sum;
  for (const Row& row : rung.rows) {
    if (!row.query_ns_low || !row.query_ns_high || *row.query_ns_low == *row.query_ns_high)
      return std::nullopt;
    sum.first += *row.query_ns_low, sum.second += *row.query_ns_high;
  }
  return sum;
}

std::string format_cost(const Rung& rung) {
  Row sum;
  sum.query_ns = rung.cost_ns;
  if (const auto interval = interval_of(rung)) {
    sum.query_ns_low = interval->first, sum.query_ns_high = interval->second;
    sum.samples = rung.rows.front().samples;  // as many as there are
  }
  return format_time(sum);
}

constexpr std::size_t most_ties = 4;  // that are named; the rest is counted

/// Other rungs that meet the tolerance in a time that the chosen one's cannot be told from.
std::string format_ties(const Advice& advice) {
  std::string out;
  std::size_t found = 0;
  for (std::size_t i = *advice.chosen + 1; i < advice.rungs.size(); ++i) {
    const Rung& rung = advice.rungs[i];
    if (!rung.limit.empty() || !interval_of(rung) || !as_fast(advice.rungs[*advice.chosen], rung)) continue;
    if (++found > most_ties) continue;
    out += fmt::format("  close  {} at {} meets it, too: the intervals overlap\n",
                       rung_name(rung.rows.front()), format_cost(rung));
  }
  if (found > most_ties)
    out += fmt::format("  close  {} {} it, too\n", counted(found - most_ties, "more rung", "more rungs"),
                       found - most_ties == 1 ? "meets" : "meet");
  return out;
}

Advice advise_on(const Task& task, const std::vector<Row>& rows, const std::vector<std::string>& sets,
                 double tolerance) {
  std::map<std::string, std::vector<Row>> by_rung;
  for (const Row& row : rows)
    if (row.status != Status::not_built)
      by_rung[row.method + "/" + row.build_knobs.dump() + "/" + row.query_knobs.dump()].push_back(row);
  Advice out;
  for (auto& [name, all] : by_rung) {
    Rung rung;
    for (const std::string& set : sets)
      if (const Row* row = row_of_set(all, set)) rung.rows.push_back(*row);
    if (rung.rows.size() != sets.size()) continue;
    for (const Row& row : rung.rows) {
      rung.cost_ns += row.query_ns.value_or(std::numeric_limits<double>::infinity());
      if (rung.limit.empty()) rung.limit = broken_limit(row, tolerance);
    }
    for (const Row& row : rung.rows)
      if (rung.limit.empty()) rung.limit = unpromised_limit(row, tolerance);
    for (const MethodInfo& info : task.methods())
      if (info.name == rung.rows.front().method) rung.ladder = info.ladder;
    out.rungs.push_back(std::move(rung));
  }
  std::stable_sort(out.rungs.begin(), out.rungs.end(), [](const Rung& a, const Rung& b) {
    return std::tie(a.cost_ns, a.ladder) < std::tie(b.cost_ns, b.ladder);
  });
  const auto met = std::find_if(out.rungs.begin(), out.rungs.end(),
                                [](const Rung& r) { return r.limit.empty() && std::isfinite(r.cost_ns); });
  if (met != out.rungs.end()) out.chosen = static_cast<std::size_t>(met - out.rungs.begin());
  return out;
}

constexpr double busy_share = 0.9;   // of wall time, in processor time: below, something else had the core
constexpr double busy_cells = 0.05;  // share of cells from which on that is worth a word

}  // namespace

Advice advise(const Task& task, const std::vector<Row>& rows, const std::vector<std::string>& sets,
              double tolerance) {
  Advice out = advise_on(task, rows, sets, tolerance);
  if (sets.size() < 2) return out;
  for (const std::string& set : sets) {
    const Advice alone = advise_on(task, rows, {set}, tolerance);
    if (!alone.chosen) continue;
    const Rung& rung = alone.rungs[*alone.chosen];
    const std::string name = rung_name(rung.rows.front());
    if (!out.chosen || name != rung_name(out.rungs[*out.chosen].rows.front()))
      out.alone.push_back(fmt::format("{}: {} at {}", set, name, format_cost(rung)));
  }
  return out;
}

bool answers(const Advice& advice, std::size_t sets) {
  return advice.chosen || (sets > 1 && advice.alone.size() == sets);
}

bool as_fast(const Rung& a, const Rung& b) {
  const auto ia = interval_of(a), ib = interval_of(b);
  return !ia || !ib || (ia->first <= ib->second && ib->first <= ia->second);
}

std::string format_busy(const std::vector<Row>& rows) {
  std::size_t timed = 0, slowed = 0;
  for (const Row& row : rows) {
    if (row.threads != 1 || !row.query_ns || !row.query_cpu_ns) continue;
    ++timed;
    slowed += *row.query_cpu_ns < busy_share * *row.query_ns ? 1 : 0;
  }
  if (slowed == 0 || static_cast<double>(slowed) < busy_cells * static_cast<double>(timed)) return "";
  return fmt::format(
      "  busy   in {} of {} the processor worked for less than {:.0f} % of the time: something else ran.\n"
      "         Measure again on a quiet machine before you trust close calls\n",
      slowed, counted(timed, "timed cell"), 100 * busy_share);
}

std::string format_advice(const Advice& advice, double tolerance, const std::string& again) {
  if (!advice.chosen) {
    std::string out = fmt::format("No method meets a tolerance of {:g} on every query set.\n", tolerance);
    for (const std::string& alone : advice.alone) out += fmt::format("  alone  {}\n", alone);
    std::vector<const Rung*> nearest;
    for (const Rung& rung : advice.rungs) nearest.push_back(&rung);
    const auto error_of = [](const Rung* r) {
      return worst(*r, &Errors::error).value_or(std::numeric_limits<double>::infinity());
    };
    std::ranges::stable_sort(nearest, {}, error_of);
    constexpr std::size_t most = 8;
    for (std::size_t i = 0; i < std::min(most, nearest.size()); ++i)
      out += fmt::format("  {}: {}\n", rung_name(nearest[i]->rows.front()), nearest[i]->limit);
    if (nearest.size() > most) out += fmt::format("  and {} more, farther off\n", nearest.size() - most);
    return out;
  }
  const Rung& rung = advice.rungs[*advice.chosen];
  const Row& row = rung.rows.front();
  std::string out = fmt::format("Advice for a tolerance of {:g} on {} ({}):\n", tolerance, row.dataset,
                                counted(row.n, "element"));
  out += fmt::format("  {} ({}, {})\n", rung_name(row), to_string(row.source), to_string(row.claim));
  out += fmt::format("  cost   {} for one query of each set ({})\n", format_cost(rung), cost_of(rung));
  out += fmt::format("  error  {} largest over the query sets", format_error(worst(rung, &Errors::error)));
  if (const auto max = worst(rung, &Errors::max))
    out += fmt::format(", worst single answer {}", format_error(max));
  if (const auto floor = worst(rung, &Errors::floor))
    out += fmt::format(" (truth itself ±{})", format_error(floor));
  if (!promises(row) && worst(rung, &Errors::error) <= worst(rung, &Errors::floor).value_or(0))
    out += fmt::format(
        "\n         approximate; {} on this sample, which promises nothing for other queries",
        worst(rung, &Errors::floor).value_or(0) > coarse_floor ? "as right as the truth can tell" : "exact");
  out +=
      fmt::format("\n  build  {}, {}\n", row.build_s ? format_time_ns(*row.build_s * 1e9) : "no time known",
                  row.bytes ? format_bytes(*row.bytes) : "bytes not counted");
  if (row.input_bytes && *row.input_bytes > 0) {
    out.pop_back();
    out += fmt::format(" beside {} of your own that must stay\n", format_bytes(*row.input_bytes));
  }
  if (*advice.chosen == 0) {
    out += "  below  nothing cheaper was measured\n";
  } else {
    const Rung& below = advice.rungs[*advice.chosen - 1];
    out += fmt::format("  below  {} at {} is not enough: {}\n", rung_name(below.rows.front()),
                       format_cost(below), below.limit);
  }
  out += format_ties(advice);
  for (const std::string& alone : advice.alone)
    out += fmt::format("  alone  where only this is asked, {}\n", alone);
  std::string line = again;
  if (const std::size_t at = line.find("%FILTER%"); at != std::string::npos)
    line.replace(at, 8, filter_of(rung));
  return out + format_break_even(advice) + "  again  " + line + "\n";
}

}  // namespace treeline::bench
