#include "bench/core/options.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdlib>
#include <thread>

#include "datasets_gen/whole_number.hpp"

namespace treeline::bench {
namespace {

bool truthy(const std::string& flag, std::string value) {
  for (char& c : value) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  for (const char* yes : {"", "1", "true", "yes", "on", "t", "y"})
    if (value == yes) return true;
  for (const char* no : {"0", "false", "no", "off", "f", "n"})
    if (value == no) return false;
  throw UsageError(fmt::format("{} is '{}'; it must be true or false", flag, value));
}

const std::string& one_of_formats(const std::string& flag, const std::string& value) {
  if (value != "console" && value != "json" && value != "csv")
    throw UsageError(fmt::format("{} is '{}'; it must be console, json or csv", flag, value));
  return value;
}

/// Of those passed on, the numbers that Google Benchmark takes though they make no sense. What is no number
/// it refuses by itself.
void check_benchmark_number(const std::string& flag, const std::string& value) {
  char* end = nullptr;
  const double number = std::strtod(value.c_str(), &end);
  if (end == value.c_str()) return;
  if (flag == "--benchmark_repetitions" && !(number >= 1 && number <= 1e6))
    throw UsageError(fmt::format("{} is '{}'; it must be from 1 to 1000000", flag, value));
  if ((flag == "--benchmark_min_time" || flag == "--benchmark_min_warmup_time") &&
      !(number >= 0 && number <= 1e6))
    throw UsageError(fmt::format("{} is '{}'; it must be from 0 to 1000000", flag, value));
}

void take_benchmark_flag(BenchmarkFlags& flags, const std::string& argument) {
  const std::size_t equals = std::min(argument.find('='), argument.size());
  const std::string flag = argument.substr(0, equals);
  const std::string value = equals < argument.size() ? argument.substr(equals + 1) : "";
  const auto needs_value = [&] {
    if (value.empty()) throw UsageError(flag + " needs a value: " + flag + "=…");
  };
  if (flag == "--benchmark_filter")
    needs_value(), flags.filter = value;
  else if (flag == "--benchmark_format")
    needs_value(), flags.format = one_of_formats(flag, value);
  else if (flag == "--benchmark_out")
    needs_value(), flags.out = value;
  else if (flag == "--benchmark_out_format")
    needs_value(), flags.out_format = one_of_formats(flag, value);
  else if (flag == "--benchmark_list_tests")
    flags.list_tests = truthy(flag, value);
  else if (flag == "--benchmark_report_aggregates_only")
    flags.file_aggregates_only = flags.display_aggregates_only = truthy(flag, value);
  else if (flag == "--benchmark_display_aggregates_only")
    flags.display_aggregates_only = truthy(flag, value);
  else
    check_benchmark_number(flag, value), flags.passed_on.push_back(argument);
}

/// CLI11's own checks name the largest number there is, in all its 309 digits.
CLI::Validator number_that(bool (*fits)(double), const std::string& what) {
  const auto check = [fits, what](const std::string& text) {
    char* end = nullptr;
    const double number = std::strtod(text.c_str(), &end);
    const bool is_number = !text.empty() && *end == '\0';
    return is_number && fits(number) ? std::string() : fmt::format("'{}' is not {}", text, what);
  };
  return CLI::Validator(check, "");
}

/// More threads than the machine has are not measured: some methods would take fewer, and rows would not say
/// so.
int threads_to_use(int asked) {
  const int there = static_cast<int>(std::thread::hardware_concurrency());  // 0: not known
  if (there == 0 || asked <= there) return asked;
  fmt::print(stderr, "--threads {}: this machine has {}, which is what is used\n", asked, there);
  return there;
}

std::string default_cache() {
  if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache && *cache)
    return std::string(cache) + "/treeline";
  if (const char* home = std::getenv("HOME"); home && *home) return std::string(home) + "/.cache/treeline";
  return "";
}

void check_combinations(const Options& o) {
  const auto never = [](bool both, const char* message) {
    if (both) throw UsageError(message);
  };
  never(o.resume && o.rows.empty(), "--resume needs --rows FILE, the rows to continue");
  never(!o.input.empty() && !o.datasets.empty(), "--input and --dataset exclude each other");
  never(!o.input.empty() && o.stress, "--input and --stress exclude each other");
  never(!o.input.empty() && o.block != 0, "--input is one block: --block does not apply");
  never(!o.input.empty() && !o.pictures.empty(),
        "--pictures needs blocks of the task; it does not work with --input");
  never(o.stress && o.advise, "--advise and --stress exclude each other");
  never(o.stress && !o.pictures.empty(), "--pictures and --stress exclude each other");
  if (o.stress && !o.context.own.empty())
    throw UsageError(fmt::format("{} and --stress exclude each other: hard cases stand as they are",
                                 o.context.own.begin()->first));
  never(o.scaling && (o.stress || o.advise || !o.input.empty() || !o.pictures.empty()),
        "--scaling stands alone: without --stress, --advise, --input and --pictures");
  never(o.advise && o.input.empty() && o.datasets.empty(),
        "--advise needs --dataset NAME[:n] or --input FILE to measure on");
  never(o.advise && !(std::isfinite(*o.advise) && *o.advise >= 0),
        "--advise needs a tolerance that is finite and not negative");
}

}  // namespace

