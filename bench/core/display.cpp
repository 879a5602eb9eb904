#include "bench/core/display.hpp"

#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>

namespace treeline::bench {
namespace {

using Run = benchmark::BenchmarkReporter::Run;

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wdeprecated-declarations"  // CSVReporter: as long as it is there, it works
std::unique_ptr<benchmark::BenchmarkReporter> make_reporter(const std::string& format) {
  if (format == "json") return std::make_unique<benchmark::JSONReporter>();
  if (format == "csv") return std::make_unique<benchmark::CSVReporter>();
  return std::make_unique<benchmark::ConsoleReporter>(benchmark::ConsoleReporter::OO_Tabular);
}
#pragma GCC diagnostic pop

/// JSON has no NaN, and Google Benchmark writes one where it divides by a CPU time of zero.
std::vector<Run> presentable(const std::vector<Run>& runs, bool aggregates_only) {
  bool any_aggregate = false;
  for (const Run& run : runs) any_aggregate = any_aggregate || run.run_type == Run::RT_Aggregate;
  std::vector<Run> out;
  for (Run run : runs) {
    if (aggregates_only && any_aggregate && run.run_type != Run::RT_Aggregate) continue;
    if (!std::isfinite(run.real_accumulated_time)) run.real_accumulated_time = 0;
    if (!std::isfinite(run.cpu_accumulated_time)) run.cpu_accumulated_time = 0;
    std::erase_if(run.counters, [](const auto& counter) { return !std::isfinite(counter.second.value); });
    out.push_back(std::move(run));
  }
  return out;
}

}  // namespace

Display::Display(const BenchmarkFlags& flags) {
  if (!flags.format.empty()) outputs_.push_back({make_reporter(flags.format), flags.display_aggregates_only});
  if (flags.out.empty()) return;
  std::error_code error;
  if (std::filesystem::exists(flags.out, error) && std::filesystem::file_size(flags.out, error) > 0)
    throw UsageError("--benchmark_out=" + flags.out + " exists already");
  file_.open(flags.out);
  if (!file_) throw UsageError("--benchmark_out=" + flags.out + ": " + std::strerror(errno));
  auto reporter = make_reporter(flags.out_format);
  reporter->SetOutputStream(&file_), reporter->SetErrorStream(&file_);
  outputs_.push_back({std::move(reporter), flags.file_aggregates_only});
}

Display::~Display() {
  if (outputs_.empty()) return;
  if (!opened_) open_outputs(Context());  // nothing was timed: still a valid document
  for (Output& output : outputs_) {
    output.reporter->Finalize();
    output.reporter->GetOutputStream().flush();
  }
}

void Display::open_outputs(const Context& context) {
  opened_ = true;
  for (Output& output : outputs_) output.reporter->ReportContext(context);
}

bool Display::ReportContext(const Context& context) {
  if (!opened_) open_outputs(context);
  return true;
}

void Display::ReportRuns(const std::vector<Run>& runs) {
  for (const Run& run : runs) {
    if (run.run_type != Run::RT_Iteration || run.error_occurred || run.iterations == 0) continue;
    const auto iterations = static_cast<double>(run.iterations);
    repetitions_[run.run_name.function_name].push_back(
        {run.real_accumulated_time / iterations, run.cpu_accumulated_time / iterations});
  }
  for (Output& output : outputs_)
    if (const auto shown = presentable(runs, output.aggregates_only); !shown.empty())
      output.reporter->ReportRuns(shown);
}

}  // namespace treeline::bench
