// Monte Carlo path tracing: the light that reaches a camera, or any other rays, without bias.
//
// Problem: Kajiya's rendering equation (1986). Method: paths from the camera; at each surface a point of the
// emitters is drawn and seen or hidden (next event), a direction is drawn, what it meets emits, and both
// weights add up to one (multiple importance sampling, Veach and Guibas 1995); paths end by Russian roulette
// (Arvo and Kirk 1990), after the light that was drawn has been added, and all that comes later is divided by
// the probability. Every choice of options has the same mean. Paths advance in waves, all by one surface
// before any of them by the next (van Antwerpen 2011), so that a tree gets rays by the thousand. Cost: two
// rays a surface, and 150 bytes a path in a wave. Known weakness: light that reaches a surface through glass
// or a mirror only (caustics) of a small emitter is met by chance alone.
#pragma once

#include <atomic>
#include <bit>
#include <span>
#include <utility>

#include "geometry/sampling.hpp"
#include "shading/transport/blocks.hpp"
#include "shading/transport/camera_hits.hpp"
#include "shading/transport/cast_ray.hpp"
#include "shading/transport/cosine_directions.hpp"
#include "shading/transport/diffuse_tile.hpp"
#include "shading/transport/stage.hpp"

namespace treeline::shading::transport {

template <accel::RayIndex Index>
class PathTracer {
 public:
  /// The index, over the scene's mesh, must outlive this. Throws as Surfaces and CameraRays do, and
  /// InvalidOptions.
  PathTracer(const Index& index, const LitScene& scene, const PathOptions& options = {})
      : options_((check_options(options), options)),
        stage_(index, scene, options.points, options.set, options.seed) {}

  /// Without samples, for render(): of the camera's size, or of another.
  Film film() const { return stage_.film(); }
  Film film(int width, int height) const { return stage_.film(width, height); }

  /// Adds so many samples to every pixel of a film of the camera's size. The film is the same, bit by bit,
  /// for any number of threads and however the samples are shared between calls. Throws InvalidOptions for a
  /// film of another size or of other sets, and samples < 0.
  RayCounts render(Film& film, int samples, int threads = 1) const {
    stage_.check_size(film);
    return render(film, samples, threads, stage_.camera());
  }
  /// Along other rays: source(pixel, u, v), for u and v in [0, 1), gives a ray of unit direction, and is
  /// called by many threads at once. Pixels of any film must have the same number of samples.
  template <class Source>
  RayCounts render(Film& film, int samples, int threads, const Source& source) const {
    const std::uint64_t more = stage_.checked_samples(film, samples), done = film.samples(0);
    std::atomic<std::uint64_t> rays = 0, shadow_rays = 0;
    each_block(film.size(), more, wave_size, threads, [&] {
      return [&, wave = Wave(wave_size)](const Block& block) mutable {
        begin(wave, block, done, source);
        trace(wave);
        for (std::size_t p = 0, i = 0; p < block.pixels; ++p)
          for (std::size_t s = 0; s < block.samples; ++s) film.add(block.first_pixel + p, wave.radiance[i++]);
        rays += wave.rays_cast, shadow_rays += wave.shadow_rays_cast;
      };
    });
    return {film.size() * more, rays, shadow_rays};
  }

  const PathOptions& options() const { return options_; }

 private:
  using Scalar = typename Index::Scalar;
  using Ray = typename Index::Ray;
  using Vec3f = geometry::Vec3f;
  using Vertex = Surfaces::Vertex;

  static constexpr std::size_t wave_size = 4096;
  static constexpr float infinity = std::numeric_limits<float>::infinity();
  static constexpr float pi = std::numbers::pi_v<float>;

  struct Path {
    Rgb throughput;
    float pdf;  // of the ray's direction, per steradian; infinite where no emitter's point was drawn for it
    std::uint32_t slot;  // of its radiance
  };
  struct Shadow {
    Rgb light;  // if it is not hidden
    std::uint32_t slot;
  };
  /// Paths at other surfaces, one by one; but what decides is found for all.
  struct OtherTile {
    Ray ray[tile_size];
    accel::Hit<Scalar> hit[tile_size];
    Path path[tile_size];
    std::uint64_t hash[tile_size] = {};
    std::uint32_t index[tile_size] = {};
    std::size_t size = 0;
  };
  struct Wave {
    explicit Wave(std::size_t n)
        : rays(n),
          hits(n),
          paths(n),
          hash(n + tile_size),
          index(n + tile_size),
          radiance(n),
          shadow_rays(n),
          shadows(n),
          hidden(n) {}

