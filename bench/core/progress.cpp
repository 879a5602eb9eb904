#include "bench/core/progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <numeric>

namespace treeline::bench {

std::string format_seconds(double seconds) {
  const auto s = static_cast<long>(seconds + 0.5);
  return s >= 3600 ? fmt::format("{}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60)
                   : fmt::format("{}:{:02}", s / 60, s % 60);
}

Progress::Progress(std::vector<double> weights)
    : weights_(std::move(weights)),
      total_(std::accumulate(weights_.begin(), weights_.end(), 0.0)),
      terminal_(isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() { clear(); }

std::string Progress::line(double share) const {
  const double elapsed = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  const double done = total_ > 0 ? (before_ + share * weights_[k_]) / total_ : 0;
  const std::string remaining = done > 0.01 ? "about " + format_seconds(elapsed * (1 - done) / done) : "?";
  return fmt::format("block {} of {}  {}  elapsed {}, remaining {}", k_ + 1, weights_.size(), label_,
                     format_seconds(elapsed), remaining);
}

void Progress::block(std::size_t k, const std::string& label) {
  k_ = k, label_ = label;
  before_ = std::accumulate(weights_.begin(), weights_.begin() + static_cast<std::ptrdiff_t>(k), 0.0);
  if (terminal_)
    step(0, "");
  else
    fmt::print(stderr, "{}\n", line(0));
}

void Progress::step(double share, const std::string& what) {
  if (!terminal_) return;
  fmt::print(stderr, "\r\033[K{:.140}",
             line(std::clamp(share, 0.0, 1.0)) + (what.empty() ? "" : "  " + what));
  std::fflush(stderr);
  shown_ = true;
}

void Progress::clear() {
  if (!shown_) return;
  fmt::print(stderr, "\r\033[K");
  std::fflush(stderr);
  shown_ = false;
}

}  // namespace treeline::bench
