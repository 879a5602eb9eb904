// Batches: one range of queries shared by several threads, in chunks of fixed size, so that neither the
// answers nor their order depend on how many threads there are or which of them ran a chunk.
#pragma once

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>
#include <oneapi/tbb/task_group.h>

#include <algorithm>
#include <limits>
#include <string>
#include <vector>

#include "accel/concepts.hpp"
#ifdef __SANITIZE_THREAD__
#include <atomic>
#include <future>
#endif

namespace treeline::accel {

/// Queries a thread takes at once: some 100 µs of work, far more than it costs to hand them out.
inline constexpr std::size_t batch_chunk = 256;

inline void check_threads(int threads) {
  if (threads < 1) throw InvalidInput("threads is " + std::to_string(threads) + "; it must be at least 1");
}

/// Of a build option that stands for a cost.
inline void check_cost(const char* name, double value) {
  if (!(value > 0 && value <= std::numeric_limits<double>::max()))
    throw InvalidInput(std::string(name) + " is " + std::to_string(value) +
                       "; it must be positive and finite");
}

/// Asking TBB for more workers than it may have makes it print.
inline int allowed_threads(int threads) {
  const std::size_t most = tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
  return static_cast<int>(std::min<std::size_t>(most, static_cast<std::size_t>(threads)));
}

/// Calls f(begin, end) for ranges that cover [0, n) once each; every begin is a multiple of batch_chunk. On
/// one thread there is one range and TBB stays out of it. An exception of f reaches the caller.
template <class F>
void parallel_ranges(std::size_t n, int threads, F&& f) {
  check_threads(threads);
  if (n == 0) return;
  if (threads == 1 || n <= batch_chunk) return static_cast<void>(f(std::size_t{0}, n));
  const std::size_t chunks = (n + batch_chunk - 1) / batch_chunk;
  const auto chunk = [&](std::size_t c) { f(c * batch_chunk, std::min(n, (c + 1) * batch_chunk)); };
#ifdef __SANITIZE_THREAD__
  // The thread sanitizer does not see how TBB's library, built without it, hands work over; it sees this.
  std::atomic<std::size_t> next{0};
  std::vector<std::future<void>> helpers;
  for (int i = 0; i < threads; ++i)
    helpers.push_back(std::async(std::launch::async, [&] {
      for (std::size_t c; (c = next++) < chunks;) chunk(c);
    }));
  for (auto& helper : helpers) helper.wait();
  for (auto& helper : helpers) helper.get();
#else
  tbb::task_arena arena(allowed_threads(threads));
  arena.execute([&] { tbb::parallel_for(std::size_t{0}, chunks, chunk); });
#endif
}

/// Calls both, at the same time if a worker is free. Inside an arena of as many threads as are wanted.
template <class F, class G>
void both(F&& f, G&& g) {
#ifdef __SANITIZE_THREAD__
  auto other = std::async(std::launch::async, f);
  g();
  other.get();
#else
  tbb::task_group group;
  group.run(f);
  group.run_and_wait(g);
#endif
}

/// Fills `lists` with the answers of n queries in query order. append(i, items) adds those of query i to
/// items.
template <class Item, class Append>
void parallel_lists(std::size_t n, int threads, Lists<Item>& lists, Append&& append) {
  check_threads(threads);
  lists.clear();
  lists.offsets.resize(n + 1);
  if (threads == 1) {
    for (std::size_t i = 0; i < n; ++i) append(i, lists.items), lists.offsets[i + 1] = lists.items.size();
    return;
  }
  std::vector<std::vector<Item>> parts(n / batch_chunk + 1);
  parallel_ranges(n, threads, [&](std::size_t begin, std::size_t end) {
    std::vector<Item>& part = parts[begin / batch_chunk];
    for (std::size_t i = begin; i < end; ++i) {
      const std::size_t before = part.size();
      append(i, part);
      lists.offsets[i + 1] = part.size() - before;
    }
  });
  for (std::size_t i = 0; i < n; ++i) lists.offsets[i + 1] += lists.offsets[i];
  lists.items.resize(lists.offsets[n]);
  parallel_ranges(n, threads, [&](std::size_t begin, std::size_t) {
    const std::vector<Item>& part = parts[begin / batch_chunk];
    std::copy(part.begin(), part.end(),
              lists.items.begin() + static_cast<std::ptrdiff_t>(lists.offsets[begin]));
  });
}

}  // namespace treeline::accel