    std::size_t size = 0, shadow_size = 0;  // of those under way
    std::vector<Ray> rays;
    std::vector<accel::Hit<Scalar>> hits;
    std::vector<Path> paths;
    std::vector<std::uint64_t> hash;  // of their keys
    std::vector<std::uint32_t> index;
    std::vector<Rgb> radiance;
    std::vector<Ray> shadow_rays;
    std::vector<Shadow> shadows;
    std::vector<std::uint8_t> hidden;
    std::uint64_t rays_cast = 0, shadow_rays_cast = 0;  // for this block
    DiffuseTile diffuse;
    OtherTile other;
    TileDecisions decisions;
  };

  template <class Source>
  void begin(Wave& wave, const Block& block, std::uint64_t done, const Source& source) const {
    const std::size_t n = wave.size = block.paths();
    wave.rays_cast = wave.shadow_rays_cast = 0;
    for (std::size_t p = 0, i = 0; p < block.pixels; ++p)
      for (std::size_t s = 0; s < block.samples; ++s, ++i) {
        const PathKey key = stage_.points().key(block.first_pixel + p, done + block.first_sample + s);
        wave.hash[i] = key.hash, wave.index[i] = key.index;
        wave.paths[i] = {Rgb::filled(1), infinity, static_cast<std::uint32_t>(i)};
        wave.radiance[i] = {};
      }
    TileDecisions& d = wave.decisions;
    for (std::size_t p = 0, s = 0, i = 0; i < n; ++i) {
      const std::size_t lane = i % tile_size;
      if (lane == 0) stage_.points().pairs(tile_size, &wave.hash[i], &wave.index[i], 0, d.u, d.v);
      wave.rays[i] = cast_ray<Ray>(source(block.first_pixel + p, d.u[lane], d.v[lane]));
      if (++s == block.samples) ++p, s = 0;
    }
  }

  void trace(Wave& wave) const {
    for (int bounce = 0; wave.size > 0; ++bounce) {
      const std::span<const Ray> rays(wave.rays.data(), wave.size);
      const std::span<accel::Hit<Scalar>> hits(wave.hits.data(), wave.size);
      if (bounce == 0)
        camera_hits(stage_.index(), rays, hits);
      else
        face_hits(stage_.index(), rays, hits);
      wave.rays_cast += wave.size;
      advance(wave, bounce);
      stage_.index().any_hit(std::span<const Ray>(wave.shadow_rays.data(), wave.shadow_size),
                             std::span(wave.hidden.data(), wave.shadow_size), 1);
      wave.shadow_rays_cast += wave.shadow_size;
      for (std::size_t i = 0; i < wave.shadow_size; ++i) {
        const Shadow& s = wave.shadows[i];
        const std::uint32_t seen = wave.hidden[i] - 1u;  // all bits or none: nobody can foresee which
        for (int k = 0; k < 3; ++k)
          wave.radiance[s.slot][k] += std::bit_cast<float>(std::bit_cast<std::uint32_t>(s.light[k]) & seen);
      }
    }
  }

  bool draws_lights() const {
    return options_.lights != Lights::none && !stage_.surfaces().emitters().empty();
  }

  void decide(const std::uint64_t* hash, const std::uint32_t* index, int bounce, TileDecisions& d) const {
    const std::uint32_t place = 1 + 4 * static_cast<std::uint32_t>(bounce);
    if (draws_lights()) {
      stage_.points().numbers(tile_size, hash, index, place, d.emitter);
      stage_.points().pairs(tile_size, hash, index, place + 1, d.light_u, d.light_v);
    }
    stage_.points().pairs(tile_size, hash, index, place + 2, d.u, d.v);
    stage_.points().pairs(tile_size, hash, index, place + 3, d.choice, d.roulette);
    if (options_.directions != Directions::uniform) cosine_directions(tile_size, d.u, d.v, d.x, d.y, d.z);
  }

