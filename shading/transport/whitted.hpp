// Whitted's ray tracing: mirrors and glass are followed, everything else is lit directly and ends the ray.
//
// Source: Whitted 1980. At glass a ray becomes two, reflected and refracted, each with Fresnel's share, so
// that n rays of the camera become at most 2^k n at bounce k, and (2^(k+1) - 1) n in all; to these comes a
// number of shadow rays at each end, which were one to a point light and here go to points of the emitters,
// spread over them and drawn by area, so that shadows are soft. Rays of one bounce are traced together. Cost:
// the rays; they are counted by bounce and kind. Known weakness: light that diffuse surfaces pass on to each
// other is left out, or guessed by one constant (`ambient`); so is all light of the sky on them. Glass casts
// the shadow of an opaque body.
#pragma once

#include <mutex>
#include <vector>

#include "geometry/sampling.hpp"
#include "shading/transport/blocks.hpp"
#include "shading/transport/cast_ray.hpp"
#include "shading/transport/stage.hpp"

namespace treeline::shading::transport {

template <accel::RayIndex Index>
class Whitted {
 public:
  /// The index, over the scene's mesh, must outlive this. Throws as Surfaces and CameraRays do, and
  /// InvalidOptions for negative numbers, more than 20 bounces and more than 1024 shadow rays.
  Whitted(const Index& index, const LitScene& scene, const WhittedOptions& options = {})
      : options_((check_options(options), options)), stage_(index, scene, Points::random, 1, options.seed) {}

  Film film() const { return stage_.film(); }

  /// As PathTracer's.
  WhittedCounts render(Film& film, int samples, int threads = 1) const {
    stage_.check_size(film);
    return render(film, samples, threads, stage_.camera());
  }
  template <class Source>
  WhittedCounts render(Film& film, int samples, int threads, const Source& source) const {
    const std::uint64_t more = stage_.checked_samples(film, samples), done = film.samples(0);
    WhittedCounts counts{film.size() * more,
                         std::vector<BounceCounts>(static_cast<std::size_t>(options_.max_bounces) + 1)};
    std::mutex counting;
    each_block(film.size(), more, wave_size, threads, [&] {
      return [&, wave = Wave{}](const Block& block) mutable {
        begin(wave, block, done, source);
        for (std::size_t bounce = 0; !wave.rays.empty(); ++bounce) {
          const BounceCounts c = advance(wave, bounce);
          const std::lock_guard lock(counting);
          BounceCounts& sum = counts.bounces[bounce];
          sum.reflected += c.reflected, sum.refracted += c.refracted, sum.shadow += c.shadow;
        }
        for (std::size_t p = 0, i = 0; p < block.pixels; ++p)
          for (std::size_t s = 0; s < block.samples; ++s) film.add(block.first_pixel + p, wave.radiance[i++]);
      };
    });
    return counts;
  }

 private:
  using Scalar = typename Index::Scalar;
  using Ray = typename Index::Ray;
  using Vec3f = geometry::Vec3f;
  using Vertex = Surfaces::Vertex;
  static constexpr std::size_t wave_size = 1024;

  struct Branch {
    Rgb weight;
    PathKey key;
    std::uint32_t slot;
  };
  struct Wave {
    std::vector<Ray> rays, next_rays, shadow_rays;
    std::vector<Branch> branches, next, shadows;  // of a shadow: weight is the light that it may bring
    std::vector<accel::Hit<Scalar>> hits;
    std::vector<std::uint8_t> hidden;
    std::vector<Rgb> radiance;
  };
  template <class Source>
  void begin(Wave& wave, const Block& block, std::uint64_t done, const Source& source) const {
    wave.rays.clear(), wave.branches.clear();
    wave.radiance.assign(block.paths(), Rgb{});
    for (std::size_t p = block.first_pixel; p < block.first_pixel + block.pixels; ++p)
      for (std::size_t s = 0; s < block.samples; ++s) {
        const PathKey key = stage_.points().key(p, done + block.first_sample + s);
        const Pair at = stage_.points().pair(key, 0);
        wave.branches.push_back({Rgb::filled(1), key, static_cast<std::uint32_t>(wave.rays.size())});
        wave.rays.push_back(cast_ray<Ray>(source(p, at.u, at.v)));
      }
  }

