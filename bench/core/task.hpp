// What a task tells the harness. The harness (harness.hpp) owns everything else: the command line, timing,
// rows, resume, isolation, statuses, advice.
//
// A task offers blocks; a block holds one dataset with its query sets and its truth; a method builds a
// subject over the block; the harness times subject.run() and then asks block.check() how far its answers are
// off.
#pragma once

#include <algorithm>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "bench/core/row.hpp"
#include "datasets_gen/dataset.hpp"

namespace treeline::bench {

enum class Profile { smoke, quick, full };

/// One built index (or none, for brute force) with the answers to the last query set it ran.
class Subject {
 public:
  virtual ~Subject() = default;
  /// Brings the subject into the state that the query set is asked in, where that is not how it was built.
  /// Called before the first run() of each query set; not timed. Throws as run() does.
  virtual void prepare(std::size_t query_set, int threads) { (void)query_set, (void)threads; }
  /// Answers the whole query set; the only timed part of a query. Answers stay in buffers of the subject.
  /// Throws Unsupported where the method has no such query, any other std::exception to refuse.
  virtual void run(std::size_t query_set, const Knobs& query_knobs, int threads) = 0;
  /// Nodes and primitives touched per query, if the method can count them. Not timed.
  virtual std::optional<std::pair<double, double>> work(std::size_t query_set, const Knobs& query_knobs) {
    (void)query_set, (void)query_knobs;
    return std::nullopt;
  }
};

struct Unsupported : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// One way to answer a task; what it is, and every combination of knobs to sweep.
struct MethodInfo {
  std::string name;    // unique in the task, e.g. "bvh", "nanoflann"
  std::string family;  // brute, kd, bsp, bvh, octree, forest
  Source source = Source::ours;
  Claim claim = Claim::exact;
  std::string peer_version{};  // empty: null
  std::vector<Knobs> build_knobs{Knobs::object()};
  std::vector<Knobs> query_knobs{Knobs::object()};  // swept on one build
  std::vector<std::size_t> stress_builds{0};        // which of build_knobs face the hard cases
  int ladder = 0;              // order from the least model to the richest, for advice at equal cost
  bool keeps_no_copy = false;  // refers to the caller's data, which must stay as long as it does
  std::size_t sweep_up_to_n = SIZE_MAX;    // above, only the first of build_knobs
  std::size_t quick_builds = SIZE_MAX;     // so many of build_knobs, the best first, in the quick profile
  std::size_t largest_n = SIZE_MAX;        // not run above (brute force); the row says `unsupported`
  std::size_t quick_largest_n = SIZE_MAX;  // the same where time is short
  bool scales = true;                      // measured at several thread counts, too
  bool hard_cases_only = false;            // an experiment on some of them: nothing to offer anywhere else

  std::size_t largest(bool quick) const { return quick ? std::min(largest_n, quick_largest_n) : largest_n; }
};

struct QuerySet {
  std::string name;  // e.g. "knn8_self"
  std::size_t size = 0;
};

class Block {
 public:
  virtual ~Block() = default;
  virtual const std::vector<QuerySet>& query_sets() const = 0;
  /// Makes what the method's library sets up once a process (devices, thread pools, caches): neither timed
  /// nor counted, so that the first build costs what every other one does. Called before build().
  virtual void warm_up(std::size_t m, int threads) { (void)m, (void)threads; }
  /// Builds method number m (an index into Task::methods()); timed and its allocations counted by the
  /// harness. Throws to refuse the input.
  virtual std::unique_ptr<Subject> build(std::size_t m, const Knobs& build_knobs, int threads) = 0;
  /// Error of the answers that the subject holds for this query set, against truth in double. Not timed.
  virtual Errors check(std::size_t m, const Subject& subject, std::size_t query_set,
                       const Knobs& query_knobs) = 0;
  virtual std::size_t n() const = 0;
  virtual std::uint64_t seed() const = 0;
  virtual std::uint64_t dataset_hash() const = 0;
  /// Bytes of the caller's data, which a method that keeps no copy needs beside its own; nothing if that has
  /// not been looked into here.
  virtual std::optional<std::size_t> input_bytes() const { return std::nullopt; }
  /// Whether the method has anything to say to this dataset; if not it has no cells here.
  virtual bool offers(std::size_t method) const { return static_cast<void>(method), true; }
  /// Whether queries and truth are about the dataset's doubles, not about what float makes of them.
  virtual bool in_double() const { return false; }
  /// Whether time is short: then only MethodInfo::quick_builds of each method are measured.
  virtual bool quick() const { return false; }
};

struct BlockSpec {
  std::string dataset;  // recipe, or hard case
  std::size_t n = 0;    // 0: as the file or the hard case has it
  bool hard = false;
  bool scaling = false;  // measured at several thread counts
  std::string label() const { return hard ? "hard/" + dataset : dataset + ":" + std::to_string(n); }
};

struct RunContext {
  Profile profile = Profile::quick;
  std::uint64_t seed = 1;
  int threads = 1;
  std::string truth_cache;                   // folder for cached truths; empty: no cache
  std::map<std::string, std::string> own{};  // values of the task's own flags (Task::flags) that were given
};

/// A flag that only one task has; it takes a value, and the task makes sense of it.
struct TaskFlag {
  std::string name;  // with its dashes, e.g. "--light"
  std::string help;
};

class Task {
 public:
  virtual ~Task() = default;
  virtual std::string name() const = 0;
  /// Raised when queries, truth or errors change meaning; part of the truth cache's key.
  virtual int version() const = 0;
  virtual const std::vector<MethodInfo>& methods() const = 0;
  /// Peers that this build lacks: method name and the package it needs. They get `not_built` rows.
  virtual std::vector<std::pair<std::string, std::string>> not_built() const = 0;
  virtual std::vector<BlockSpec> blocks(Profile) const = 0;
  virtual std::vector<BlockSpec> hard_blocks() const = 0;
  /// What --scaling measures at 1, 2, 4, … threads: enough queries to share out. Names of query sets end in
  /// "_threads", so that nothing takes them for those of an ordinary block.
  virtual std::vector<BlockSpec> scaling_blocks(Profile) const { return {}; }
  /// What it understands on the command line beyond what all tasks do.
  virtual std::vector<TaskFlag> flags() const { return {}; }
  /// Throws with the reason if it cannot use the values of its own flags; asked before anything is done.
  virtual void check_flags(const RunContext&) const {}
  /// The recipes that --dataset accepts.
  virtual datasets::Kind dataset_kind() const = 0;
  virtual std::unique_ptr<Block> open(const BlockSpec&, const RunContext&) const = 0;
  /// A block over the user's own file.
  virtual std::unique_ptr<Block> open(datasets::Dataset, const RunContext&) const = 0;
  /// Query sets on which --advise measures (names); every rung must meet the tolerance on each. Rows of these
  /// say so (Row::advised), and the report's advice asks about the same.
  virtual std::vector<std::string> advise_on() const = 0;
  /// Writes pictures of one block (slices through trees, renderings with wrong pixels marked) and an
  /// index of them, pictures.jsonl, into a folder: one object a line with file, title, dataset, method, kind.
  virtual void pictures(const BlockSpec&, const RunContext&, const std::string& folder) const = 0;
};

/// Runs a whole benchmark program; returns its exit status (0 as expected, 1 ours failed or nothing matched,
/// 2 unusable arguments or input).
int run_program(const Task& task, int argc, char** argv);

}  // namespace treeline::bench
