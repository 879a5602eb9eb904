// What every method file of this folder implements: an index over points that come and go.
//
// All points that ever come are a pool, and a point's id is its number there. They come in the pool's order.
// Answers are ids only; distances and errors are derived by the task, in double.
#pragma once

#include <memory>
#include <span>

#include "accel/concepts.hpp"
#include "bench/core/task.hpp"
#include "geometry/vec.hpp"

namespace treeline::bench::knn_dynamic {

using accel::Id;
using geometry::Vec3f;

class Index {
 public:
  virtual ~Index() = default;
  /// These go, then the points first, …, last - 1 of the pool come; afterwards it can be asked.
  virtual void change(std::span<const Id> gone, Id first, Id last) = 0;
  /// k ids per query, row after row, nearest first. `ids` comes filled with no_id; what is not found stays
  /// so.
  virtual void nearest(std::span<const Vec3f> queries, std::size_t k, int threads,
                       std::span<Id> ids) const = 0;
  /// How many trees each query searches.
  virtual std::size_t trees() const { return 1; }
};

/// What an index is over; the pool outlives it.
struct Input {
  std::span<const Vec3f> pool;
  int threads = 1;
};

/// A method: what it is, and how to make it, empty. Where points come one by one, `by_the_piece` says whether
/// it is tried: rebuilding n points n times over takes minutes and would tell nothing new. `keeps` says
/// whether it keeps anything up to date: if not, a change alone has no cost to compare.
struct Method {
  MethodInfo info;
  std::unique_ptr<Index> (*make)(const Input&, const Knobs& build_knobs) = nullptr;
  bool by_the_piece = true, keeps = true;
};

}  // namespace treeline::bench::knn_dynamic
