// The ordinary way through a block: build every method, then query set by query set time all cells in turn,
// and write their rows as soon as the query set is done.
#pragma once

#include <functional>

#include "bench/core/cells.hpp"
#include "bench/core/probe.hpp"
#include "bench/core/progress.hpp"
#include "bench/core/row_file.hpp"
#include "bench/core/timing.hpp"

namespace treeline::bench {

class Harness {
 public:
  Harness(const Task&, const Options&, const Filter&, RowFile&, Timer&);

  /// Rows of all chosen cells of the block, those of an earlier run included. With `sets`, only of these.
  /// What is broken is not built; its rows say how it ended. With thread counts, at each of these instead of
  /// the options' one, all of them by turns: their ratios are what one wants to know.
  std::vector<Row> run(const BlockFacts&, Block&, Progress&, const std::vector<std::string>& sets = {},
                       const Broken& broken = {}, std::vector<int> thread_counts = {});

 private:
  struct Group;  // subjects held at one time, and their cells
  Group next_group(std::vector<Cell>& cells, std::size_t& next, Block&, Progress&);
  /// tell: the share done and at which method.
  void run_query_set(Group&, std::size_t query_set, Block&,
                     const std::function<void(double share, const std::string& method)>& tell);
  void finish(const Row&);

  const Task& task_;
  const Options& options_;
  const Filter& filter_;
  RowFile& file_;
  Timer& timer_;
  std::vector<Row> rows_;
};

}  // namespace treeline::bench