  BounceCounts advance(Wave& wave, std::size_t bounce) const {
    wave.hits.resize(wave.rays.size());
    stage_.index().closest_hit(std::span<const Ray>(wave.rays), std::span(wave.hits), 1);
    BounceCounts counts;
    wave.next_rays.clear(), wave.next.clear(), wave.shadow_rays.clear(), wave.shadows.clear();
    for (std::size_t i = 0; i < wave.rays.size(); ++i) {
      const Branch& branch = wave.branches[i];
      Rgb& radiance = wave.radiance[branch.slot];
      if (!wave.hits[i]) {
        radiance += times(branch.weight, stage_.surfaces().background());
        continue;
      }
      const Vec3f origin(wave.rays[i].origin), direction(wave.rays[i].direction);
      const Vertex at = stage_.surfaces().meet(origin, direction, static_cast<float>(wave.hits[i].t),
                                               wave.hits[i].primitive);
      const Surfaces::Material& material = *at.material;
      if (at.cosine > 0) radiance += times(branch.weight, material.emission);
      if (!material.bsdf.delta()) {
        if (material.kind == SurfaceKind::diffuse)
          radiance += times(branch.weight, times(material.albedo, options_.ambient));
        draw_lights(wave, branch, at);
      } else if (bounce < static_cast<std::size_t>(options_.max_bounces)) {
        follow(wave, branch, at, counts);
      }
    }
    counts.shadow = wave.shadow_rays.size();
    see_lights(wave);
    std::swap(wave.rays, wave.next_rays), std::swap(wave.branches, wave.next);
    return counts;
  }

  void follow(Wave& wave, const Branch& branch, const Vertex& at, BounceCounts& counts) const {
    const auto add = [&](const Vec3f& in, const Rgb& weight, std::uint64_t which) {
      if (!(largest(weight) > 0)) return false;
      wave.next_rays.push_back(cast_ray<Ray>(stage_.surfaces().leaving(at, in)));
      wave.next.push_back(
          {times(branch.weight, weight), {geometry::hash_u64(branch.key.hash, which), 0}, branch.slot});
      return true;
    };
    if (at.material->kind == SurfaceKind::mirror) {
      counts.reflected += add(brdf::mirrored(at.out), at.material->albedo, 0);
      return;
    }
    const float eta = at.out[2] >= 0 ? at.material->index : 1 / at.material->index;
    const float share = brdf::fresnel_dielectric(std::min(1.0f, std::abs(at.out[2])), eta);
    counts.reflected += add(brdf::mirrored(at.out), Rgb::filled(share), 0);
    if (share >= 1) return;
    // Of the two that the sampler may choose, the one past the reflected share.
    const brdf::GlassSample<float> s = brdf::sample_glass(at.out, at.material->index, 1.0f);
    counts.refracted += add(s.wi, Rgb::filled(s.weight * (1 - share)), 1);
  }

  void draw_lights(Wave& wave, const Branch& branch, const Vertex& at) const {
    const int n = stage_.surfaces().emitters().empty() ? 0 : options_.shadow_rays;
    for (int i = 0; i < n; ++i) {
      const auto place = 1 + 2 * static_cast<std::uint32_t>(i);
      const Pair on_face = stage_.points().pair(branch.key, place + 1);
      const double choice = (i + stage_.points().number(branch.key, place)) / n;
      const Surfaces::LightPoint to = stage_.surfaces().light(at, choice, on_face.u, on_face.v);
      if (to.pdf == 0) continue;
      const Rgb reflected =
          at.material->bsdf.eval(to.in, at.out) * (to.in[2] / to.pdf / static_cast<float>(n));
      wave.shadow_rays.push_back(cast_ray<Ray>(to.ray));
      wave.shadows.push_back({times(times(branch.weight, reflected), to.emission), branch.key, branch.slot});
    }
  }

  void see_lights(Wave& wave) const {
    wave.hidden.resize(wave.shadow_rays.size());
    stage_.index().any_hit(std::span<const Ray>(wave.shadow_rays), std::span(wave.hidden), 1);
    for (std::size_t i = 0; i < wave.shadows.size(); ++i)
      if (!wave.hidden[i]) wave.radiance[wave.shadows[i].slot] += wave.shadows[i].weight;
  }

  WhittedOptions options_;
  Stage<Index> stage_;
};

}  // namespace treeline::shading::transport
