// What every method file of this folder implements: an index built over rows, asked one batch at a time.
//
// Answers are ids only; distances and errors are derived by the task, in double.
#pragma once

#include <memory>
#include <optional>
#include <span>

#include "accel/rows/rows.hpp"
#include "bench/core/task.hpp"

namespace treeline::bench::knn_nd {

using accel::Id;
using RowsView = accel::RowsView<float>;

/// What an index is built over. The rows outlive the index.
struct Input {
  RowsView rows;
  int threads = 1;
};

class Index {
 public:
  virtual ~Index() = default;
  /// k ids per query, row after row. `ids` comes filled with no_id; what is not found stays so.
  virtual void nearest(RowsView queries, std::size_t k, const Knobs& query_knobs, int threads,
                       std::span<Id> ids) const = 0;
  /// Nodes and rows touched by the same batch, per batch; nothing if the method cannot count.
  virtual std::optional<accel::Work> nearest_work(RowsView, std::size_t, const Knobs&) const { return {}; }
};

/// A method: what it is, and how to build it. build throws to refuse the input.
struct Method {
  MethodInfo info;
  std::unique_ptr<Index> (*build)(const Input&, const Knobs& build_knobs) = nullptr;
};

}  // namespace treeline::bench::knn_nd
