// How many threads do what nobody times: making queries, finding their truth, drawing.
#pragma once

#include <algorithm>
#include <thread>

namespace treeline::bench {

/// All that the machine has. Not for hard cases: they run in children of a fork, which must not have a pool.
inline int all_threads() { return static_cast<int>(std::max(1u, std::thread::hardware_concurrency())); }

}  // namespace treeline::bench
