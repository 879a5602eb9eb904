// The hard cases of a task: each method in a child process with a limit on time and memory, so that one that
// crashes costs its rows and no others. One run a cell; these rows are about answers, not about speed.
#pragma once

#include <stdexcept>

#include "bench/core/cells.hpp"
#include "bench/core/isolation.hpp"
#include "bench/core/options.hpp"
#include "bench/core/progress.hpp"
#include "bench/core/row_file.hpp"

namespace treeline::bench {

/// A hard case that could not be opened, so that no method was tried on it. Says which and why.
struct NotOpened : std::runtime_error {
  using std::runtime_error::runtime_error;
};

class Stress {
 public:
  Stress(const Task&, const Options&, const Filter&, RowFile&);

  /// Rows of all chosen cells, those of an earlier run included: each method with its first build knobs and
  /// its first three query knobs. Throws NotOpened.
  std::vector<Row> run(const BlockSpec&, Progress&);

 private:
  struct Case;
  Case open(const BlockSpec&);
  void run_build(Case&, std::vector<Cell> cells);
  void finish(const Row&);

  const Task& task_;
  const Options& options_;
  const Filter& filter_;
  RowFile& file_;
  std::vector<Row> rows_;
};

}  // namespace treeline::bench
