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
#include "shading/transport/camera_rays.hpp"
#include "shading/transport/cast_ray.hpp"
#include "shading/transport/path_points.hpp"
#include "shading/transport/surfaces.hpp"

namespace treeline::shading::transport {

template <accel::RayIndex Index>
class Textbook {
 public:
  /// The index, over the scene's mesh, must outlive this. Throws as Surfaces and CameraRays do, and
  /// InvalidOptions.
  Textbook(const Index& index, const LitScene& scene, const TextbookOptions& options = {})
      : index_(&index),
        surfaces_(scene),
        options_(options),
        points_(Points::random, 1, options.seed),
        camera_(scene.camera),
        width_(scene.camera.width),
        height_(scene.camera.height) {
    if (!(options.survival > 0 && options.survival <= 1))
      throw InvalidOptions("survival is " + std::to_string(options.survival) + "; it must be in (0, 1]");
    if (options.max_bounces < 0)
      throw InvalidOptions("max_bounces is " + std::to_string(options.max_bounces) +
                           "; it must not be negative");
  }

  Film film() const { return Film(width_, height_); }

  /// As PathTracer's.
  RayCounts render(Film& film, int samples, int threads = 1) const {
    return render(film, samples, threads, camera_);
  }
  template <class Source>
  RayCounts render(Film& film, int samples, int threads, const Source& source) const {
    if (samples < 0)
      throw InvalidOptions("samples is " + std::to_string(samples) + "; it must not be negative");
    const std::uint64_t done = film.samples(0);
    std::atomic<std::uint64_t> rays = 0, shadow_rays = 0;
    each_block(film.size(), static_cast<std::uint64_t>(samples), 1024, threads, [&] {
      return [&](const Block& block) {
        RayCounts counts;
        for (std::size_t p = block.first_pixel; p < block.first_pixel + block.pixels; ++p)
          for (std::size_t s = 0; s < block.samples; ++s) {
            const PathKey key = points_.key(p, done + block.first_sample + s);
            const Pair at = points_.pair(key, 0);
            film.add(p, seen(source(p, at.u, at.v), key, counts));
          }
        rays += counts.rays, shadow_rays += counts.shadow_rays;
      };
    });
    return {film.size() * static_cast<std::uint64_t>(samples), rays, shadow_rays};
  }

 private:
  using Scalar = typename Index::Scalar;
  using Ray = typename Index::Ray;
  using Vec3f = geometry::Vec3f;
  using Vertex = Surfaces::Vertex;

  Rgb seen(const geometry::Rayf& ray, const PathKey& key, RayCounts& counts) const {
    const std::optional<Vertex> p = met(ray, counts);
    if (!p) return surfaces_.background();
    const Rgb light = shade(*p, 0, key, counts);
    return options_.emission_seen && p->cosine > 0 ? light + p->material->emission : light;
  }

  Rgb shade(const Vertex& p, int bounce, const PathKey& key, RayCounts& counts) const {
    if (bounce == options_.max_bounces) return {};
    const std::uint32_t place = 1 + 4 * static_cast<std::uint32_t>(bounce);
    const bool ends = points_.pair(key, place + 3).v >= options_.survival;
    if (options_.roulette_first && ends) return {};
    const Rgb direct = light_part(p, place, key, counts);
    if (ends) return direct;

    const Pair on_sphere = points_.pair(key, place + 2);
    const Vec3f in = geometry::sample_hemisphere(on_sphere.u, on_sphere.v);
    const float pi = std::numbers::pi_v<float>;
    const float pdf = options_.hemisphere_half_pi ? 2 / pi : 1 / (2 * pi);
    const std::optional<Vertex> q = met(surfaces_.leaving(p, in), counts);
    const Rgb weight = p.material->bsdf.eval(in, p.out) * (in[2] / pdf / options_.survival);
    if (!q) return direct + times(weight, surfaces_.background());
    if (options_.drop_reflected_emitters && q->material->emits) return direct;
    return direct + times(weight, shade(*q, bounce + 1, key, counts));
  }

  Rgb light_part(const Vertex& p, std::uint32_t place, const PathKey& key, RayCounts& counts) const {
    if (surfaces_.emitters().empty()) return {};
    const Pair on_face = points_.pair(key, place + 1);
    const Surfaces::LightPoint x = surfaces_.light(p, points_.number(key, place), on_face.u, on_face.v);
    if (x.pdf == 0) return {};
    ++counts.shadow_rays;
    if (index_->any_hit(cast_ray<Ray>(x.ray))) return {};
    return times(x.emission, p.material->bsdf.eval(x.in, p.out)) * (x.in[2] / x.pdf);
  }

  std::optional<Vertex> met(const geometry::Rayf& ray, RayCounts& counts) const {
    ++counts.rays;
    const accel::Hit<Scalar> hit = index_->closest_hit(cast_ray<Ray>(ray));
    if (!hit) return {};
    return surfaces_.meet(ray.origin, ray.direction, static_cast<float>(hit.t), hit.primitive);
  }

  const Index* index_;
  Surfaces surfaces_;
  TextbookOptions options_;
  PathPoints points_;
  CameraRays camera_;
  int width_, height_;
};

}  // namespace treeline::shading::transport
