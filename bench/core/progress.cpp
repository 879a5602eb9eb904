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

namespace {
constexpr double rewrite_every = 0.1;  // s: what no eye follows is not worth a write between two timings
}

Progress::Progress(std::vector<double> weights, double line_every)
    : weights_(std::move(weights)),
      total_(std::accumulate(weights_.begin(), weights_.end(), 0.0)),
      terminal_(isatty(STDERR_FILENO) == 1),
      every_(terminal_ ? rewrite_every : line_every) {}

Progress::~Progress() { clear(); }

std::string Progress::line(double share) const {
  const double elapsed = std::chrono::duration<double>(Clock::now() - start_).count();
  const double done = total_ > 0 ? (before_ + share * weights_[k_]) / total_ : 0;
  const std::string remaining = done > 0.01 ? "about " + format_seconds(elapsed * (1 - done) / done) : "?";
  return fmt::format("block {} of {}  {}  elapsed {}, remaining {}", k_ + 1, weights_.size(), label_,
                     format_seconds(elapsed), remaining);
}

void Progress::block(std::size_t k, const std::string& label) {
  k_ = k, label_ = label;
  before_ = std::accumulate(weights_.begin(), weights_.begin() + static_cast<std::ptrdiff_t>(k), 0.0);
  printed_ = Clock::now();
  if (!terminal_) return fmt::print(stderr, "{}\n", line(0));
  printed_ -= std::chrono::hours(1);
  step(0, "");
}

void Progress::step(double share, const std::string& what) {
  const auto now = Clock::now();
  if (std::chrono::duration<double>(now - printed_).count() < every_) return;
  printed_ = now;
  const std::string text = line(std::clamp(share, 0.0, 1.0)) + (what.empty() ? "" : "  " + what);
  if (!terminal_) return fmt::print(stderr, "{}\n", text);
  fmt::print(stderr, "\r\033[K{:.140}", text);
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
