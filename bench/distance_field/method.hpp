// What a method of this task gives it: a field made from a mesh, that answers whole batches of points and
// rays.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "accel/field/concepts.hpp"
#include "bench/core/task.hpp"
#include "geometry/mesh.hpp"
#include "geometry/ray.hpp"

namespace treeline::bench::distance_field {

/// What a ray found. A miss has an infinite t.
struct TraceAnswer {
  float t = std::numeric_limits<float>::infinity();
  std::uint32_t steps = 0;  ///< 0 where the method does not count them
  bool exhausted = false;   ///< gave up: neither hit nor miss
  bool doubtful = false;    ///< says that it may have passed a surface
};

/// A field's own rays end where it says the surface is this near, in cells.
inline constexpr double hit_tolerance = 1e-3;

/// A place where the field keeps a distance of its own, and that distance.
struct Sample {
  geometry::Vec3d at;
  double distance;
};

class Field {
 public:
  virtual ~Field() = default;
  /// Signed distances, negative inside; beyond the band whatever the method has.
  virtual void distances(std::span<const geometry::Vec3f> points, const Knobs& query_knobs, int threads,
                         std::span<float> out) const = 0;
  /// Directions of rays are of unit length. Throws Unsupported where the method casts no rays.
  virtual void trace(std::span<const geometry::Rayf>, const Knobs&, int /*threads*/,
                     std::span<TraceAnswer>) const {
    throw Unsupported("casts no rays");
  }
  /// What the field says for certain, if it says anything.
  virtual std::optional<accel::field::FieldSample> certain(const geometry::Vec3d&, const Knobs&) const {
    return std::nullopt;
  }
  /// Some of the samples in the band, evenly spread: at most so many.
  virtual std::vector<Sample> samples(std::size_t /*most*/) const { return {}; }
  /// As fields of the row: distance_field_…
  virtual Knobs facts() const { return Knobs::object(); }
};

struct Input {
  const geometry::Mesh3f& mesh;
  double spacing = 0;  ///< side of a cell
  double band = 3;     ///< half width of the band, in cells
  int threads = 1;
};

/// `build_knobs` have a resolution: cells along the longest side of the mesh's box; 0 where the method keeps
/// no grid.
struct Method {
  MethodInfo info;
  std::unique_ptr<Field> (*build)(const Input&, const Knobs& build_knobs) = nullptr;
};

/// The resolutions of the sweep, the most telling first: where time is short the last is left out. Hard cases
/// are met at 32: what they show does not hang on the resolution, and 64 takes several times as long.
inline std::vector<Knobs> resolutions() {
  std::vector<Knobs> r;
  for (const int n : {128, 64, 32, 256}) r.push_back({{"resolution", n}});
  return r;
}

/// Every so many-th of n, so that at most `most` are taken.
inline std::size_t stride_for(std::size_t n, std::size_t most) {
  return n / std::max<std::size_t>(most, 1) + 1;
}

}  // namespace treeline::bench::distance_field
