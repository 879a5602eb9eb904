// What every method file of this folder implements: an index built over points, asked one batch at a time.
//
// Answers are ids only; distances and errors are derived by the task, in double. One virtual call per batch,
// so that all methods pay the same for being behind an interface.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "accel/concepts.hpp"
#include "bench/core/task.hpp"
#include "geometry/box.hpp"

namespace treeline::bench::knn {

using accel::Id;
using accel::Lists;
using geometry::Box3f;
using geometry::Vec3d;
using geometry::Vec3f;

/// What an index is built over. The points outlive the index. T: float, or double for clouds that float
/// cannot hold.
template <class T>
struct InputOf {
  std::span<const geometry::Vec<T, 3>> points;
  bool finite = true;  // no NaN or infinite coordinate among the points
  double spacing =
      0;  // median distance from a point to its nearest other one; 0 if all sampled ones coincide
  int threads = 1;
};

/// Counts what queries touch. Trees tell of nodes and primitives only; a leaf shows as the first primitives
/// after a node, or as several at once (points that coincide are told one by one).
struct Visits {
  std::uint64_t nodes = 0, leaves = 0, primitives = 0;

  void node() { ++nodes, entered_ = true; }
  void primitive(std::uint64_t n = 1) {
    leaves += entered_ || n > 1 ? 1 : 0;
    primitives += n;
    entered_ = false;
  }

 private:
  bool entered_ = false;
};

template <class T>
class IndexOf {
 public:
  using Point = geometry::Vec<T, 3>;
  using Box = geometry::Box<T, 3>;

  virtual ~IndexOf() = default;

  /// k ids per query, row after row, nearest first. `ids` comes filled with no_id; what is not found stays
  /// so.
  virtual void nearest(std::span<const Point> queries, std::size_t k, const Knobs& query_knobs, int threads,
                       std::span<Id> ids) const;
  /// Ids of all points within the radius of each query, in any order.
  virtual void within(std::span<const Point> queries, T radius, const Knobs& query_knobs, int threads,
                      Lists<Id>& ids) const;
  /// Ids of all points inside each closed box, in any order.
  virtual void inside(std::span<const Box> boxes, const Knobs& query_knobs, int threads,
                      Lists<Id>& ids) const;

  /// What the same batch touches; nothing if the method cannot count.
  virtual std::optional<Visits> nearest_visits(std::span<const Point> queries, std::size_t k,
                                               const Knobs& query_knobs) const;
  virtual std::optional<Visits> within_visits(std::span<const Point> queries, T radius) const;
  virtual std::optional<Visits> inside_visits(std::span<const Box> boxes) const;

  /// Cells cut by a plane, for pictures; empty if the method has none to show.
  virtual std::vector<accel::SliceCell> slice(int axis, double offset) const;
};

extern template class IndexOf<float>;
extern template class IndexOf<double>;
using Input = InputOf<float>;
using Index = IndexOf<float>;

/// A method: what it is, and how to build it, over floats or over doubles; it has cells only on the clouds of
/// these. Building throws to refuse the input.
struct Method {
  MethodInfo info;
  std::unique_ptr<Index> (*build)(const Input&, const Knobs& build_knobs) = nullptr;
  std::unique_ptr<IndexOf<double>> (*build_double)(const InputOf<double>&,
                                                   const Knobs& build_knobs) = nullptr;
  bool rounds_points = false;  // answers are about points slightly moved
};

}  // namespace treeline::bench::knn
