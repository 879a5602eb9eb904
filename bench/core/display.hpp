// Where Google Benchmark reports to. It runs once per query set, its reporters are made for once per program:
// this one opens and closes them once, so that JSON stays one valid document, and keeps every repetition.
#pragma once

#include <benchmark/benchmark.h>

#include <fstream>
#include <memory>
#include <string>
#include <unordered_map>
#include <vector>

#include "bench/core/options.hpp"

namespace treeline::bench {

struct Repetition {
  double seconds = 0, cpu_seconds = 0;  // per batch; CPU of the whole process
};

class Display : public benchmark::BenchmarkReporter {
 public:
  /// Throws UsageError if the output file exists or cannot be written.
  explicit Display(const BenchmarkFlags&);
  ~Display() override;

  bool ReportContext(const Context&) override;
  void ReportRuns(const std::vector<Run>&) override;
  void Finalize() override {}  // at the end of every query set: too early

  /// Repetitions by the benchmark's name since the last call.
  std::unordered_map<std::string, std::vector<Repetition>> take() { return std::move(repetitions_); }

 private:
  struct Output {
    std::unique_ptr<BenchmarkReporter> reporter;
    bool aggregates_only = false;
  };
  void open_outputs(const Context&);

  std::ofstream file_;
  std::vector<Output> outputs_;
  bool opened_ = false;
  std::unordered_map<std::string, std::vector<Repetition>> repetitions_;
};

}  // namespace treeline::bench
