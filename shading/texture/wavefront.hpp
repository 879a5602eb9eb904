// Tiles that wait for the tile above and the tile to the left: what a running sum in two directions needs.
// Known weakness: the first and the last tiles leave threads idle; a table should be many tiles.
#pragma once

#include <oneapi/tbb/task_arena.h>
#include <oneapi/tbb/task_group.h>

#include <atomic>
#include <vector>

#include "accel/batch.hpp"

namespace treeline::shading::texture {

/// Calls f(row, column) once for each tile; not before f(row - 1, column) and f(row, column - 1) have
/// returned, and what these wrote can be read. f throws nothing.
template <class F>
void wavefront(int rows, int columns, int threads, const F& f) {
  accel::check_threads(threads);
  if (threads == 1 || rows * columns == 1) {
    for (int r = 0; r < rows; ++r)
      for (int c = 0; c < columns; ++c) f(r, c);
    return;
  }
  const auto at = [&](int r, int c) { return static_cast<std::size_t>(r * columns + c); };
  std::vector<std::atomic<int>> waits(at(rows, 0));
  std::atomic<int> done{0};
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) waits[at(r, c)] = (r > 0) + (c > 0);
  tbb::task_arena arena(accel::allowed_threads(threads));
  arena.execute([&] {
    tbb::task_group group;
    const auto run = [&](const auto& self, int r, int c) -> void {
      for (;;) {  // the tile to the right follows on this thread if it is free
        waits[at(r, c)].load(std::memory_order_acquire);
        f(r, c);
        done.fetch_add(1, std::memory_order_release);
        if (r + 1 < rows && waits[at(r + 1, c)].fetch_sub(1, std::memory_order_acq_rel) == 1)
          group.run([&self, r, c] { self(self, r + 1, c); });
        if (c + 1 == columns || waits[at(r, c + 1)].fetch_sub(1, std::memory_order_acq_rel) != 1) return;
        ++c;
      }
    };
    group.run_and_wait([&] { run(run, 0, 0); });
  });
  done.load(std::memory_order_acquire);
}

}  // namespace treeline::shading::texture
