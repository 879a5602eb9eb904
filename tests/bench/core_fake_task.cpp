#include "core_fake_task.hpp"

#include <signal.h>
#include <tbb/parallel_for.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <new>
#include <thread>

#include "bench/core/isolation.hpp"
#include "datasets_gen/hard/hard_case.hpp"

namespace treeline::bench {
namespace {

using Answers = std::vector<double>;

// What a method costs and answers; `offset` is its error.
struct Behaviour {
  const char* name;
  Source source;
  Claim claim;
  double offset;     // error of every answer
  int microseconds;  // per batch
  int ladder = 0;
};
constexpr Behaviour calm[] = {
    {"exact", Source::ours, Claim::exact, 0, 40000},
    {"close", Source::peer, Claim::bounded, 1e-3, 8000},
    {"rough", Source::peer, Claim::approximate, 0.1, 200},
    {"wrong", Source::peer, Claim::exact, 0.5, 50},
    {"refuses", Source::peer, Claim::exact, 0, 50},
    {"unable", Source::peer, Claim::exact, 0, 50},
    {"small_only", Source::peer, Claim::exact, 0, 50},
    {"greedy", Source::peer, Claim::exact, 0, 50},
};
// Only among the hard cases, where they cannot take the program with them.
constexpr Behaviour wild[] = {
    {"segfault", Source::peer, Claim::exact, 0, 50},
    {"segfault_build", Source::peer, Claim::exact, 0, 50},
    {"segfault_late", Source::peer, Claim::exact, 0, 50},
    {"aborts", Source::peer, Claim::exact, 0, 50},
    {"hangs", Source::peer, Claim::exact, 0, 50},
    {"devours", Source::peer, Claim::exact, 0, 50},
    {"exits", Source::peer, Claim::exact, 0, 50},
};

constexpr std::size_t bytes_per_element = 64;  // that a build keeps, for the count of bytes

bool in_stress() { return std::getenv("FAKE_WILD") != nullptr; }

void segfault() { raise(SIGSEGV); }

const pid_t first_process = getpid();

/// As much as brings TBB's workers; tells how many threads that makes of one, whatever
/// libraries started before main.
void work_in_threads() {
  if (!std::getenv("FAKE_THREADS")) return;
  const int before = thread_count();
  tbb::parallel_for(0, 64, [](int) { std::this_thread::sleep_for(std::chrono::milliseconds(1)); });
  std::fprintf(stderr, "threads: %d\n", 1 + thread_count() - before);
}

[[gnu::noinline]] void devour() {
  std::vector<std::unique_ptr<char[]>> all;
  for (;;) {
    all.push_back(std::make_unique<char[]>(64 << 20));
    std::fill_n(all.back().get(), 64 << 20, 'x');
  }
}

class FakeSubject : public Subject {
 public:
  FakeSubject(const Behaviour& b, std::size_t n, double scale)
      : behaviour_(b), name_(b.name), scale_(scale), kept_(n * bytes_per_element), answers_(n) {}

  void run(std::size_t set, const Knobs& knobs, int) override {
    if (name_ == "unable" && set == 1) throw Unsupported("knows only forward");
    if (name_ == "greedy") throw std::bad_alloc();
    if (name_ == "segfault" && set == 1) segfault();
    if (name_ == "segfault_late" && knobs.contains("late")) segfault();
    if (name_ == "aborts") std::fputs("the wolf is at the door\n", stderr), std::abort();
    if (name_ == "hangs")
      for (;;) pause();
    if (name_ == "devours") devour();
    if (name_ == "exits") std::exit(0);
    const double slower = knobs.value("slower", 1.0);
    const auto until = std::chrono::steady_clock::now() +
                       std::chrono::microseconds(static_cast<long>(behaviour_.microseconds * slower));
    for (std::size_t i = 0; i < answers_.size(); ++i)
      answers_[set == 0 ? i : answers_.size() - 1 - i] =
          2.0 * static_cast<double>(i) + behaviour_.offset * scale_ / slower;
    while (std::chrono::steady_clock::now() < until) {
    }
  }
  std::optional<std::pair<double, double>> work(std::size_t, const Knobs&) override {
    if (name_ != "exact") return std::nullopt;
    return std::pair{3.0, 5.0};
  }
  const Answers& answers() const { return answers_; }

 private:
  const Behaviour& behaviour_;
  std::string name_;
  double scale_;
  std::vector<char> kept_;
  Answers answers_;
};

class FakeBlock : public Block {
 public:
  FakeBlock(const FakeTask& task, std::size_t n, std::uint64_t seed, bool ours_refuse)
      : task_(task), n_(n), seed_(seed), ours_refuse_(ours_refuse), sets_{{"forward", n}, {"backward", n}} {}

