// A few long pieces of work shared by threads, one piece at a time.
#pragma once

#include "accel/batch.hpp"

namespace treeline::bench::brdf_integral {

/// Calls f(i) for every i below n. On one thread TBB stays out of it.
template <class F>
void share(std::size_t n, int threads, F&& f) {
  accel::parallel_ranges(n * accel::batch_chunk, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin / accel::batch_chunk; i < end / accel::batch_chunk; ++i) f(i);
  });
}

}  // namespace treeline::bench::brdf_integral
