// The path tracer of a well-known course, word for word, beside which the corrected one is shown.
//
// shade(p, wo) of that pseudo-code: draw a point of the light evenly by area, add its light if nothing is in
// the way; then Russian roulette with probability P; draw a direction evenly over the hemisphere; "if the ray
// hits a non-emitting object at q", add shade(q, -wi) · f · cos / pdf / P. What is known of it:
// - Light that emitters reflect is lost: a path that meets one ends. In a furnace of albedo ½ it sees ¼.
// - What the camera sees emits nothing: lamps are black.
// - Where roulette is written before the light's part ("if ξ > P return 0") and that part is not divided by
//   P, the whole image is P times the truth.
// - Given the hemisphere's solid angle as π / 2, which is found in print, indirect light is a quarter of what
//   it should be.
// Each of these can be chosen or mended by itself. Surfaces are diffuse or rough, as eval() of their Bsdf
// says; mirrors and glass reflect nothing, for what the pseudo-code draws never meets their direction.
// Cost: a recursion of single rays. Source: Yan, GAMES101, lecture 16 (2020).
#pragma once

#include <atomic>
#include <optional>

#include "geometry/sampling.hpp"
#include "shading/transport/blocks.hpp"
#include "shading/transport/cast_ray.hpp"
#include "shading/transport/stage.hpp"

namespace treeline::shading::transport {

template <accel::RayIndex Index>
class Textbook {
 public:
  /// The index, over the scene's mesh, must outlive this. Throws as Surfaces and CameraRays do, and
  /// InvalidOptions.
  Textbook(const Index& index, const LitScene& scene, const TextbookOptions& options = {})
      : options_((check_options(options), options)), stage_(index, scene, Points::random, 1, options.seed) {}

  Film film() const { return stage_.film(); }

  /// As PathTracer's.
  RayCounts render(Film& film, int samples, int threads = 1) const {
    stage_.check_size(film);
    return render(film, samples, threads, stage_.camera());
  }
  template <class Source>
  RayCounts render(Film& film, int samples, int threads, const Source& source) const {
    const std::uint64_t more = stage_.checked_samples(film, samples), done = film.samples(0);
    std::atomic<std::uint64_t> rays = 0, shadow_rays = 0;
    each_block(film.size(), more, 1024, threads, [&] {
      return [&](const Block& block) {
        RayCounts counts;
        for (std::size_t p = block.first_pixel; p < block.first_pixel + block.pixels; ++p)
          for (std::size_t s = 0; s < block.samples; ++s) {
            const PathKey key = stage_.points().key(p, done + block.first_sample + s);
            const Pair at = stage_.points().pair(key, 0);
            film.add(p, seen(source(p, at.u, at.v), key, counts));
          }
        rays += counts.rays, shadow_rays += counts.shadow_rays;
      };
    });
    return {film.size() * more, rays, shadow_rays};
  }

 private:
  using Scalar = typename Index::Scalar;
  using Ray = typename Index::Ray;
  using Vec3f = geometry::Vec3f;
  using Vertex = Surfaces::Vertex;

  Rgb seen(const geometry::Rayf& ray, const PathKey& key, RayCounts& counts) const {
    const std::optional<Vertex> p = met(ray, counts);
    if (!p) return stage_.surfaces().background();
    const Rgb light = shade(*p, 0, key, counts);
    return options_.emission_seen && p->cosine > 0 ? light + p->material->emission : light;
  }

  Rgb shade(const Vertex& p, int bounce, const PathKey& key, RayCounts& counts) const {
    if (bounce == options_.max_bounces) return {};
    const std::uint32_t place = 1 + 4 * static_cast<std::uint32_t>(bounce);
    const bool ends = stage_.points().pair(key, place + 3).v >= options_.survival;
    if (options_.roulette_first && ends) return {};
    const Rgb direct = light_part(p, place, key, counts);
    if (ends) return direct;

    const Pair on_sphere = stage_.points().pair(key, place + 2);
    const Vec3f in = geometry::sample_hemisphere(on_sphere.u, on_sphere.v);
    const float pi = std::numbers::pi_v<float>;
    const float pdf = options_.hemisphere_half_pi ? 2 / pi : 1 / (2 * pi);
    const std::optional<Vertex> q = met(stage_.surfaces().leaving(p, in), counts);
    const Rgb weight = p.material->bsdf.eval(in, p.out) * (in[2] / pdf / options_.survival);
    if (!q) return direct + times(weight, stage_.surfaces().background());
    if (options_.drop_reflected_emitters && q->material->emits) return direct;
    return direct + times(weight, shade(*q, bounce + 1, key, counts));
  }

  Rgb light_part(const Vertex& p, std::uint32_t place, const PathKey& key, RayCounts& counts) const {
    if (stage_.surfaces().emitters().empty()) return {};
    const Pair on_face = stage_.points().pair(key, place + 1);
    const Surfaces::LightPoint x =
        stage_.surfaces().light(p, stage_.points().number(key, place), on_face.u, on_face.v);
    if (x.pdf == 0) return {};
    ++counts.shadow_rays;
    if (stage_.index().any_hit(cast_ray<Ray>(x.ray))) return {};
    return times(x.emission, p.material->bsdf.eval(x.in, p.out)) * (x.in[2] / x.pdf);
  }

  std::optional<Vertex> met(const geometry::Rayf& ray, RayCounts& counts) const {
    ++counts.rays;
    const accel::Hit<Scalar> hit = stage_.index().closest_hit(cast_ray<Ray>(ray));
    if (!hit) return {};
    return stage_.surfaces().meet(ray.origin, ray.direction, static_cast<float>(hit.t), hit.primitive);
  }

  TextbookOptions options_;
  Stage<Index> stage_;
};

}  // namespace treeline::shading::transport
