// Timing by Google Benchmark: the cells of one query set take turns, repetition by repetition, in random
// order.
#pragma once

#include <exception>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "bench/core/display.hpp"
#include "bench/core/options.hpp"

namespace treeline::bench {

struct TimedCell {
  std::string name;           // unique among the cells timed together
  std::function<void()> run;  // one batch
  double seconds = 0;         // what one batch takes, about: chooses how many make a repetition
  // What timing finds:
  std::vector<Repetition> repetitions;
  std::exception_ptr error;  // what a run threw; then there are no repetitions
};

class Timer {
 public:
  /// One a program. Throws UsageError for flags that Google Benchmark does not know.
  Timer(Profile, const BenchmarkFlags&);
  /// on_run: told before each run of a cell, not in the time that is taken, with the share of the work done.
  void measure(std::span<TimedCell>, const std::function<void(double share, const TimedCell&)>& on_run = {});

 private:
  bool once_, ahead_, fewer_;
  std::unique_ptr<Display> display_;
};

/// Median, and the interval that holds the true median with 95 % confidence; lowest and highest for less than
/// six samples, which cannot promise that much.
struct MedianInterval {
  double median = 0, low = 0, high = 0;
};
MedianInterval median_interval(std::vector<double> samples);

}  // namespace treeline::bench
