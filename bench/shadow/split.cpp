#include "bench/shadow/split.hpp"

#include <cmath>

#include "bench/shadow/truth.hpp"
#include "geometry/random.hpp"
#include "geometry/sobol.hpp"
#include "shading/brdf/microfacet.hpp"

namespace treeline::bench::shadow {
namespace {

using Shares = std::array<double, split_roughness.size()>;

/// One estimate of the error of each roughness, at one receiver.
Shares estimate(const shading::Scene& scene, const Tree& tree, const Receiver& r, double offset, int samples,
                std::uint64_t stream) {
  const Vec3d eye = mirrored_light(scene.light, r);
  Shares seen{}, all{}, off{};
  int free = 0;
  for (int s = 0; s < samples; ++s) {
    const auto index = static_cast<std::uint32_t>(s);
    const ToLight to = to_light(scene.light, r.position, geometry::sobol_owen(index, 0, stream),
                                geometry::sobol_owen(index, 1, stream));
    const bool lit = !tree.any_hit(shadow_ray(r, to, offset));
    free += lit;
    for (std::size_t k = 0; k < off.size(); ++k) {
      const double weight = split_weight(scene.light, to, r.normal, eye, split_roughness[k]);
      all[k] += weight;
      if (lit) seen[k] += weight;
    }
  }
  for (std::size_t k = 0; k < off.size(); ++k)
    if (all[k] > 0) off[k] = seen[k] / all[k] - double(free) / samples;
  return off;
}

}  // namespace

Vec3d mirrored_light(const Light& light, const Receiver& r) {
  const Vec3d l = to_light(light, r.position).direction;
  return normalized(r.normal * (2 * dot(r.normal, l)) - l);
}

double split_weight(const Light& light, const ToLight& to, const Vec3d& normal, const Vec3d& eye,
                    double alpha) {
  double weight = std::max(0.0, dot(to.direction, normal));
  if (to.distance < far_away)
    weight *= std::max(0.0, -dot(to.direction, light.direction)) / (to.distance * to.distance);
  if (std::isinf(alpha) || weight == 0) return weight;
  const geometry::Frame<double> frame(normal);
  const auto local = [&](const Vec3d& d) { return Vec3d{dot(d, frame.x), dot(d, frame.y), dot(d, frame.z)}; };
  const shading::brdf::Microfacets<shading::brdf::Ggx<double>> surface{{alpha, alpha}};
  return weight * surface.eval(local(to.direction), local(eye));
}

std::array<double, split_roughness.size()> split_errors(const shading::Scene& scene, const Tree& tree,
                                                        std::span<const Receiver> receivers,
                                                        const Truth& truth, const SplitOptions& options,
                                                        int threads) {
  Shares rms{};
  std::vector<std::size_t> between;
  for (std::size_t i = 0; i < receivers.size(); ++i)
    if (truth.visibility[i] > 0 && truth.visibility[i] < 1) between.push_back(i);
  if (is_hard(scene.light) || between.empty()) return rms;
  const std::size_t count = std::min(options.most, between.size());
  const double offset = ray_offset(scene);
  std::vector<Shares> squares(count);
  accel::parallel_ranges(count, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t j = begin; j < end; ++j) {
      const std::size_t i = between[j * between.size() / count];
      const auto of_half = [&](std::uint64_t half) {
        return estimate(scene, tree, receivers[i], offset, options.samples, geometry::hash_u64(half, i));
      };
      const Shares a = of_half(0), b = of_half(1);
      for (std::size_t k = 0; k < rms.size(); ++k) squares[j][k] = a[k] * b[k];
    }
  });
  for (std::size_t k = 0; k < rms.size(); ++k) {
    double sum = 0;
    for (const Shares& s : squares) sum += s[k];
    const double share = double(between.size()) / double(receivers.size());
    rms[k] = std::sqrt(std::max(0.0, sum / double(count)) * share);
  }
  return rms;
}

}  // namespace treeline::bench::shadow
