#include "bench/core/cells.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <new>

#include "bench/core/options.hpp"

namespace treeline::bench {
namespace {

std::string cell_name(const Row& row, bool scaling) {
  return fmt::format("{}/{}/{}/{}/{}{}", row.block, row.query_set, row.method, format_knobs(row.build_knobs),
                     format_knobs(row.query_knobs), scaling ? fmt::format("/{}", row.threads) : "");
}

Row row_of(const Task& task, const BlockFacts& facts, const QuerySet& set, int threads) {
  Row row;
  row.task = task.name();
  row.block = facts.spec.label(), row.dataset = facts.spec.dataset;
  row.n = facts.n, row.seed = facts.seed;
  row.dataset_hash = format_hash(facts.hash);
  row.query_set = set.name, row.queries = set.size, row.threads = threads;
  row.advised = !facts.spec.hard && !facts.spec.scaling && std::ranges::count(task.advise_on(), set.name) > 0;
  return row;
}

}  // namespace

std::string format_knobs(const Knobs& knobs) {
  std::string out;
  for (const auto& [name, value] : knobs.items())
    out +=
        (out.empty() ? "" : ",") + name + "=" + (value.is_string() ? value.get<std::string>() : value.dump());
  return out.empty() ? "-" : out;
}

Filter::Filter(const std::string& expression) : negate_(expression.starts_with('-')) {
  if (expression.empty() || expression == "all") return;  // Google Benchmark's word
  try {
    regex_.emplace(expression.substr(negate_), std::regex::extended | std::regex::nosubs);
  } catch (const std::regex_error& e) {
    throw UsageError(fmt::format("--benchmark_filter={}: {}", expression, e.what()));
  }
}

bool Filter::matches(const std::string& name) const {
  return !regex_ || std::regex_search(name, *regex_) != negate_;
}

BlockFacts facts_of(const Task& task, const BlockSpec& spec, const Block& block) {
  BlockFacts facts{spec,          block.n(), block.seed(), block.dataset_hash(), block.query_sets(),
                   block.quick(), {}};
  for (std::size_t m = 0; m < task.methods().size(); ++m) facts.offered.push_back(block.offers(m));
  return facts;
}

std::vector<Cell> cells_of(const Task& task, const BlockFacts& facts, int threads) {
  std::vector<Cell> out;
  const auto& methods = task.methods();
  for (std::size_t m = 0; m < methods.size(); ++m) {
    if (m < facts.offered.size() && !facts.offered[m]) continue;
    if (facts.spec.scaling && !methods[m].scales) continue;
    for (std::size_t b = 0; b < methods[m].build_knobs.size(); ++b) {
      if (methods[m].hard_cases_only && !facts.spec.hard) break;
      const bool beyond_sweep = b > 0 && facts.n > methods[m].sweep_up_to_n;
      if (beyond_sweep && !facts.spec.hard) break;
      if (facts.quick && b >= methods[m].quick_builds) break;
      for (std::size_t s = 0; s < facts.query_sets.size(); ++s)
        for (std::size_t q = 0; q < methods[m].query_knobs.size(); ++q) {
          Cell cell{m, b, q, s, "", row_of(task, facts, facts.query_sets[s], threads)};
          Row& row = cell.row;
          row.method = methods[m].name, row.family = methods[m].family, row.source = methods[m].source;
          row.peer_version = methods[m].peer_version, row.claim = methods[m].claim;
          row.build_knobs = methods[m].build_knobs[b], row.query_knobs = methods[m].query_knobs[q];
          cell.name = cell_name(row, facts.spec.scaling);
          if (beyond_sweep) {  // the matrix of hard cases has a place for it, and should say why it is empty
            row.status = Status::unsupported;
            row.reason =
                fmt::format("above n = {} only the first of its builds is tried", methods[m].sweep_up_to_n);
          }
          out.push_back(std::move(cell));
        }
    }
  }
  return out;
}

std::vector<Cell> not_built_cells(const Task& task, const BlockFacts& facts, int threads) {
  std::vector<Cell> out;
  for (const auto& [method, package] : task.not_built())
    for (std::size_t s = 0; s < facts.query_sets.size(); ++s) {
      Cell cell{0, 0, 0, s, "", row_of(task, facts, facts.query_sets[s], threads)};
      cell.row.method = method, cell.row.source = Source::peer;
      cell.row.status = Status::not_built, cell.row.reason = "this build has no " + package;
      cell.name = cell_name(cell.row, facts.spec.scaling);
      out.push_back(std::move(cell));
    }
  return out;
}

std::string named(const std::string& dataset, const RunContext& context) {
  std::string out = dataset;
  for (const auto& [flag, value] : context.own) out.append(" ").append(flag).append(" ").append(value);
  return out;
}

std::pair<Status, std::string> classify(std::exception_ptr error) {
  try {
    std::rethrow_exception(error);
  } catch (const std::bad_alloc&) {
    return {Status::out_of_memory, "out of memory"};
  } catch (const Unsupported& e) {
    return {Status::unsupported, e.what()};
  } catch (const std::exception& e) {
    return {Status::refused, e.what()};
  } catch (...) {
    return {Status::refused, "an exception that is no std::exception"};
  }
}

}  // namespace treeline::bench