  /// Every path takes what its hit emits, asks for a point of the emitters, and goes on or ends.
  void advance(Wave& wave, int bounce) const {
    const std::size_t n = wave.size;
    const bool tiles = options_.directions != Directions::uniform;
    DiffuseTile& diffuse = wave.diffuse;
    OtherTile& other = wave.other;
    wave.size = wave.shadow_size = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const accel::Hit<Scalar> hit = wave.hits[i];
      const Path& path = wave.paths[i];
      if (!hit) {
        wave.radiance[path.slot] += times(path.throughput, stage_.surfaces().background());
        continue;
      }
      const Vec3f direction(wave.rays[i].direction);
      const float t = static_cast<float>(hit.t);
      const Surfaces::Side at = stage_.surfaces().side(direction, hit.primitive);
      if (at.material->emits && at.cosine > 0)
        wave.radiance[path.slot] +=
            times(path.throughput, at.material->emission) * met_weight(path.pdf, hit.primitive, t, at.cosine);
      if (bounce == options_.max_bounces) continue;
      if (tiles && at.material->kind == SurfaceKind::diffuse) {
        const std::size_t lane = diffuse.size++;
        const Vec3f point = Vec3f(wave.rays[i].origin) + direction * t;
        const Rgb reflected = times(path.throughput, at.material->albedo);
        for (int k = 0; k < 3; ++k) {
          diffuse.point[k][lane] = point[k], diffuse.normal[k][lane] = at.normal[k];
          diffuse.throughput[k][lane] = reflected[k];
        }
        diffuse.hash[lane] = wave.hash[i], diffuse.index[lane] = wave.index[i];
        diffuse.slot[lane] = path.slot;
        if (diffuse.size == tile_size) reflect(wave, diffuse, bounce);
      } else {
        const std::size_t lane = other.size++;
        other.ray[lane] = wave.rays[i], other.hit[lane] = hit, other.path[lane] = path;
        other.hash[lane] = wave.hash[i], other.index[lane] = wave.index[i];
        if (other.size == tile_size) reflect(wave, other, bounce);
      }
    }
    if (diffuse.size > 0) reflect(wave, diffuse, bounce);
    if (other.size > 0) reflect(wave, other, bounce);
  }

  void reflect(Wave& wave, DiffuseTile& at, int bounce) const {
    TileDecisions& d = wave.decisions;
    decide(at.hash, at.index, bounce, d);
    const std::size_t n = std::exchange(at.size, 0);
    const auto vector = [](const auto& v, std::size_t i) { return Vec3f{v[0][i], v[1][i], v[2][i]}; };
    if (draws_lights()) {
      LampSegments to;
      draw_lamps(stage_.surfaces(), at, d, options_.lights == Lights::mis, to);
      std::size_t shadows = wave.shadow_size;
      for (std::size_t i = 0; i < n; ++i) {
        const Rgb light = vector(to.light, i);
        wave.shadow_rays[shadows] = cast_ray<Ray>({vector(to.from, i), vector(to.way, i), 0.0f, 1.0f});
        wave.shadows[shadows] = {light, at.slot[i]};
        shadows += largest(light) > 0 ? 1 : 0;
      }
      wave.shadow_size = shadows;
    }
    TileRays rays;
    leave(stage_.surfaces(), at, d, rays);
    std::size_t size = wave.size;
    for (std::size_t i = 0; i < n; ++i) {
      Rgb throughput = vector(at.throughput, i);
      bool lives = largest(throughput) > 0;
      if (options_.survival && lives) {
        const float survives = options_.survival(bounce, throughput);
        lives = d.roulette[i] < survives;
        throughput = throughput / std::min(1.0f, survives);
      }
      wave.rays[size] = cast_ray<Ray>({vector(rays.origin, i), vector(rays.direction, i)});
      wave.paths[size] = {throughput, rays.pdf[i], at.slot[i]};
      wave.hash[size] = at.hash[i], wave.index[size] = at.index[i];
      size += lives ? 1 : 0;
    }
    wave.size = size;
  }

