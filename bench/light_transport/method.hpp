// What a method of this task gives it: something made for a room that carries light to the pixels of a film.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "bench/core/task.hpp"
#include "geometry/ray.hpp"
#include "shading/scene.hpp"
#include "shading/transport/film.hpp"

namespace treeline::bench::light_transport {

using shading::LitScene;
using shading::Rgb;
using shading::transport::Film;

/// A ray for a pixel, at u and v in [0, 1) of it; of unit direction. Called by many threads.
using RaySource = std::function<geometry::Rayf(std::size_t pixel, float u, float v)>;

/// What is asked: the radiance along rays, averaged over each pixel.
struct Question {
  int width = 0, height = 0;
  RaySource source;  ///< empty: the room's camera, whose size is that of the question
};

/// Rays of a bounce, of all pixels and samples.
struct BounceRays {
  double reflected = 0, refracted = 0, shadow = 0;
};
struct Traced {
  double paths = 0, rays = 0, shadow_rays = 0;
  std::vector<BounceRays> bounces;  ///< of Whitted tracing; the first are those that leave what is seen
};

/// The room stays where it is as long as the subject lives.
struct Input {
  const LitScene& room;
  int threads = 1;
  std::uint64_t seed = 1;  ///< of all random numbers; truths draw theirs from hashes of it
};

class RoomSubject {
 public:
  virtual ~RoomSubject() = default;
  /// A film of the question's size with knob `samples` in each pixel. Throws to refuse the room.
  virtual Film render(const Question&, const Knobs& query_knobs, int threads, Traced&) = 0;
};

/// Knobs of the same meaning have the same name in all methods: samples (a pixel), bounces (without: no
/// limit that could be noticed), survival (of Russian roulette; without: by throughput), points (random, or
/// scrambled Sobol ones). The build makes the tree; everything else belongs to the query.
struct Method {
  MethodInfo info;
  std::unique_ptr<RoomSubject> (*build)(const Input&, const Knobs& build_knobs) = nullptr;
  /// Finds lamps by chance and by aiming at them, so that neither small nor mirrored ones are seldom found.
  bool combines = false;
  bool mirrors = true;  ///< false: it knows nothing of mirrors and glass, and rooms with them are not for it
  /// What it does among diffuse surfaces, another does as well: it is for rooms with rough metal.
  bool for_metal = false;
};

}  // namespace treeline::bench::light_transport
