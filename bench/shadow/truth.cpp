#include "bench/shadow/truth.hpp"

#include <bit>
#include <cmath>
#include <stdexcept>

#include "geometry/random.hpp"
#include "geometry/sobol.hpp"
#include "shading/shadow/surface_offset.hpp"

namespace treeline::bench::shadow {
namespace {

using geometry::Vec3f;

/// Of the scene's diagonal: rays start that far above the surface. Ten times what float leaves of a place in
/// the scene.
constexpr double offset_share = 1e-5;
constexpr double end_share = 1e-4;  // of the way to the light: what carries it casts no shadow
constexpr int version = 2;          // of how rays are traced: truths of others are not taken from a cache

/// Samples of both halves that saw the light, of one receiver.
struct Seen {
  int half[2] = {0, 0};
  int samples = 0;  // a half

  double mean(int h) const { return double(half[h]) / samples; }
  bool settled() const {
    return (half[0] == 0 && half[1] == 0) || (half[0] == samples && half[1] == samples);
  }
};

/// Receivers beside each other: those of neighbouring pixels, or of a line.
class Neighbours {
 public:
  Neighbours(std::size_t n, std::span<const std::uint32_t> pixel, int width) : pixel_(pixel), width_(width) {
    if (width == 0) return;
    if (pixel.size() != n) throw std::invalid_argument("pixels and receivers are not as many");
    for (std::size_t i = 0; i < n; ++i) {
      if (pixel[i] >= at_.size()) at_.resize(pixel[i] + 1, none);
      at_[pixel[i]] = static_cast<std::uint32_t>(i);
    }
  }
  template <class F>
  bool any(std::size_t i, std::size_t n, F&& f) const {
    if (width_ == 0) return (i > 0 && f(i - 1)) || (i + 1 < n && f(i + 1));
    const int x = static_cast<int>(pixel_[i]) % width_, y = static_cast<int>(pixel_[i]) / width_;
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx) {
        const int u = x + dx, v = y + dy;
        if (u < 0 || u >= width_ || v < 0) continue;
        const std::size_t p = std::size_t(v) * std::size_t(width_) + std::size_t(u);
        if (p < at_.size() && at_[p] != none && f(at_[p])) return true;
      }
    return false;
  }

 private:
  static constexpr std::uint32_t none = 0xffffffffu;
  std::span<const std::uint32_t> pixel_;
  int width_;
  std::vector<std::uint32_t> at_;
};

class Tracer {
 public:
  Tracer(const shading::Scene& scene, const Tree& tree, std::span<const Receiver> receivers,
         std::uint64_t seed)
      : scene_(scene), tree_(tree), receivers_(receivers), seed_(seed), offset_(ray_offset(scene)) {}

  /// Samples [from, to) of both halves of one receiver.
  void add(std::size_t i, int from, int to, Seen& seen) const {
    const Receiver& r = receivers_[i];
    std::vector<geometry::Rayf> rays;
    for (int h = 0; h < 2; ++h)
      for (int s = from; s < to; ++s) rays.push_back(ray(r, h, i, s));
    std::vector<std::uint8_t> hit(rays.size());
    tree_.any_hit(std::span<const geometry::Rayf>(rays), hit, 1, accel::RayBatch::packets);
    for (std::size_t k = 0; k < hit.size(); ++k) seen.half[k >= hit.size() / 2] += hit[k] ? 0 : 1;
    seen.samples = to;
  }
  bool lit(const Receiver& r) const {
    return !tree_.any_hit(shadow_ray(r, to_light(scene_.light, r.position), offset_));
  }

 private:
  geometry::Rayf ray(const Receiver& r, int half, std::size_t i, int s) const {
    const std::uint64_t stream = geometry::hash_u64(seed_ + std::uint64_t(half), i);
    const auto index = static_cast<std::uint32_t>(s);
    return shadow_ray(r,
                      to_light(scene_.light, r.position, geometry::sobol_owen(index, 0, stream),
                               geometry::sobol_owen(index, 1, stream)),
                      offset_);
  }

  const shading::Scene& scene_;
  const Tree& tree_;
  std::span<const Receiver> receivers_;
  std::uint64_t seed_;
  double offset_;
};

}  // namespace

double ray_offset(const shading::Scene& scene) {
  return offset_share * length(geometry::Vec3d(scene.mesh.box().extent()));
}

geometry::Rayf shadow_ray(const Receiver& r, const ToLight& to, double offset) {
  const auto start = shading::shadow::shadow_start(r, to.direction, offset);
  geometry::Rayf ray{Vec3f(start.origin), Vec3f(to.direction), static_cast<float>(start.t_min)};
  if (to.distance < far_away) ray.t_max = static_cast<float>(to.distance * (1 - end_share));
  return ray;
}

Truth traced_truth(const shading::Scene& scene, const Tree& tree, std::span<const Receiver> receivers,
                   std::span<const std::uint32_t> pixel, int width, const TruthOptions& options,
                   int threads) {
  const std::size_t n = receivers.size();
  const Tracer tracer(scene, tree, receivers, options.seed);
  Truth truth;
  truth.visibility.resize(n);
  if (is_hard(scene.light)) {
    accel::parallel_ranges(n, threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) truth.visibility[i] = tracer.lit(receivers[i]) ? 1 : 0;
    });
    truth.samples = 1;
    return truth;
  }
  const Neighbours neighbours(n, pixel, width);
  std::vector<Seen> seen(n);
  std::vector<std::uint8_t> open(n, 1);
  for (int from = 0, to = options.first;;) {
    accel::parallel_ranges(n, threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        if (open[i]) tracer.add(i, from, to, seen[i]);
    });
    double sum = 0;
    for (const Seen& s : seen) sum += (s.mean(0) - s.mean(1)) * (s.mean(0) - s.mean(1));
    truth.halves = std::sqrt(sum / double(std::max<std::size_t>(n, 1)));
    // Once: what is alike all around it stays as it is.
    if (from == 0)
      for (std::size_t i = 0; i < n; ++i)
        open[i] = !seen[i].settled() || neighbours.any(i, n, [&](std::size_t k) {
          return seen[k].half[0] != seen[i].half[0] || !seen[k].settled();
        });
    from = to, to *= 2;
    if (truth.halves < options.wanted && from > options.first) break;
    if (to > options.most) break;
  }
  for (std::size_t i = 0; i < n; ++i)
    truth.visibility[i] = 0.5 * (seen[i].mean(0) + seen[i].mean(1)),
    truth.samples += 2.0 * seen[i].samples / double(n);
  return truth;
}

std::uint64_t truth_hash(const shading::Scene& scene, std::span<const Receiver> receivers,
                         const TruthOptions& options) {
  std::uint64_t h = geometry::hash_u64(version, receivers.size());
  const auto add = [&](double x) { h = geometry::hash_u64(h, std::bit_cast<std::uint64_t>(x)); };
  const auto add_all = [&](const geometry::Vec3d& p) {
    for (int k = 0; k < 3; ++k) add(p[k]);
  };
  const shading::Light& light = scene.light;
  add(static_cast<double>(light.kind)), add(light.angle), add(options.first), add(options.most),
      add(options.wanted);
  add(static_cast<double>(options.seed));
  for (const auto& v : {light.position, light.direction, light.u, light.v}) add_all(v);
  for (const Receiver& r : receivers) add_all(r.position), add_all(r.normal);
  return h;
}

}  // namespace treeline::bench::shadow
