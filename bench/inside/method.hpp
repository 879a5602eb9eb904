// What a method gives the task: an index built over a mesh that tells of whole batches of points whether they
// are inside.
//
// One virtual call a batch, never one a query. Peers loop over a batch with the same threads and grain as our
// trees (accel/batch.hpp).
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "bench/core/task.hpp"
#include "geometry/mesh.hpp"

namespace treeline::bench::inside {

class Index {
 public:
  virtual ~Index() = default;
  /// out[i] becomes 1 if points[i] is inside or on the surface, else 0.
  virtual void inside(std::span<const geometry::Vec3f> points, std::span<std::uint8_t> out,
                      const Knobs& query_knobs, int threads) const = 0;
  /// What the build made, for the row, in fields of its own: "inside_" and a name.
  virtual Knobs facts() const { return Knobs::object(); }
};

struct Method {
  MethodInfo info;
  std::function<std::unique_ptr<Index>(const geometry::Mesh3f&, const Knobs& build_knobs, int threads)> build;
  /// It goes by the nearest face alone, which says nothing where two faces lie in one another.
  bool by_nearest_face = false;
  /// It goes by which way the first face on a ray looks: into a solid that the ray enters from within another
  /// one, out of which it takes the point to be.
  bool by_facing = false;
  /// It is there to be seen failing: no share of wrong answers breaks a promise.
  bool promises_nothing = false;
  /// Makes what the method's library sets up once a process and lifts the limit that it sets to the threads
  /// of everybody in it; called before anything is built.
  std::function<void(int threads)> warm_up = {};
};

}  // namespace treeline::bench::inside
