#include "bench/core/probe.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

namespace treeline::bench {
namespace {

/// What of the peers' cells a run would measure, builds together.
std::vector<Cell> cells_to_try(const Task& task, const BlockFacts& facts, const Chosen& chosen) {
  std::vector<Cell> out;
  for (Cell& cell : cells_of(task, facts, chosen.threads)) {
    const MethodInfo& method = task.methods()[cell.method];
    if (method.source != Source::peer || facts.n > method.largest(facts.quick)) continue;
    if (!chosen.filter.matches(cell.name) || !has_set(chosen.sets, cell.row.query_set)) continue;
    if (!chosen.finished.finished(cell.row)) out.push_back(std::move(cell));
  }
  return out;
}

/// Builds once and answers cells [first, last), which are of one build. Says which comes next, so that the
/// limit of time starts anew.
void try_build(Block& block, const Cell* first, const Cell* last, const Send& send) {
  std::unique_ptr<Subject> subject;
  try {
    subject = block.build(first->method, first->row.build_knobs, first->row.threads);
  } catch (...) {  // refused, or more: the run itself will hear the same
    return;
  }
  for (const Cell* cell = first; cell != last; ++cell) {
    send("cell " + cell->row.query_set + " " + format_knobs(cell->row.query_knobs));
    try {
      subject->prepare(cell->query_set, cell->row.threads);
      subject->run(cell->query_set, cell->row.query_knobs, cell->row.threads);
    } catch (...) {
    }
  }
}

}  // namespace

bool has_set(const std::vector<std::string>& sets, const std::string& set) {
  return sets.empty() || std::find(sets.begin(), sets.end(), set) != sets.end();
}

Broken try_peers(const Task& task, const BlockSpec& spec, const std::function<std::unique_ptr<Block>()>& open,
                 const Chosen& chosen, const Limits& limits,
                 const std::function<void(const std::string&)>& tell) {
  Broken out;
  for (std::size_t next = 0;;) {  // number of the build that the next child starts with
    bool opened = false, refused = false;
    std::pair<std::size_t, std::size_t> at;
    const auto work = [&](const Send& send) {
      if (chosen.threads > 1) SingleThreaded::lift();
      std::unique_ptr<Block> block;
      try {
        block = open();
      } catch (...) {
        return send("refused");
      }
      const auto cells = cells_to_try(task, facts_of(task, spec, *block), chosen);
      send("opened");
      std::size_t build = 0;
      for (std::size_t first = 0, last = 0; first < cells.size(); first = last, ++build) {
        while (last < cells.size() && cells[last].method == cells[first].method &&
               cells[last].build == cells[first].build)
          ++last;
        if (build < next) continue;
        send(fmt::format("at {} {}", cells[first].method, cells[first].build));
        try_build(*block, &cells[first], cells.data() + last, send);
      }
      send("done");
    };
    bool started = false, done = false;
    std::string cell;  // that was being answered; empty: the build
    std::size_t number = next;
    const Ending ending = run_isolated(work, limits, [&](const std::string& line) {
      if (line == "refused") refused = true;
      if (line == "opened") opened = true;
      if (line == "done") done = true;
      if (line.starts_with("cell ")) {
        cell = line.substr(5);
        if (tell) tell(cell.substr(0, cell.find(' ')) + " by " + task.methods()[at.first].name);
      }
      if (!line.starts_with("at ")) return;
      cell.clear();
      const std::size_t space = line.find(' ', 3);
      at = {std::stoul(line.substr(3, space - 3)), std::stoul(line.substr(space + 1))};
      number += started, started = true;
      if (tell) tell("a build of " + task.methods()[at.first].name);
    });
    if (refused || done || ending.status == Status::ok) return out;
    if (!opened)
      throw std::runtime_error(
          fmt::format("cannot be opened: {} ({})", to_string(ending.status), ending.reason));
    if (!started) return out;
    out[at] = ending;
    if (!cell.empty()) out[at].reason += " (in " + cell + ")";
    next = number + 1;
  }
}

}  // namespace treeline::bench
