// What a method of this task gives it: shadows made for a scene (maps, volumes, fields, or nothing), that
// answer how much of the light each of a batch of receivers sees.
#pragma once

#include <memory>
#include <span>

#include "bench/core/task.hpp"
#include "shading/scene.hpp"
#include "shading/shadow/depth_map.hpp"

namespace treeline::bench::shadow {

using shading::shadow::Receiver;

/// What a build may look at. Scene and receivers stay where they are as long as the subject lives.
struct Input {
  const shading::Scene& scene;
  std::span<const Receiver>
      receivers;  ///< all that will be asked about, as fitted maps and cascades need them
  int threads = 1;
};

class ShadowSubject {
 public:
  virtual ~ShadowSubject() = default;
  /// Shares of the light in [0, 1], one a receiver. Receivers are some of the input's, in the order of
  /// pixels. Throws Unsupported where the method has no such query.
  virtual void visibility(std::span<const Receiver> receivers, const Knobs& query_knobs, int threads,
                          std::span<float> out) = 0;
  /// As fields of the row: shadow_…
  virtual Knobs facts() const { return Knobs::object(); }
};

/// Knobs of the same meaning have the same name in all methods: resolution (texels along a side of a map),
/// bias (in texels, as the slope-scaled rule has it), taps, radius (of a filter, in texels), rays (a
/// receiver), layers. Everything that does not depend on the receivers belongs to the build.
struct Method {
  MethodInfo info;
  std::unique_ptr<ShadowSubject> (*build)(const Input&, const Knobs& build_knobs) = nullptr;
};

}  // namespace treeline::bench::shadow
