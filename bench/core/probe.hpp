// A trial of the peers on input that nobody has tried before: one that crashes on it in this process would
// take all rows with it. Each is built and asked once in a child first. A build that fails at one of its
// cells loses them all: what it answers after that is not known.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "bench/core/cells.hpp"
#include "bench/core/isolation.hpp"
#include "bench/core/row_file.hpp"

namespace treeline::bench {

/// Method and build knobs (indices) that did not survive the trial, and how they ended.
using Broken = std::map<std::pair<std::size_t, std::size_t>, Ending>;

/// What is tried: the cells that a run would measure.
struct Chosen {
  const Filter& filter;
  const RowFile& finished;        // their rows are there already
  std::vector<std::string> sets;  // empty: all
  int threads = 1;
};

/// Whether a query set is among the chosen ones.
bool has_set(const std::vector<std::string>& sets, const std::string& set);

/// Tries every chosen build of a peer: each of its query sets once with each of its query knobs, for a later
/// knob may take another path through the library. `open` is called in the children; what it throws ends the
/// trial, for the caller's own open() to say so.
/// tell: called with the method and query set that are being tried, for whoever waits.
/// This process must have no threads yet. Throws std::runtime_error if open() itself crashes or hangs.
Broken try_peers(const Task&, const BlockSpec&, const std::function<std::unique_ptr<Block>()>& open,
                 const Chosen&, const Limits&, const std::function<void(const std::string&)>& tell = {});

}  // namespace treeline::bench
