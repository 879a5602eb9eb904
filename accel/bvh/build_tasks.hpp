// How builders share work out: halves of a range to whichever thread is free, in pieces whose borders do not
// depend on how many threads there are.
#pragma once

#include "accel/batch.hpp"

namespace treeline::accel {

class BuildTasks {
 public:
  explicit BuildTasks(int threads) : threads_(threads) {}

  /// Everything below is to be called from f.
  template <class F>
  void run(F&& f) const {
    if (threads_ == 1) return static_cast<void>(f());
    tbb::task_arena arena(allowed_threads(threads_));
    arena.execute(f);
  }

  /// f and g, at the same time if `size` elements are worth a task.
  template <class F, class G>
  void both(std::size_t size, F&& f, G&& g) const {
    if (threads_ > 1 && size >= worth_a_task) return accel::both(f, g);
    f(), g();
  }

  /// f(begin, end) for pieces of [0, n) that begin at multiples of `size`.
  template <class F>
  void pieces(std::size_t n, F&& f, std::size_t size = piece) const {
    pieces(0, n, f, size);
  }

  static constexpr std::size_t worth_a_task = 1 << 13;  // smaller, handing it over costs more than it brings
  static constexpr std::size_t piece = 1 << 14;

 private:
  template <class F>
  void pieces(std::size_t begin, std::size_t end, F& f, std::size_t size) const {
    if (end - begin <= size || threads_ == 1) {
      for (; begin < end; begin += size) f(begin, std::min(end, begin + size));
      return;
    }
    const std::size_t middle = begin + ((end - begin + size - 1) / size + 1) / 2 * size;
    accel::both([&] { pieces(begin, middle, f, size); }, [&] { pieces(middle, end, f, size); });
  }

  int threads_;
};

}  // namespace treeline::accel
