#include "bench/core/program.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <map>
#include <numeric>
#include <optional>
#include <thread>

#include "bench/core/advice.hpp"
#include "bench/core/harness.hpp"
#include "bench/core/isolation.hpp"
#include "bench/core/measure.hpp"
#include "bench/core/probe.hpp"
#include "bench/core/rounding.hpp"
#include "bench/core/selection.hpp"
#include "bench/core/stress.hpp"
#include "bench/core/table.hpp"
#include "datasets_gen/hard/hard_case.hpp"
#include "datasets_gen/hard/hard_insides.hpp"
#include "datasets_gen/hard/hard_light.hpp"
#include "datasets_gen/hard/hard_rows.hpp"
#include "datasets_gen/hard/hard_surfaces.hpp"
#include "datasets_gen/hard/hard_textures.hpp"

namespace treeline::bench {
namespace {

constexpr Limits trial_limits{.seconds = 120, .memory = 0};
constexpr double trial_seconds_an_element = 1e-4;  // for input so large that opening it takes its time

constexpr int exit_expected = 0, exit_failed = 1, exit_unusable = 2;

/// What a run found, over all its blocks.
struct Outcome {
  std::size_t cells = 0, failures = 0;
  std::vector<std::string> first_failures;
  std::vector<std::string> not_opened;  // hard cases of which there are no rows, and why
  void add(const std::vector<Row>& rows, bool must_answer) {
    cells += rows.size();
    for (const Row& row : rows)
      if (is_failure(row, must_answer) && ++failures <= most_named)
        first_failures.push_back(fmt::format("{} {} {}: {}: {}", row.block, row.query_set, row.method,
                                             to_string(row.status), row.reason));
  }
  static constexpr std::size_t most_named = 10;
};

class Program {
 public:
  Program(const Task& task, Options options)
      : task_(task), options_(std::move(options)), filter_(options_.benchmark.filter) {}

  int run();

 private:
  void run_stress();
  void run_blocks();
  int run_advice();
  void write_pictures();
  void list_cells();
  void show(const std::vector<Row>&, Progress&) const;
  void show_each_thread_count(const std::vector<Row>&, const std::vector<int>& thread_counts,
                              Progress&) const;
  std::unique_ptr<Block> open(BlockSpec&);
  BlockSpec in_rows(const BlockSpec&) const;
  Broken trial(const BlockSpec&, Progress&, const std::vector<std::string>& sets = {});
  std::vector<BlockSpec> blocks();
  int finish() const;

