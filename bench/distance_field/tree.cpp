// No field at all: the nearest triangle and the side of every point, asked of the tree. What a field saves.
#include <cmath>

#include "accel/batch.hpp"
#include "accel/bvh/triangles.hpp"
#include "bench/core/registry.hpp"
#include "bench/distance_field/method.hpp"

namespace treeline::bench::distance_field {
namespace {

class TreeField final : public Field {
 public:
  explicit TreeField(const Input& input) : tree_(input.mesh) {}

  void distances(std::span<const geometry::Vec3f> points, const Knobs&, int threads,
                 std::span<float> out) const override {
    accel::parallel_ranges(points.size(), threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const float d = std::sqrt(tree_.closest_point(points[i]).distance2);
        out[i] = tree_.contains(points[i]) ? -d : d;
      }
    });
  }
  void trace(std::span<const geometry::Rayf> rays, const Knobs&, int threads,
             std::span<TraceAnswer> out) const override {
    accel::parallel_ranges(rays.size(), threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) out[i] = {.t = tree_.closest_hit(rays[i]).t};
    });
  }

 private:
  accel::Bvh<accel::Triangles<float>> tree_;
};

[[maybe_unused]] const bool registered = Registry<Method>::instance().add(
    {.info = {.name = "bvh", .family = "bvh", .claim = Claim::bounded, .ladder = 3},
     .build = [](const Input& input, const Knobs&) -> std::unique_ptr<Field> {
       return std::make_unique<TreeField>(input);
     }});

}  // namespace
}  // namespace treeline::bench::distance_field
