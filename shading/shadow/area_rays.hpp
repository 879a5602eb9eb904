// Area shadows by rays: the share of a light's points that a receiver sees.
//
// Visibility here is an area fraction: every point of the light counts alike, whatever cosine or distance it
// is seen at. Points below the horizon of the receiver's surface are hidden, by that surface. Source: Cook,
// Porter and Carpenter 1984. Error, over edges of shadows that lie anywhere: 0.30 N^-3/4 for N Sobol-Owen
// points, unbiased (light_samples.hpp). Cost: N rays. Any tree of triangles will do; rays are cast in
// batches. Rays start off the surface (surface_offset.hpp) and end as far before the light. Known weakness:
// noise, N + 1 grey levels, and that thin things nearer than the offset cast nothing.
#pragma once

#include <bit>

#include "accel/batch.hpp"
#include "accel/concepts.hpp"
#include "shading/shadow/light_samples.hpp"
#include "shading/shadow/method.hpp"
#include "shading/shadow/surface_offset.hpp"

namespace treeline::shading::shadow {

struct AreaRayOptions {
  int samples = 16;  ///< a receiver; lights without extent take one
  SamplePattern pattern = SamplePattern::sobol_owen;
  std::uint64_t seed = 0;
  double offset = 0;  ///< rays start that far above the surface, in world units; 0: surface_offset()
};

/// All that is asked of a tree here; every accel::RayIndex has it.
template <class I>
concept OcclusionIndex = requires(const I& index, std::span<const typename I::Ray> rays,
                                  std::span<std::uint8_t> any, int threads) {
  typename I::Scalar;
  index.any_hit(rays, any, threads);
};

/// The name of a receiver in the sampling: the bits of where it is.
inline std::uint64_t pixel_of(const Receiver& r) {
  std::uint64_t h = 0;
  for (int k = 0; k < 3; ++k) h = geometry::mix_bits(h * 3 + std::bit_cast<std::uint64_t>(r.position[k]));
  return h;
}

template <OcclusionIndex Tree>
class AreaRays {
 public:
  using Scalar = typename Tree::Scalar;
  using Ray = typename Tree::Ray;

  /// The tree, over the scene's mesh, must outlive this. Throws InvalidScene as its parts do.
  AreaRays(const Tree& tree, const Scene& scene, const AreaRayOptions& options = {})
      : tree_(&tree),
        light_(scene.light),
        samples_(light_.extended() ? options.samples : 1, options.pattern, options.seed),
        offset_(options.offset > 0 ? options.offset : surface_offset<Scalar>(scene)) {}

  /// In [0, 1]: a multiple of 1 / samples. Batches give the same, bit for bit.
  float visibility(const Receiver& receiver) const {
    float r;
    visibility(std::span(&receiver, 1), std::span(&r, 1));
    return r;
  }
  /// `how` is passed on to the tree's any_hit: accel::RayBatch, where it takes one. Throws InvalidScene where
  /// there is not room for as many answers as receivers, accel::InvalidInput for threads < 1.
  template <class... How>
  void visibility(std::span<const Receiver> receivers, std::span<float> answers, int threads = 1,
                  How... how) const {
    detail::check_room(receivers.size(), answers.size());
    const auto each = static_cast<std::size_t>(samples_.count());
    accel::parallel_ranges(receivers.size(), threads, [&](std::size_t begin, std::size_t end) {
      const std::size_t at_once = std::max<std::size_t>(1, rays_at_once / each);
      Buffers buffers;
      buffers.points.resize(each);
      for (; begin < end; begin += at_once) {
        const std::size_t n = std::min(at_once, end - begin);
        cast(receivers.subspan(begin, n), answers.subspan(begin, n), buffers, how...);
      }
    });
  }

  std::size_t bytes() const { return tree_->bytes(); }
  /// Rays start that far above the surface; in world units.
  double offset() const { return offset_; }

 private:
  static constexpr std::size_t rays_at_once = 4096;

  struct Rays {
    std::vector<Ray> rays;
    std::vector<std::uint32_t> owners;
  };
  struct Buffers {
    std::vector<Vec2d> points;
    Rays by_octant[8];  // of their directions: those of one go together in packets
    std::vector<std::uint8_t> hidden;
  };

  template <class... How>
  void cast(std::span<const Receiver> receivers, std::span<float> answers, Buffers& b, How... how) const {
    for (Rays& r : b.by_octant) r.rays.clear(), r.owners.clear();
    for (std::size_t i = 0; i < receivers.size(); ++i) {
      answers[i] = 0;
      samples_(pixel_of(receivers[i]), b.points);
      for (const Vec2d& point : b.points) {
        const Vec3d way = light_.towards(receivers[i].position, point);
        if (!(dot(way, receivers[i].normal) > 0)) continue;
        Rays& to = b.by_octant[(way[0] < 0 ? 1 : 0) | (way[1] < 0 ? 2 : 0) | (way[2] < 0 ? 4 : 0)];
        to.rays.push_back(ray(receivers[i], way)), to.owners.push_back(static_cast<std::uint32_t>(i));
      }
    }
    for (const Rays& r : b.by_octant) {
      if (r.rays.empty()) continue;
      b.hidden.resize(r.rays.size());
      tree_->any_hit(std::span<const Ray>(r.rays), std::span<std::uint8_t>(b.hidden), 1, how...);
      for (std::size_t n = 0; n < r.rays.size(); ++n)
        if (!b.hidden[n]) ++answers[r.owners[n]];
    }
    for (float& a : answers) a /= static_cast<float>(samples_.count());
  }
  Ray ray(const Receiver& receiver, const Vec3d& way) const {
    const ShadowStart start = shadow_start(receiver, way, offset_);
    Ray r{geometry::Vec<Scalar, 3>(start.origin), geometry::Vec<Scalar, 3>(way),
          static_cast<Scalar>(start.t_min)};
    if (!light_.directional()) r.t_max = static_cast<Scalar>(std::max(0.0, 1 - offset_ / length(way)));
    return r;
  }

  const Tree* tree_;
  LightShape light_;
  SquareSamples samples_;
  double offset_;
};

}  // namespace treeline::shading::shadow
