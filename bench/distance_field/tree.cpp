// No field at all: the nearest triangle and the side of every point, asked of the tree. What a field saves.
#include <cmath>

#include "bench/distance_field/sampled.hpp"

namespace treeline::bench::distance_field {
namespace {

/// Sides by how often the mesh goes around a point, as those of the sampled fields are: exact on closed
/// meshes. Distances in float, whose rounding the judge allows everybody.
class TreeField final : public Field {
 public:
  explicit TreeField(const Input& input)
      : mesh_(input.mesh), tree_(tree_of(input)), sign_(mesh_, tree_, input.threads) {}

  void distances(std::span<const geometry::Vec3f> points, const Knobs&, int threads,
                 std::span<float> out) const override {
    accel::parallel_ranges(points.size(), threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        // In double: squares of float leave its range where a mesh is large.
        const geometry::Triangle3d nearest(mesh_.triangle(tree_.closest_point(points[i]).primitive));
        const auto d = static_cast<float>(
            std::sqrt(closest_point_on_triangle(geometry::Vec3d(points[i]), nearest).distance2));
        out[i] = sign_.inside(points[i]) ? -d : d;
      }
    });
  }
  void trace(std::span<const geometry::Rayf> rays, const Knobs&, int threads,
             std::span<TraceAnswer> out) const override {
    accel::parallel_ranges(rays.size(), threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) out[i] = {.t = tree_.closest_hit(rays[i]).t};
    });
  }
  std::optional<accel::field::FieldSample> certain(const geometry::Vec3d& p, const Knobs&) const override {
    if (!sign_.closed()) return std::nullopt;
    float d = 0;
    const geometry::Vec3f at(p);
    distances({&at, 1}, Knobs::object(), 1, {&d, 1});
    return accel::field::FieldSample{double(d), geometry::distance(p, geometry::Vec3d(at)), true};
  }

 private:
  geometry::Mesh3f mesh_;
  Tree tree_;
  accel::field::MeshSign<Tree> sign_;
};

[[maybe_unused]] const bool registered = Registry<Method>::instance().add(
    {.info = {.name = "bvh", .family = "bvh", .claim = Claim::bounded, .ladder = 3},
     .build = [](const Input& input, const Knobs&) -> std::unique_ptr<Field> {
       return std::make_unique<TreeField>(input);
     }});

}  // namespace
}  // namespace treeline::bench::distance_field
