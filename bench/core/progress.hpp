// How far a run has come, on stderr: one line that is rewritten on a terminal; elsewhere, as in a log, a line
// a block, and one more now and then while a block takes long.
#pragma once

#include <chrono>
#include <string>
#include <vector>

namespace treeline::bench {

class Progress {
 public:
  /// One weight a block: its share of the work, in any unit. line_every: seconds between the lines of a long
  /// block where there is no terminal.
  explicit Progress(std::vector<double> weights, double line_every = 20);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Block k = 0, 1, … starts.
  void block(std::size_t k, const std::string& label);
  /// The block is done to this share, at what is named. Cheap where nothing is due to be shown.
  void step(double share, const std::string& what);
  /// Takes the line away before something else is printed.
  void clear();

 private:
  std::string line(double share) const;

  std::vector<double> weights_;
  double total_ = 0, before_ = 0;
  std::size_t k_ = 0;
  std::string label_;
  bool terminal_, shown_ = false;
  double every_;  // seconds between two prints of steps
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_ = Clock::now(), printed_ = start_;
};

/// 75 → "1:15".
std::string format_seconds(double seconds);

}  // namespace treeline::bench
