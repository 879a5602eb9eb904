// The path tracer that truths and pictures are made with: all lamps both met and aimed at, scrambled Sobol
// points, no limit of bounces.
#pragma once

#include <memory>

#include "bench/light_transport/method.hpp"

namespace treeline::bench::light_transport {

class Tracer {
 public:
  virtual ~Tracer() = default;
  virtual Film film() const = 0;  ///< empty, of the camera's size
  virtual void add(Film&, int samples, int threads) const = 0;
};

/// `set` samples of a pixel share a net. The room must outlive it. Throws transport::InvalidScene.
std::unique_ptr<Tracer> mis_tracer(const LitScene& room, std::uint64_t seed, int set);

}  // namespace treeline::bench::light_transport
