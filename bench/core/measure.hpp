// The untimed and once-timed parts of a cell, shared by ordinary blocks and isolated hard cases.
#pragma once

#include <memory>

#include "bench/core/cells.hpp"

namespace treeline::bench {

struct Build {
  std::unique_ptr<Subject> subject;  // null: not built, and why
  Status status = Status::ok;
  std::string reason;
  double seconds = 0;
  std::optional<std::size_t> bytes;
};

/// How often to build: at most so often, and not again once it took so long in all.
struct BuildRuns {
  int most = 1;
  double enough_s = 0;
};

/// Seconds are the median of the runs, bytes those of the last.
Build timed_build(Block&, std::size_t method, const Knobs& build_knobs, int threads, const BuildRuns&);
/// Copies status, seconds and bytes into a row, and what the method keeps of the caller's data.
void note_build(Row&, const Build&, const MethodInfo&, const Block&);

/// Runs the cell's batch once, asks for the error of its answers and for its work, and fills the row with all
/// of it but the time. Returns the seconds of that one run.
double run_and_check(Block&, Subject&, Cell&);

/// Whether this row is a failure of ours, as the exit status has it. must_answer: refusing is one, too.
bool is_failure(const Row&, bool must_answer);

}  // namespace treeline::bench
