#include "bench/core/stress.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "bench/core/measure.hpp"

namespace treeline::bench {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t query_knobs_tried = 3;
constexpr int timeouts_tried = 2;  // then the method's other cells of this case are not waited for

}  // namespace

struct Stress::Case {
  BlockFacts facts;
  std::unique_ptr<Block> block;  // shared by the children; null: each opens its own
};

Stress::Stress(const Task& task, const Options& options, const Filter& filter, RowFile& file)
    : task_(task), options_(options), filter_(filter), file_(file) {}

void Stress::finish(const Row& row) {
  file_.add(row);
  rows_.push_back(row);
}

/// A first child opens the case and tells what it found. If that took no threads, this process opens it once
/// for all children; otherwise none may, for forks of a threaded process hang.
Stress::Case Stress::open(const BlockSpec& spec) {
  Case out;
  bool threads = false;
  const auto tell = [&](const Send& send) {
    const auto block = task_.open(spec, options_.context);
    Json offered = Json::array();
    for (std::size_t m = 0; m < task_.methods().size(); ++m) offered.push_back(block->offers(m));
    Json sets = Json::array();
    for (const QuerySet& set : block->query_sets()) sets.push_back({{"name", set.name}, {"size", set.size}});
    send(Json{{"n", block->n()},
              {"seed", block->seed()},
              {"hash", block->dataset_hash()},
              {"sets", sets},
              {"offered", offered},
              {"threads", thread_count() > 1}}
             .dump());
  };
  const Ending ending = run_isolated(tell, {.seconds = 600, .memory = 0}, [&](const std::string& line) {
    const Json told = Json::parse(line);
    out.facts = {spec, told["n"], told["seed"], told["hash"], {}, false, told["offered"]};
    for (const Json& set : told["sets"]) out.facts.query_sets.push_back({set["name"], set["size"]});
    threads = told["threads"];
  });
  if (ending.status != Status::ok)
    throw NotOpened(
        fmt::format("{} cannot be opened: {} ({})", spec.label(), to_string(ending.status), ending.reason));
  if (!threads) out.block = task_.open(spec, options_.context);
  return out;
}

std::vector<Row> Stress::run(const BlockSpec& spec, Progress& progress) {
  rows_.clear();
  Case hard = open(spec);
  std::map<std::pair<std::size_t, std::size_t>, std::vector<Cell>> by_build;
  const auto plan = [&](Cell cell) {
    if (cell.query_knobs >= query_knobs_tried || !filter_.matches(cell.name)) return;
    if (cell.row.status != Status::not_built &&
        std::ranges::count(task_.methods()[cell.method].stress_builds, cell.build) == 0)
      return;
    if (const Row* row = file_.finished(cell.row))
      rows_.push_back(*row);
    else if (cell.row.status == Status::not_built || cell.row.status == Status::unsupported)
      finish(cell.row);
    else
      by_build[{cell.method, cell.build}].push_back(std::move(cell));
  };
  for (Cell& cell : not_built_cells(task_, hard.facts, options_.context.threads)) plan(std::move(cell));
  for (Cell& cell : cells_of(task_, hard.facts, options_.context.threads)) plan(std::move(cell));
  double done = 0;
  for (auto& [which, cells] : by_build) {
    progress.step(done++ / static_cast<double>(by_build.size()), task_.methods()[which.first].name);
    run_build(hard, std::move(cells));
  }
  return std::move(rows_);
}

void Stress::run_build(Case& hard, std::vector<Cell> cells) {
  std::size_t next = 0;
  int timeouts = 0;
  while (next < cells.size()) {
    bool built = false;
    const auto work = [&](const Send& send) {
      if (options_.context.threads > 1) SingleThreaded::lift();
      std::unique_ptr<Block> own;
      if (!hard.block) own = task_.open(hard.facts.spec, options_.context);
      send("opened");  // the limit of time starts anew
      Block& block = own ? *own : *hard.block;
      const Build build =
          timed_build(block, cells[next].method, cells[next].row.build_knobs, options_.context.threads, {});
      if (build.subject) send("built");
      for (std::size_t i = next; i < cells.size(); ++i) {
        Cell cell = cells[i];
        note_build(cell.row, build, task_.methods()[cell.method], block);
        if (build.subject) {
          const double ns = 1e9 * run_and_check(block, *build.subject, cell);
          if (cell.row.status == Status::ok || cell.row.status == Status::wrong) {
            cell.row.query_ns = ns / static_cast<double>(std::max<std::size_t>(cell.row.queries, 1));
            cell.row.samples = {*cell.row.query_ns};
          }
        }
        send(cell.row.to_line());
      }
    };
    const Ending ending = run_isolated(work, options_.limits, [&](const std::string& line) {
      if (line == "opened") return;
      if (line == "built")
        built = true;
      else
        finish(Row::from_json(Json::parse(line))), ++next;
    });
    if (next >= cells.size()) return;  // what comes after the last answer is no cell's matter
    timeouts += ending.status == Status::timeout;
    const std::string reason = ending.reason + (built ? "" : " (in the build)");
    const auto end_cell = [&](const std::string& why) {
      Row& row = cells[next++].row;
      row.status = ending.status, row.reason = why;
      finish(row);
    };
    end_cell(reason);
    if (built && timeouts < timeouts_tried) continue;
    while (next < cells.size()) end_cell(built ? "not tried after others of this case: " + reason : reason);
  }
}

}  // namespace treeline::bench
