// What the command line asks for.
#pragma once

#include <optional>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

#include "bench/core/isolation.hpp"
#include "bench/core/task.hpp"

namespace treeline::bench {

/// An unusable argument or input; the program says so and ends with status 2.
struct UsageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};
/// A filter that matches nothing; status 1.
struct NothingMatched : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Google Benchmark's flags. It runs once a query set here, so those that choose cells or write whole files
/// are ours to follow; the rest is passed on as it is.
struct BenchmarkFlags {
  std::string filter;  // over cell names, as Google Benchmark matches: extended regex, "-" in front negates
  std::string format;  // of stdout: console, json, csv; empty: our table
  std::string out;     // file
  std::string out_format = "json";
  bool list_tests = false;
  bool file_aggregates_only = false, display_aggregates_only = false;
  std::vector<std::string> passed_on;
};

struct Options {
  std::string program;  // argv[0]
  RunContext context;
  bool list = false, stress = false, scaling = false, resume = false;
  std::vector<std::string> datasets;
  std::string input, rows, pictures;
  std::optional<double> advise;
  std::size_t block = 0;  // 1, 2, …; 0: all
  Limits limits;          // of --stress
  BenchmarkFlags benchmark;

  /// stdout belongs to Google Benchmark's json or csv.
  bool quiet() const { return benchmark.format == "json" || benchmark.format == "csv"; }
};

/// The options, or the exit status if the program ends here (--help); `own` are the task's own flags. Throws
/// UsageError naming the bad flag.
std::variant<Options, int> parse_command_line(const std::string& task, int argc, const char* const* argv,
                                              const std::vector<TaskFlag>& own = {});

}  // namespace treeline::bench