  const Task& task_;
  Options options_;
  Filter filter_;
  RowFile file_;
  std::optional<datasets::Dataset> input_;
  Outcome outcome_;
};

int Program::run() {
  if (options_.list) {
    fmt::print("{}", format_list(task_, options_));
    return exit_expected;
  }
  if (options_.benchmark.list_tests) return list_cells(), finish();
  if (!options_.pictures.empty()) {
    write_pictures();
    if (options_.rows.empty() && !options_.advise) return exit_expected;
  }
  if (!options_.rows.empty()) file_ = RowFile(options_.rows, options_.resume, task_.name());
  if (!file_.other_build().empty())
    fmt::print(stderr,
               "{}: warning: continues rows of another build of this program ({}): their times may not "
               "compare\n",
               options_.rows, file_.other_build());
  if (options_.advise) return run_advice();
  options_.stress ? run_stress() : run_blocks();
  return finish();
}

std::vector<BlockSpec> Program::blocks() {
  if (options_.input.empty()) return select_blocks(task_, options_);
  input_ = read_input(options_.input, task_.dataset_kind());
  input_->seed = options_.context.seed;  // of its queries: a file has none of its own
  for (const std::string& note : input_->notes) fmt::print(stderr, "{}: {}\n", options_.input, note);
  return {{input_->name, input_->size(), false}};
}

/// What the dataset or file cannot give is the caller's to change, hence a UsageError.
std::unique_ptr<Block> Program::open(BlockSpec& spec) {
  try {
    return input_ ? task_.open(*input_, options_.context) : task_.open(spec, options_.context);
  } catch (const std::exception& e) {
    throw UsageError(fmt::format("{}: {}", spec.label(), e.what()));
  }
}

/// As its rows and cells name it. Hard cases are opened without the task's own flags.
BlockSpec Program::in_rows(const BlockSpec& spec) const {
  if (spec.hard) return spec;
  return {named(spec.dataset, options_.context), spec.n, false, spec.scaling};
}

/// Recipes are known to crash nobody, but what a user's file does to a peer shows only there.
Broken Program::trial(const BlockSpec& spec, Progress& progress, const std::vector<std::string>& sets) {
  const bool needed = input_.has_value();
  if (!needed) return {};
  Limits limits = trial_limits;
  limits.seconds = std::max(limits.seconds, trial_seconds_an_element * static_cast<double>(spec.n));
  try {
    return try_peers(
        task_, spec, [&] { return task_.open(*input_, options_.context); },
        {filter_, file_, sets, options_.context.threads}, limits,
        [&](const std::string& at) { progress.step(0, "trying " + at); });
  } catch (const std::exception& e) {
    throw UsageError(fmt::format("{}: {}", spec.label(), e.what()));
  }
}

void Program::show(const std::vector<Row>& rows, Progress& progress) const {
  progress.clear();
  if (options_.quiet() || rows.empty()) return;
  fmt::print("{}", format_table(rows));
  std::fflush(stdout);
}

std::vector<double> weights_of(const std::vector<BlockSpec>& specs) {
  std::vector<double> out;
  // A cell takes about as long for any n; building and the truth grow with it.
  for (const BlockSpec& spec : specs) out.push_back(2e5 + static_cast<double>(spec.n));
  return out;
}

/// 1, 2, 4, … and all of this machine's threads.
std::vector<int> thread_counts() {
  const int there = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  std::vector<int> out;
  for (int t = 1; t < there; t *= 2) out.push_back(t);
  out.push_back(there);
  return out;
}

/// With --scaling at several thread counts.
void Program::run_blocks() {
  Timer timer(options_.context.profile, options_.benchmark);
  std::optional<SingleThreaded> alone(std::in_place);  // until peers have been tried in children
  auto specs = blocks();
  Harness harness(task_, options_, filter_, file_, timer);
  Progress progress(weights_of(specs));
  const std::vector<int> counts = options_.scaling ? thread_counts() : std::vector<int>{};
  for (std::size_t k = 0; k < specs.size(); ++k) {
    progress.block(k, specs[k].label());
    const Broken broken = trial(in_rows(specs[k]), progress);
    alone.reset();
    progress.step(0, "making the queries");
    const auto block = open(specs[k]);
    const auto rows =
        harness.run(facts_of(task_, in_rows(specs[k]), *block), *block, progress, {}, broken, counts);
    // A recipe is input that can be answered; a user's file may rightly be refused.
    outcome_.add(rows, !input_);
    counts.empty() ? show(rows, progress) : show_each_thread_count(rows, counts, progress);
  }
}

/// A table each: it has no column for them.
void Program::show_each_thread_count(const std::vector<Row>& rows, const std::vector<int>& thread_counts,
                                     Progress& progress) const {
  progress.clear();
  for (const int threads : thread_counts) {
    std::vector<Row> mine = rows;
    std::erase_if(mine, [&](const Row& row) { return row.threads != threads; });
    if (!options_.quiet()) fmt::print("\n--threads {}", threads);
    show(mine, progress);
  }
}

void Program::run_stress() {
  const SingleThreaded alone;
  std::map<std::string, datasets::Expect> expect;
  for (const datasets::HardCase& hard : datasets::hard_cases()) expect[hard.name] = hard.expect;
  for (const datasets::HardRows& hard : datasets::hard_rows()) expect[hard.name] = hard.expect;
  for (const datasets::HardInside& hard : datasets::hard_insides()) expect[hard.name] = hard.expect;
  for (const datasets::HardTexture& hard : datasets::hard_textures()) expect[hard.name] = hard.expect;
  for (const datasets::HardLight& hard : datasets::hard_lights()) expect[hard.name] = hard.expect;
  for (const datasets::HardSurface& hard : datasets::hard_surfaces()) expect[hard.name] = hard.expect;
  const auto specs = blocks();
  Stress stress(task_, options_, filter_, file_);
  Progress progress(std::vector<double>(specs.size(), 1));
  for (std::size_t k = 0; k < specs.size(); ++k) {
    progress.block(k, specs[k].label());
    std::vector<Row> rows;
    try {
      rows = stress.run(specs[k], progress);
    } catch (const NotOpened& e) {  // the other cases still tell something
      outcome_.not_opened.push_back(e.what());
      continue;
    }
    const auto found = expect.find(specs[k].dataset);
    outcome_.add(rows, found == expect.end() || found->second == datasets::Expect::answers);
    show(rows, progress);
  }
}

std::string shell_word(const std::string& argument) {
  if (argument.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./:=,") ==
      std::string::npos)
    return argument;
  std::string out = "'";
  for (char c : argument) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

int Program::run_advice() {
  Timer timer(options_.context.profile, options_.benchmark);
  std::optional<SingleThreaded> alone(std::in_place);  // until peers have been tried in children
  auto specs = blocks();
  Harness harness(task_, options_, filter_, file_, timer);
  Progress progress(weights_of(specs));
  const std::vector<std::string> sets = task_.advise_on();
  bool all_met = true;  // by one method, or each query set by one of its own
  for (std::size_t k = 0; k < specs.size(); ++k) {
    progress.block(k, specs[k].label());
    const Broken broken = trial(in_rows(specs[k]), progress, sets);
    alone.reset();
    progress.step(0, "making the queries");
    const auto block = open(specs[k]);
    const auto rows = harness.run(facts_of(task_, in_rows(specs[k]), *block), *block, progress, sets, broken);
    outcome_.add(rows, false);
    progress.clear();
    const Advice advice = advise(task_, rows, sets, *options_.advise);
    all_met = all_met && answers(advice, sets.size());
    const std::string input =
        input_ ? "--input " + shell_word(options_.input) : "--dataset " + specs[k].label();
    std::string own;
    if (options_.context.profile != Profile::quick)
      own += options_.context.profile == Profile::smoke ? " --profile smoke" : " --profile full";
    for (const auto& [flag, value] : options_.context.own) own += " " + flag + " " + shell_word(value);
    const std::string again = fmt::format("{} {}{} --seed {} --threads {} --benchmark_filter='%FILTER%'",
                                          shell_word(options_.program), input, own, options_.context.seed,
                                          options_.context.threads);
    fmt::print(options_.quiet() ? stderr : stdout, "{}",
               format_advice(advice, *options_.advise, again) +
                   (input_ ? format_rounding(*input_, block->in_double()) : "") + format_busy(rows));
  }
  const int ended = finish();
  return all_met ? ended : exit_failed;
}

/// One block a dataset is enough for pictures: its smallest that has something to show.
void Program::write_pictures() {
  constexpr std::size_t telling_n = 10'000;
  std::map<std::string, BlockSpec> smallest;
  for (const BlockSpec& spec : blocks()) {
    const auto [at, is_new] = smallest.try_emplace(spec.dataset, spec);
    const auto rank = [](std::size_t n) { return std::pair(n < telling_n, n); };
    if (!is_new && rank(spec.n) < rank(at->second.n)) at->second = spec;
  }
  std::error_code error;
  std::filesystem::create_directories(options_.pictures, error);
  if (error) throw UsageError(fmt::format("--pictures {}: {}", options_.pictures, error.message()));
  for (const auto& [name, spec] : smallest) {
    fmt::print(stderr, "pictures of {}\n", spec.label());
    task_.pictures(spec, options_.context, options_.pictures);
  }
}

void Program::list_cells() {
  for (BlockSpec& spec : blocks()) {
    const auto block = open(spec);
    for (const Cell& cell : cells_of(task_, facts_of(task_, in_rows(spec), *block), options_.context.threads))
      if (filter_.matches(cell.name)) fmt::print("{}\n", cell.name), ++outcome_.cells;
  }
}

int Program::finish() const {
  for (const std::string& why : outcome_.not_opened) fmt::print(stderr, "{}\n", why);
  if (outcome_.cells == 0 && outcome_.not_opened.empty())
    throw NothingMatched(
        fmt::format("--benchmark_filter={} matches no cell; --benchmark_list_tests prints them",
                    options_.benchmark.filter));
  if (outcome_.failures == 0) return outcome_.not_opened.empty() ? exit_expected : exit_failed;
  fmt::print(stderr, "{} of {} cells are failures of ours\n", outcome_.failures, outcome_.cells);
  for (const std::string& failure : outcome_.first_failures) fmt::print(stderr, "  {}\n", failure);
  if (outcome_.failures > Outcome::most_named) fmt::print(stderr, "  …\n");
  return exit_failed;
}

}  // namespace

int run_program(const Task& task, int argc, char** argv) {
  const std::string name = "bench_" + task.name();
  try {
    auto parsed = parse_command_line(task.name(), argc, argv, task.flags());
    if (const int* status = std::get_if<int>(&parsed)) return *status;
    try {
      task.check_flags(std::get<Options>(parsed).context);
    } catch (const std::exception& e) {
      throw UsageError(e.what());
    }
    return Program(task, std::move(std::get<Options>(parsed))).run();
  } catch (const UsageError& e) {
    fmt::print(stderr, "{}: {}\n", name, e.what());
    return exit_unusable;
  } catch (const NothingMatched& e) {
    fmt::print(stderr, "{}: {}\n", name, e.what());
    return exit_failed;
  } catch (const std::exception& e) {
    fmt::print(stderr, "{}: {}\n", name, e.what());
    return exit_failed;
  }
}

}  // namespace treeline::bench
