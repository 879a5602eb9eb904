// What a method gives the task: an index built over a mesh that finds the nearest points of whole batches of
// queries.
//
// One virtual call a batch, never one a query. Each method answers in the scalar that it computes in; peers
// loop over a batch with the same threads and grain as our trees (accel/batch.hpp).
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <variant>
#include <vector>

#include "accel/concepts.hpp"
#include "bench/core/task.hpp"
#include "geometry/mesh.hpp"
#include "geometry/tolerances.hpp"

namespace treeline::bench::closest_point {

/// A batch in both scalars; the coordinates are floats in both.
struct Queries {
  std::vector<geometry::Vec3f> floats;
  std::vector<geometry::Vec3d> doubles;

  Queries() = default;
  explicit Queries(std::vector<geometry::Vec3f> points) : floats(std::move(points)) {
    for (const auto& p : floats) doubles.emplace_back(p);
  }
  std::size_t size() const { return floats.size(); }
};

/// What a method says of one query: the point, the triangle that it is on, and the squared distance.
using Answer = accel::ClosestPoint<double>;

/// The answers to a batch, in the scalar of the method. Features are not judged, and peers leave them.
class Answers {
 public:
  template <class T>
  std::span<accel::ClosestPoint<T>> fill(std::size_t size) {
    auto* held = std::get_if<std::vector<accel::ClosestPoint<T>>>(&all_);
    if (!held) held = &all_.emplace<std::vector<accel::ClosestPoint<T>>>();
    held->resize(size);
    return *held;
  }
  Answer operator[](std::size_t i) const {
    return std::visit(
        [&](const auto& all) {
          const auto& a = all[i];
          return Answer{static_cast<double>(a.distance2), a.primitive, a.feature, geometry::Vec3d(a.point)};
        },
        all_);
  }
  bool in_float() const { return all_.index() == 0; }

 private:
  std::variant<std::vector<accel::ClosestPoint<float>>, std::vector<accel::ClosestPoint<double>>> all_;
};

class Index {
 public:
  virtual ~Index() = default;
  virtual void closest(const Queries& queries, Answers& out, const Knobs& query_knobs, int threads) const = 0;
  /// Nodes and triangles touched per query, where they can be counted.
  virtual std::optional<std::pair<double, double>> work(const Queries&) const { return std::nullopt; }
  /// Nodes and triangles that each of these queries touches, for pictures; empty where they cannot be
  /// counted.
  virtual std::vector<accel::Work> work_of_each(const Queries&) const { return {}; }
  /// What the structure tells of itself, as fields of the row: closest_point_references, …
  virtual Knobs facts() const { return Knobs::object(); }
};

struct Method {
  MethodInfo info;
  std::function<std::unique_ptr<Index>(const geometry::Mesh3f&, const Knobs& build_knobs, int threads)> build;
  /// Of the arithmetic in which the bound of a bounded method is stated.
  double roundoff = geometry::tolerance::unit_roundoff<float>;
  /// The ids in its answers are those of the mesh's faces. False where it searches a mesh of its own: then
  /// only the points are judged.
  bool names_triangles = true;
  /// Makes what the method's library sets up once a process and lifts the limit that it sets to the threads
  /// of everybody in it; called before anything is built.
  std::function<void(int threads)> warm_up = {};
};

}  // namespace treeline::bench::closest_point
