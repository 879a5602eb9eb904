#include "bench/core/timing.hpp"

#include <algorithm>
#include <cmath>

namespace treeline::bench {
namespace {

constexpr double long_batch_s = 0.5;   // longer batches run once a repetition
constexpr double slow_batch_s = 0.02;  // longer ones are repeated once only, where time is short
/// Long beside a clock's step and a cold start; the quick profile has thousands of cells.
constexpr double quick_repetition_s = 0.004;

std::vector<std::string> profile_flags(Profile profile) {
  switch (profile) {
    case Profile::smoke:
      return {"--benchmark_repetitions=1"};
    case Profile::quick:
      return {"--benchmark_repetitions=3"};
    case Profile::full:
      return {"--benchmark_min_time=0.2", "--benchmark_repetitions=9"};
  }
  return {};
}

void initialize(Profile profile, const BenchmarkFlags& flags, const std::string& program) {
  // Google Benchmark keeps pointers into these.
  static std::vector<std::string> arguments;
  static std::vector<char*> pointers;
  arguments = {program, "--benchmark_enable_random_interleaving=true"};
  for (const std::string& flag : profile_flags(profile)) arguments.push_back(flag);
  for (const std::string& flag : flags.passed_on) arguments.push_back(flag);
  pointers.clear();
  for (std::string& argument : arguments) pointers.push_back(argument.data());
  int count = static_cast<int>(pointers.size());
  pointers.push_back(nullptr);
  benchmark::Initialize(&count, pointers.data());
  if (count > 1) throw UsageError(std::string("Google Benchmark does not know or cannot use ") + pointers[1]);
}

bool is_given(const BenchmarkFlags& flags, std::string_view name) {
  return std::ranges::any_of(flags.passed_on,
                             [&](const std::string& flag) { return flag.starts_with(name); });
}

/// Google Benchmark finds the number of iterations by trial, which takes as long as the repetitions
/// themselves. The quick profile has no time for that: it knows what a batch takes.
bool counts_ahead(Profile profile, const BenchmarkFlags& flags) {
  return profile == Profile::quick && !is_given(flags, "--benchmark_min_time");
}

/// Of a cell, about: how many tries Google Benchmark needs to find the number of iterations is its own
/// matter, and so are the user's flags.
std::size_t expected_runs(bool once, bool ahead) { return once ? 1 : ahead ? 3 : 12; }

}  // namespace

Timer::Timer(Profile profile, const BenchmarkFlags& flags)
    : once_(profile == Profile::smoke),
      ahead_(counts_ahead(profile, flags)),
      fewer_(profile == Profile::quick && !is_given(flags, "--benchmark_repetitions")) {
  initialize(profile, flags, "bench");
  display_ = std::make_unique<Display>(flags);
}

void Timer::measure(std::span<TimedCell> cells,
                    const std::function<void(double share, const TimedCell&)>& on_run) {
  if (cells.empty()) return;
  std::size_t runs = 0;
  const auto expected = static_cast<double>(cells.size() * expected_runs(once_, ahead_));
  for (TimedCell& cell : cells) {
    auto* registered = benchmark::RegisterBenchmark(cell.name.c_str(), [&](benchmark::State& state) {
      if (on_run) on_run(std::min(1.0, static_cast<double>(runs++) / expected), cell);
      try {
        for (auto _ : state) cell.run();
      } catch (const std::exception& e) {
        cell.error = std::current_exception();
        state.SkipWithError(e.what());
      }
    });
    registered->UseRealTime()->MeasureProcessCPUTime();
    if (fewer_ && cell.seconds > slow_batch_s) registered->Repetitions(2);
    if (once_ || cell.seconds > long_batch_s)
      registered->Iterations(1);
    else if (ahead_)
      registered->Iterations(static_cast<benchmark::IterationCount>(
          std::max(1.0, quick_repetition_s / std::max(cell.seconds, 1e-6))));
  }
  benchmark::RunSpecifiedBenchmarks(display_.get(), nullptr, ".");
  benchmark::ClearRegisteredBenchmarks();
  auto found = display_->take();
  for (TimedCell& cell : cells)
    if (!cell.error) cell.repetitions = std::move(found[cell.name]);
}

MedianInterval median_interval(std::vector<double> samples) {
  if (samples.empty()) return {NAN, NAN, NAN};
  std::sort(samples.begin(), samples.end());
  const std::size_t n = samples.size();
  MedianInterval out{(samples[(n - 1) / 2] + samples[n / 2]) / 2, samples.front(), samples.back()};
  // The order statistics r and n - 1 - r (from 0) hold the median with probability 1 - 2 P(Bin(n, 1/2) ≤ r).
  double term = std::pow(0.5, static_cast<double>(n)), below = 0;
  for (std::size_t r = 0; r < n / 2; ++r) {
    below += term;
    if (below > 0.025) break;
    out.low = samples[r], out.high = samples[n - 1 - r];
    term *= static_cast<double>(n - r) / static_cast<double>(r + 1);
  }
  return out;
}

}  // namespace treeline::bench
