// What a ray method gives the task: an index built over a mesh that answers whole batches of rays.
//
// One virtual call a batch, never one a ray. Ours and the peers answer in the same record, and peers loop
// over a batch with the same threads and grain as our trees (accel/batch.hpp).
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "accel/concepts.hpp"
#include "bench/core/task.hpp"
#include "geometry/mesh.hpp"

namespace treeline::bench::ray {

/// t and primitive are judged; u and v are not, and peers leave them 0.
using RayAnswer = accel::Hit<float>;

class Index {
 public:
  virtual ~Index() = default;
  virtual void closest(std::span<const geometry::Rayf> rays, std::span<RayAnswer> out,
                       const Knobs& query_knobs, int threads) const = 0;
  virtual void any(std::span<const geometry::Rayf> rays, std::span<std::uint8_t> out,
                   const Knobs& query_knobs, int threads) const = 0;
  /// Nodes and primitives touched per ray, where they can be counted.
  virtual std::optional<std::pair<double, double>> work(std::span<const geometry::Rayf>, bool /*any*/) const {
    return std::nullopt;
  }
  /// Nodes and primitives that each of these rays touches, for pictures; empty where they cannot be counted.
  virtual std::vector<accel::Work> work_of_each(std::span<const geometry::Rayf>) const { return {}; }
  /// The same faces with moved vertices: updates what bounds them and keeps the structure, at a cost in
  /// proportion to its size. The mesh has as many vertices and the same faces as the one built over.
  /// False, with nothing done, where the method has no such thing. Throws Unsupported where it has, but not
  /// in what is measured here.
  virtual bool refit(const geometry::Mesh3f&) { return false; }
  /// What the structure tells of itself, as fields of the row: ray_references, ray_depth, …
  virtual Knobs facts() const { return Knobs::object(); }
  /// Cells cut by a plane, for pictures; empty if the method has none to show.
  virtual std::vector<accel::SliceCell> slice(int /*axis*/, double /*offset*/) const { return {}; }
};

struct Method {
  MethodInfo info;
  std::function<std::unique_ptr<Index>(const geometry::Mesh3f&, const Knobs& build_knobs, int threads)> build;
  /// Makes what the method's library sets up once a process and lifts the limit that it sets to the threads
  /// of everybody in it; called before anything is built.
  std::function<void(int threads)> warm_up = {};
};

}  // namespace treeline::bench::ray
