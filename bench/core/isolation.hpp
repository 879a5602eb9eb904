// A piece of work in a child process with a limit on time and memory: what it sends arrives line by line, and
// however it ends, the parent goes on.
//
// The parent must not have started threads: a fork copies only the calling one, and whoever then waits for
// another, or for a lock that it held, waits for ever.
#pragma once

#include <cstddef>
#include <functional>
#include <string>

#include "bench/core/row.hpp"

namespace treeline::bench {

struct Limits {
  double seconds = 20;              // between two lines, so per step of the work
  std::size_t memory = 4ull << 30;  // bytes of address space above what the parent has; 0: none
};

struct Ending {
  Status status = Status::ok;  // ok, crashed, timeout or out_of_memory
  std::string reason;          // signal or exit status, and the end of what the child wrote to stderr
};

using Send = std::function<void(const std::string& line)>;

/// Runs work(send) in a child; on_line is called in the parent. An std::bad_alloc that leaves work is
/// out_of_memory, any other exception counts as a crash.
Ending run_isolated(const std::function<void(const Send&)>& work, const Limits&,
                    const std::function<void(const std::string&)>& on_line);

/// While one lives, TBB starts no workers in this process, nor in its children unless they lift it.
class SingleThreaded {
 public:
  SingleThreaded();
  ~SingleThreaded();
  static void lift();  // in a child, for good
  SingleThreaded(const SingleThreaded&) = delete;
  SingleThreaded& operator=(const SingleThreaded&) = delete;
};

/// Threads of this process.
int thread_count();

}  // namespace treeline::bench