  const std::vector<QuerySet>& query_sets() const override { return sets_; }
  std::unique_ptr<Subject> build(std::size_t m, const Knobs& knobs, int) override {
    const std::string& name = task_.methods()[m].name;
    if (const char* log = std::getenv("FAKE_LOG")) std::ofstream(log, std::ios::app) << name << "\n";
    if (const char* ms = std::getenv("FAKE_SLOW_MS"))
      std::this_thread::sleep_for(std::chrono::milliseconds(std::atoi(ms)));
    if (name == "refuses") throw std::invalid_argument("point 3 is not finite");
    if (name == "exact" && ours_refuse_) throw std::invalid_argument("ours refuses, too");
    if (name == "segfault_build") segfault();
    for (const Behaviour& b : calm)
      if (name == b.name) return std::make_unique<FakeSubject>(b, n_, knobs.value("scale", 1.0));
    for (const Behaviour& b : wild)
      if (name == b.name) return std::make_unique<FakeSubject>(b, n_, 1.0);
    throw std::logic_error("no method " + name);
  }
  Errors check(std::size_t m, const Subject& subject, std::size_t set, const Knobs&) override {
    const Answers& answers = static_cast<const FakeSubject&>(subject).answers();
    Errors e;
    double sum = 0, worst = 0;
    for (std::size_t i = 0; i < n_; ++i) {
      const double truth = 2.0 * static_cast<double>(set == 0 ? i : n_ - 1 - i);
      worst = std::max(worst, std::abs(answers[i] - truth)), sum += std::abs(answers[i] - truth);
    }
    e.max = worst, e.error = e.mean = n_ ? sum / static_cast<double>(n_) : 0;
    e.floor = 1e-9;
    e.bias = std::nan("");  // must come out as null
    e.extra["fake_answers"] = answers.size();
    e.within_claim = task_.methods()[m].claim != Claim::exact || worst == 0;
    if (!e.within_claim) e.reason = "query 0 is off by " + std::to_string(worst);
    return e;
  }
  std::size_t n() const override { return n_; }
  std::uint64_t seed() const override { return seed_; }
  std::uint64_t dataset_hash() const override { return 0x1234 + n_ + seed_; }

 private:
  const FakeTask& task_;
  std::size_t n_;
  std::uint64_t seed_;
  bool ours_refuse_;
  std::vector<QuerySet> sets_;
};

std::string case_with(datasets::Expect expect) {
  for (const datasets::HardCase& hard : datasets::hard_cases())
    if (hard.expect == expect) return hard.name;
  return "";
}

}  // namespace

FakeTask::FakeTask() {
  const auto add = [&](const Behaviour& b) {
    MethodInfo info;
    info.name = b.name, info.family = "brute", info.source = b.source, info.claim = b.claim;
    if (b.source == Source::peer) info.peer_version = "1.0";
    if (info.name == "exact" && std::getenv("FAKE_OURS_WRONG"))
      info.name = "wrong", info.source = Source::ours;
    if (info.name == "close") info.build_knobs = {{{"scale", 1.0}}, {{"scale", 2.0}}};
    if (info.name == "rough") info.query_knobs = {Knobs::object(), {{"slower", 10.0}}};
    if (info.name == "segfault_late") info.query_knobs = {Knobs::object(), {{"late", true}}};
    if (info.name == "small_only") info.largest_n = 500;
    if (info.name == "rough") info.scales = false;
    if (info.name == "close" && in_stress()) info.sweep_up_to_n = 40, info.stress_builds = {0, 1};
    methods_.push_back(info);
  };
  for (const Behaviour& b : calm) {
    if (std::getenv("FAKE_OURS_WRONG") && std::string_view(b.name) == "wrong") continue;
    add(b);
  }
  if (in_stress())
    for (const Behaviour& b : wild) add(b);
}

std::vector<std::pair<std::string, std::string>> FakeTask::not_built() const {
  return {{"absent", "LibAbsent"}};
}

std::vector<BlockSpec> FakeTask::blocks(Profile profile) const {
  if (profile == Profile::smoke) return {{"counting", 100, false}};
  return {{"counting", 1000, false}, {"squares", 400, false}};
}

std::vector<BlockSpec> FakeTask::hard_blocks() const {
  return {{case_with(datasets::Expect::answers), 0, true},
          {case_with(datasets::Expect::answers_or_refuses), 0, true}};
}

std::vector<BlockSpec> FakeTask::scaling_blocks(Profile) const { return {{"counting", 100}}; }

std::unique_ptr<Block> FakeTask::open(const BlockSpec& spec, const RunContext& context) const {
  if (std::getenv("FAKE_UNOPENED") && spec.dataset == hard_blocks().front().dataset)
    throw std::runtime_error("no way in");
  if (getpid() == first_process) work_in_threads();
  return std::make_unique<FakeBlock>(*this, spec.hard ? 50 : spec.n, context.seed,
                                     spec.hard && std::getenv("FAKE_OURS_REFUSE"));
}

std::unique_ptr<Block> FakeTask::open(datasets::Dataset data, const RunContext& context) const {
  return std::make_unique<FakeBlock>(*this, data.size(), context.seed, false);
}

void FakeTask::pictures(const BlockSpec& spec, const RunContext&, const std::string& folder) const {
  std::ofstream(folder + "/" + spec.dataset + ".txt") << spec.n;
}

}  // namespace treeline::bench
