#include "bench/core/harness.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <tuple>

#include "bench/core/measure.hpp"

namespace treeline::bench {
namespace {

constexpr double checking_share = 0.3;  // of a query set's time: one run of each cell, and its judging
constexpr double memory_share = 0.4;    // of the free memory, for subjects held at one time

std::size_t memory_budget() {
  const auto pages = static_cast<double>(sysconf(_SC_AVPHYS_PAGES));
  return static_cast<std::size_t>(memory_share * pages * static_cast<double>(sysconf(_SC_PAGESIZE)));
}

void note_times(Row& row, const std::vector<Repetition>& repetitions) {
  const double per_query = 1e9 / static_cast<double>(std::max<std::size_t>(row.queries, 1));
  std::vector<double> cpu;
  for (const Repetition& r : repetitions) {
    row.samples.push_back(r.seconds * per_query);
    cpu.push_back(r.cpu_seconds * per_query / row.threads);  // a thread's share of the process
  }
  const MedianInterval wall = median_interval(row.samples);
  row.query_ns = wall.median, row.query_ns_low = wall.low, row.query_ns_high = wall.high;
  row.query_cpu_ns = median_interval(cpu).median;
}

}  // namespace

struct Harness::Group {
  struct Held {
    Build build;
    std::vector<Cell> cells;
  };
  std::vector<Held> held;
};

Harness::Harness(const Task& task, const Options& options, const Filter& filter, RowFile& file, Timer& timer)
    : task_(task), options_(options), filter_(filter), file_(file), timer_(timer) {}

void Harness::finish(const Row& row) {
  file_.add(row);
  rows_.push_back(row);
}

std::vector<Row> Harness::run(const BlockFacts& facts, Block& block, Progress& progress,
                              const std::vector<std::string>& sets, const Broken& broken,
                              std::vector<int> thread_counts) {
  rows_.clear();
  if (thread_counts.empty()) thread_counts = {options_.context.threads};
  std::vector<Cell> pending;
  const auto plan = [&](Cell cell) {
    if (!filter_.matches(cell.name)) return;
    if (!has_set(sets, cell.row.query_set)) return;
    if (const Row* row = file_.finished(cell.row)) {
      rows_.push_back(*row);
      return;
    }
    if (cell.row.status == Status::not_built) return finish(cell.row);
    const std::size_t largest = task_.methods()[cell.method].largest(facts.quick);
    if (facts.n > largest) {
      cell.row.status = Status::unsupported;
      cell.row.reason = fmt::format("not run above n = {}", largest);
      return finish(cell.row);
    }
    if (const auto found = broken.find({cell.method, cell.build}); found != broken.end()) {
      cell.row.status = found->second.status;
      cell.row.reason = "in a trial run: " + found->second.reason;
      return finish(cell.row);
    }
    pending.push_back(std::move(cell));
  };
  for (const int threads : thread_counts) {
    for (Cell& cell : not_built_cells(task_, facts, threads)) plan(std::move(cell));
    for (Cell& cell : cells_of(task_, facts, threads)) plan(std::move(cell));
  }

  for (std::size_t next = 0; next < pending.size();) {
    const std::size_t first = next;
    Group group = next_group(pending, next, block, progress);
    for (std::size_t s = 0; s < facts.query_sets.size(); ++s) {
      const auto tell = [&](double share, const std::string& method) {
        const double done = (static_cast<double>(s) + share) / static_cast<double>(facts.query_sets.size());
        progress.step((static_cast<double>(first) + done * static_cast<double>(next - first)) /
                          static_cast<double>(pending.size()),
                      facts.query_sets[s].name + " by " + method);
      };
      run_query_set(group, s, block, tell);
    }
  }
  return std::move(rows_);
}

/// Builds from cell `next` on until the memory budget is used up.
Harness::Group Harness::next_group(std::vector<Cell>& cells, std::size_t& next, Block& block,
                                   Progress& progress) {
  const Profile profile = options_.context.profile;
  const BuildRuns runs{profile == Profile::smoke ? 1 : 3, profile == Profile::full ? 1.0 : 0.1};
  const std::size_t budget = memory_budget();
  Group group;
  for (std::size_t used = 0; next < cells.size() && used <= budget;) {
    const std::size_t method = cells[next].method, knobs = cells[next].build;
    const int threads = cells[next].row.threads;
    progress.step(static_cast<double>(next) / static_cast<double>(cells.size()),
                  "building " + cells[next].row.method);
    Group::Held held;
    held.build = timed_build(block, method, cells[next].row.build_knobs, threads, runs);
    const auto of_this_build = [&](const Cell& cell) {
      return cell.method == method && cell.build == knobs && cell.row.threads == threads;
    };
    for (; next < cells.size() && of_this_build(cells[next]); ++next) {
      note_build(cells[next].row, held.build, task_.methods()[method], block);
      if (held.build.subject)
        held.cells.push_back(std::move(cells[next]));
      else
        finish(cells[next].row);
    }
    used += held.build.bytes.value_or(0);
    if (held.build.subject) group.held.push_back(std::move(held));
  }
  return group;
}

void Harness::run_query_set(Group& group, std::size_t query_set, Block& block,
                            const std::function<void(double, const std::string&)>& tell) {
  std::vector<Cell*> cells;
  std::vector<Cell*> timed;
  std::vector<TimedCell> timing;
  double builds = 0;
  for (Group::Held& held : group.held) {
    const double share = checking_share * builds++ / static_cast<double>(group.held.size());
    for (Cell& cell : held.cells) {
      if (cell.query_set != query_set) continue;
      cells.push_back(&cell);
      tell(share, cell.row.method);
      const double seconds = run_and_check(block, *held.build.subject, cell);
      if (cell.row.status != Status::ok && cell.row.status != Status::wrong) continue;
      timed.push_back(&cell);
      TimedCell& timing_of = timing.emplace_back();
      timing_of.name = cell.name;
      timing_of.run = [&cell, &subject = *held.build.subject] {
        subject.run(cell.query_set, cell.row.query_knobs, cell.row.threads);
      };
      timing_of.seconds = seconds;
    }
  }
  timer_.measure(timing, [&](double share, const TimedCell& at) {
    tell(checking_share + (1 - checking_share) * share,
         timed[static_cast<std::size_t>(&at - timing.data())]->row.method);
  });
  for (std::size_t i = 0; i < timing.size(); ++i) {
    if (timing[i].error)
      std::tie(timed[i]->row.status, timed[i]->row.reason) = classify(timing[i].error);
    else if (!timing[i].repetitions.empty())
      note_times(timed[i]->row, timing[i].repetitions);
  }
  for (const Cell* cell : cells) finish(cell->row);
}

}  // namespace treeline::bench