  void reflect(Wave& wave, OtherTile& tile, int bounce) const {
    decide(tile.hash, tile.index, bounce, wave.decisions);
    const std::size_t n = std::exchange(tile.size, 0);
    for (std::size_t i = 0; i < n; ++i) {
      const Ray& ray = tile.ray[i];
      const Vertex at = stage_.surfaces().meet(Vec3f(ray.origin), Vec3f(ray.direction),
                                               static_cast<float>(tile.hit[i].t), tile.hit[i].primitive);
      Path path = tile.path[i];
      if (draws_lights() && !at.material->bsdf.delta()) draw_light(wave, path, at, i);
      if (!scatter(path, at, wave.decisions, i, bounce, wave.rays[wave.size])) continue;
      wave.hash[wave.size] = tile.hash[i], wave.index[wave.size] = tile.index[i];
      wave.paths[wave.size++] = path;
    }
  }

  /// Of an emitter's light that the path meets: how much of it counts here and not where points are drawn.
  float met_weight(float pdf, std::uint32_t face, float t, float cosine) const {
    if (options_.lights == Lights::none || pdf == infinity) return 1;
    if (options_.lights == Lights::next_event) return 0;
    return power_weight(pdf, stage_.surfaces().pdf_of_light(face, t, cosine));
  }
  static float power_weight(float pdf, float other) {
    const float ratio = other / pdf;
    return 1 / (1 + ratio * ratio);
  }

  /// Asks for a ray to a point of the emitters, with the light that it would bring.
  void draw_light(Wave& wave, const Path& path, const Vertex& at, std::size_t i) const {
    const TileDecisions& d = wave.decisions;
    const Surfaces::LightPoint to = stage_.surfaces().light(at, d.emitter[i], d.light_u[i], d.light_v[i]);
    if (to.pdf == 0) return;
    const bool diffuse = at.material->kind == SurfaceKind::diffuse;
    const Rgb reflected = diffuse ? at.material->albedo * (1 / pi) : at.material->bsdf.eval(to.in, at.out);
    float weight = to.in[2] / to.pdf;
    if (options_.lights == Lights::mis) {
      const float pdf = options_.directions == Directions::uniform ? 1 / (2 * pi)
                        : diffuse || options_.directions == Directions::cosine
                            ? to.in[2] * (1 / pi)
                            : at.material->bsdf.pdf(to.in, at.out);
      weight *= power_weight(to.pdf, pdf);
    }
    const Rgb light = times(times(path.throughput, reflected), to.emission) * weight;
    if (!(largest(light) > 0)) return;
    wave.shadow_rays[wave.shadow_size] = cast_ray<Ray>(to.ray);
    wave.shadows[wave.shadow_size++] = {light, path.slot};
  }

  /// Draws the path's next direction; false if it ends.
  bool scatter(Path& path, const Vertex& at, const TileDecisions& d, std::size_t i, int bounce,
               Ray& next) const {
    const Surfaces::Material& material = *at.material;
    const bool diffuse = material.kind == SurfaceKind::diffuse;
    Vec3f in;
    if (material.bsdf.delta() || (options_.directions == Directions::bsdf && !diffuse)) {
      const brdf::BsdfSample<float> s = material.bsdf.sample(at.out, d.choice[i], d.u[i], d.v[i]);
      in = s.wi, path.pdf = s.delta ? infinity : s.pdf;
      path.throughput = times(path.throughput, s.weight);
    } else {
      const bool uniform = options_.directions == Directions::uniform;
      in = uniform ? geometry::sample_hemisphere(d.u[i], d.v[i]) : Vec3f{d.x[i], d.y[i], d.z[i]};
      path.pdf = uniform ? 1 / (2 * pi) : in[2] * (1 / pi);
      const Rgb reflected = diffuse ? material.albedo * (1 / pi) : material.bsdf.eval(in, at.out);
      path.throughput = times(path.throughput, reflected) * (uniform ? in[2] * (2 * pi) : pi);
    }
    if (!(largest(path.throughput) > 0)) return false;
    // Glass keeps all light: a path that enters it carries less for a while, as it takes less solid angle.
    if (options_.survival && material.kind != SurfaceKind::glass) {
      const float survives = options_.survival(bounce, path.throughput);
      if (!(d.roulette[i] < survives)) return false;
      path.throughput = path.throughput / std::min(1.0f, survives);
    }
    next = cast_ray<Ray>(stage_.surfaces().leaving(at, in));
    return true;
  }

  PathOptions options_;
  Stage<Index> stage_;
};

}  // namespace treeline::shading::transport
