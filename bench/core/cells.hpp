// Cells: what a block measures, one row each; their names, and which a filter chooses.
#pragma once

#include <exception>
#include <optional>
#include <regex>
#include <string>
#include <utility>
#include <vector>

#include "bench/core/task.hpp"

namespace treeline::bench {

/// {"leaf": 8, "split": "sah"} → "leaf=8,split=sah"; {} → "-".
std::string format_knobs(const Knobs&);

struct Cell {
  std::size_t method = 0, build = 0, query_knobs = 0, query_set = 0;
  std::string name;  // block/query set/method/build knobs/query knobs, for filters and Google Benchmark; of
                     // thread scaling with the threads at its end
  Row row;           // filled but for what is measured
};

/// Google Benchmark's filter: an extended regular expression searched in the name, "-" in front negates.
class Filter {
 public:
  /// Throws UsageError for an expression that is none.
  explicit Filter(const std::string& expression);
  bool matches(const std::string& name) const;

 private:
  std::optional<std::regex> regex_;  // none: everything matches
  bool negate_;
};

/// What identifies a block in its rows.
struct BlockFacts {
  BlockSpec spec;
  std::size_t n = 0;
  std::uint64_t seed = 0, hash = 0;
  std::vector<QuerySet> query_sets;
  bool quick = false;
  std::vector<bool> offered;  // by method; those beyond its end are
};
BlockFacts facts_of(const Task&, const BlockSpec&, const Block&);

/// All cells of a block, methods in the task's order, then build knobs, query sets and query knobs. Of a hard
/// case also those that MethodInfo::sweep_up_to_n leaves out, as `unsupported`.
std::vector<Cell> cells_of(const Task&, const BlockFacts&, int threads);
/// The rows of the peers that this build lacks, one a query set.
std::vector<Cell> not_built_cells(const Task&, const BlockFacts&, int threads);

/// The dataset as rows name it: with the task's own flags that were given, as these ask something else about
/// it. Rows of different flags are so kept apart wherever rows are.
std::string named(const std::string& dataset, const RunContext&);

/// An exception in flight, as a status and its reason.
std::pair<Status, std::string> classify(std::exception_ptr);

}  // namespace treeline::bench