std::variant<Options, int> parse_command_line(const std::string& task, int argc, const char* const* argv,
                                              const std::vector<TaskFlag>& own) {
  Options o;
  o.program = argc > 0 ? argv[0] : "bench_" + task;
  o.context.truth_cache = default_cache();

  std::vector<std::string> arguments;
  for (int i = argc - 1; i > 0; --i) {  // CLI11 wants them backwards
    const std::string argument = argv[i];
    if (!argument.starts_with("--benchmark_")) arguments.push_back(argument);
  }
  for (int i = 1; i < argc; ++i)
    if (const std::string argument = argv[i]; argument.starts_with("--benchmark_"))
      take_benchmark_flag(o.benchmark, argument);

  CLI::App app("Speed against accuracy for the task " + task + ".", "bench_" + task);
  app.footer(
      "Google Benchmark's own flags (--benchmark_filter=…, --benchmark_out=FILE, --benchmark_min_time=…, …) "
      "work too.\n"
      "Exit status: 0 all cells ended as expected, and --advise names a method for every query set, for all\n"
      "together or for each alone; 1 a cell of ours is wrong, crashed or timeout, a query set is without a\n"
      "method, or a filter matched nothing; 2 unusable arguments or input.");
  const auto positive = number_that([](double x) { return x > 0 && x <= 1e18; }, "a positive number");
  const auto seconds =
      number_that([](double x) { return x > 0 && x <= 1e6; }, "a number of seconds up to 1000000");
  std::string profile = "quick";
  app.add_flag("--list", o.list, "Every block and method with its knobs, one per line");
  app.add_option("--profile", profile, "smoke, quick or full")
      ->check(CLI::IsMember({"smoke", "quick", "full"}));
  app.add_option("--dataset", o.datasets, "Only these datasets: NAME or NAME:n");
  app.add_option("--input", o.input, "Measure on a file of your own");
  app.add_option("--seed", o.context.seed, "Seed of datasets, queries and samples")
      ->check(datasets::whole_number());
  app.add_option("--threads", o.context.threads, "Threads that share a batch")->check(CLI::Range(1, 4096));
  app.add_option("--rows", o.rows, "Append rows to this file; an existing one is refused without --resume");
  app.add_flag("--resume", o.resume, "Continue the rows file: finished cells are not repeated");
  app.add_flag("--stress", o.stress, "The hard cases, each in a child process");
  app.add_flag("--scaling", o.scaling, "The blocks of thread scaling, at 1, 2, 4, … threads of this machine");
  app.add_option("--advise", o.advise, "Cheapest method within this error on the given dataset or file");
  app.add_option("--block", o.block, "Only block K of --list, with all its methods")->check(positive);
  app.add_option("--pictures", o.pictures, "Write pictures of the blocks into this folder");
  app.add_option("--cache", o.context.truth_cache, "Folder for truths already computed (empty: none)");
  app.add_option("--stress-seconds", o.limits.seconds, "Time limit of a step of a hard case")->check(seconds);
  app.add_option("--stress-bytes", o.limits.memory, "Memory limit of a hard case")->check(positive);
  for (const TaskFlag& flag : own) app.add_option(flag.name, o.context.own[flag.name], flag.help);
  try {
    app.parse(arguments);
  } catch (const CLI::CallForHelp& help) {
    return app.exit(help);
  } catch (const CLI::ParseError& error) {
    throw UsageError(error.what());
  }
  for (const TaskFlag& flag : own) {
    if (app.count(flag.name) == 0)
      o.context.own.erase(flag.name);
    else if (o.context.own[flag.name].empty())
      throw UsageError(fmt::format("{} is empty; it needs a value", flag.name));
  }
  // An empty one would count as not given.
  for (const auto& [flag, empty] : {std::pair("--input", o.input.empty()),
                                    {"--rows", o.rows.empty()},
                                    {"--pictures", o.pictures.empty()},
                                    {"--advise", !o.advise}})
    if (app.count(flag) > 0 && empty) throw UsageError(fmt::format("{} is empty; it needs a value", flag));
  o.context.profile = profile == "smoke"  ? Profile::smoke
                      : profile == "full" ? Profile::full
                                          : Profile::quick;
  check_combinations(o);
  if (o.scaling && app.count("--threads") > 0)
    throw UsageError("--scaling goes through the thread counts by itself: --threads does not apply");
  o.context.threads = threads_to_use(o.context.threads);
  return o;
}

}  // namespace treeline::bench
