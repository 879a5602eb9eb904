// Who traces what: blocks of pixels, each of them done by one thread from its first sample to its last.
//
// A pixel's samples are added to the film in their order whatever the number of threads, so that the film is
// the same bit by bit. A block has as many pixels as give a wave of paths; where a pixel alone has more
// samples than that, it is done in several waves.
#pragma once

#include <algorithm>

#include "accel/batch.hpp"
#include "shading/transport/film.hpp"

namespace treeline::shading::transport {

/// Some paths of consecutive pixels: sample first_sample + s of pixel first_pixel + p, path p · samples + s.
struct Block {
  std::size_t first_pixel, pixels;
  std::uint64_t first_sample;  ///< counted from those that this call adds
  std::size_t samples;         ///< of each pixel

  std::size_t paths() const { return pixels * samples; }
};

/// Calls make_worker() for each thread's turn and worker(block) for blocks of at most `wave` paths that have
/// all of `samples` of each of n pixels. Throws accel::InvalidInput for threads < 1.
template <class MakeWorker>
void each_block(std::size_t n, std::uint64_t samples, std::size_t wave, int threads,
                MakeWorker&& make_worker) {
  accel::check_threads(threads);
  if (samples == 0) return;
  const std::size_t pixels = std::max<std::size_t>(1, wave / std::min<std::uint64_t>(samples, wave));
  const std::size_t blocks = (n + pixels - 1) / pixels;
  accel::parallel_ranges(blocks * accel::batch_chunk, threads, [&](std::size_t begin, std::size_t end) {
    auto worker = make_worker();
    for (std::size_t b = begin / accel::batch_chunk; b < end / accel::batch_chunk; ++b)
      for (std::uint64_t s = 0; s < samples; s += wave)
        worker(Block{b * pixels, std::min(pixels, n - b * pixels), s,
                     static_cast<std::size_t>(std::min<std::uint64_t>(wave, samples - s))});
  });
}

}  // namespace treeline::shading::transport
