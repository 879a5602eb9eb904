// Sharing out truths among threads: few queries, each of which costs milliseconds.
#pragma once

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

namespace treeline::bench::knn {

/// Calls f(begin, end) for ranges that cover [0, n) once each. On one thread TBB stays out of it, so that a
/// process may fork afterwards.
template <class F>
void parallel_chunks(std::size_t n, int threads, F&& f) {
  if (threads <= 1) return static_cast<void>(f(std::size_t{0}, n));
  tbb::task_arena arena(threads);
  arena.execute([&] {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, n), [&](const auto& r) { f(r.begin(), r.end()); });
  });
}

}  // namespace treeline::bench::knn
