#include "bench/knn_dynamic/block.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

#include "bench/core/all_threads.hpp"
#include "bench/core/refusal.hpp"
#include "bench/knn/metric.hpp"
#include "bench/knn_dynamic/life.hpp"

namespace treeline::bench::knn_dynamic {
namespace {

constexpr std::size_t neighbours = 8;
constexpr std::size_t judged_queries = 200;  // of a set
constexpr std::size_t judged_moments = 4;    // of a life in which questions are asked
constexpr std::size_t asked_after = 2000;    // queries of the set knn8_after

// Where a life stops for queries alone: 7 eighths through it and a bit, so that a forest is not at a moment
// at which it happens to be one tree.
std::size_t stop_of(const Life& life) { return life.steps.size() * 7 / 8 - life.steps.size() / 64; }

/// One way to live and what is asked.
struct Set {
  enum class Asks { nothing, newcomers, afterwards };
  std::string name;
  std::size_t batch = 1;
  Asks asks = Asks::nothing;
  Life life;
};

struct Opening {
  std::vector<Vec3f> pool;
  std::uint64_t seed = 0, hash = 0;
  std::size_t k = neighbours;
  std::vector<Vec3f> queries;  // asked afterwards
  std::vector<Set> sets;
  int truth_threads = 1;
  bool must_answer = false, quick = false;
};

class DynamicSubject final : public Subject {
 public:
  DynamicSubject(const Opening& opening, const Method& method, const Knobs& knobs, int threads)
      : opening_(opening), method_(method), knobs_(knobs), threads_(threads) {
    // What its builds are timed and weighed by: half the pool at once.
    keep_refusal(opening_.must_answer, refusal_, [&] {
      at_once_ = made();
      at_once_->change({}, 0, static_cast<Id>(opening_.pool.size() - opening_.pool.size() / 2));
    });
  }

  void run(std::size_t number, const Knobs&, int threads) override {
    const Set& set = opening_.sets[number];
    if (set.asks == Set::Asks::nothing && !method_.keeps && !opening_.must_answer)
      throw Unsupported("keeps no index: a change alone costs it nothing that compares");
    if (set.batch == 1 && !method_.by_the_piece && !opening_.must_answer)
      throw Unsupported("a build of everything for each point that comes is not waited for");
    if (!refusal_.empty() && !at_once_) return;
    refusal_.clear();
    keep_refusal(opening_.must_answer, refusal_, [&] {
      if (set.asks != Set::Asks::afterwards) return live(set, set.life.steps.size(), threads);
      if (lived_ != number || !index_) live(set, stop_of(set.life), threads);
      lived_ = number;
      ids_.assign(opening_.queries.size() * opening_.k, accel::no_id);
      index_->nearest(opening_.queries, opening_.k, threads, ids_);
    });
  }

  /// The index as the latest run left it; null where it refused.
  const Index* index() const { return refusal_.empty() ? index_.get() : nullptr; }
  const std::vector<Id>& ids() const { return ids_; }
  const std::string& refusal() const { return refusal_; }

 private:
  std::unique_ptr<Index> made() const { return method_.make({opening_.pool, threads_}, knobs_); }

  void live(const Set& set, std::size_t steps, int threads) {
    lived_ = nothing;
    index_ = made();
    const std::span<const Vec3f> pool = opening_.pool;
    if (set.asks == Set::Asks::newcomers) ids_.assign(pool.size() * opening_.k, accel::no_id);
    for (std::size_t s = 0; s < steps; ++s) {
      const auto [end, first, last] = set.life.steps[s];
      index_->change(set.life.gone_in(s), first, last);
      if (set.asks == Set::Asks::newcomers)
        index_->nearest(pool.subspan(first, last - first), opening_.k, threads,
                        std::span(ids_).subspan(first * opening_.k, (last - first) * opening_.k));
    }
  }

  static constexpr std::size_t nothing = SIZE_MAX;
  const Opening& opening_;
  const Method& method_;
  const Knobs knobs_;
  int threads_;
  std::unique_ptr<Index> at_once_, index_;
  std::size_t lived_ = nothing;  // the set whose life `index_` has stopped in
  std::vector<Id> ids_;
  std::string refusal_;
};

/// The questions of a set that are judged, each at its moment. A moment has a copy of the pool of its own, in
/// which whatever is not there is not a number: its id is no valid answer then.
struct Judged {
  struct Query {
    std::size_t moment;
    std::size_t row;  // of the subject's ids
  };
  std::vector<Vec3f> points;
  std::vector<Query> queries;
  std::vector<Vec3f> at;
  knn::NearestTruth truth;
};

class DynamicBlock final : public Block {
 public:
  DynamicBlock(const std::vector<Method>& methods, Opening opening)
      : methods_(methods), opening_(std::move(opening)) {
    for (const Set& s : opening_.sets) sets_.push_back({s.name, operations(s)});
    judged_.resize(sets_.size());
  }

  const std::vector<QuerySet>& query_sets() const override { return sets_; }
  std::size_t n() const override { return opening_.pool.size() - opening_.pool.size() / 2; }
  std::uint64_t seed() const override { return opening_.seed; }
  std::uint64_t dataset_hash() const override { return opening_.hash; }
  /// Of what a build is weighed by: the half of the pool that is there.
  std::optional<std::size_t> input_bytes() const override { return n() * sizeof(Vec3f); }
  bool quick() const override { return opening_.quick; }

  std::unique_ptr<Subject> build(std::size_t m, const Knobs& knobs, int threads) override {
    return std::make_unique<DynamicSubject>(opening_, methods_[m], knobs, threads);
  }

  Errors check(std::size_t m, const Subject& subject, std::size_t number, const Knobs&) override {
    const auto& answers = dynamic_cast<const DynamicSubject&>(subject);
    if (!answers.index()) return refused_wrongly(answers.refusal());
    const Set& set = opening_.sets[number];
    const Judged& judged = judged_of(number);
    const std::size_t k = opening_.k;
    std::vector<Id> told;  // where nothing was asked, asked now
    std::span<const Id> all = answers.ids();
    if (set.asks == Set::Asks::nothing) {
      told.assign(judged.at.size() * k, accel::no_id);
      answers.index()->nearest(judged.at, k, 1, told);
      all = told;
    }
    std::vector<Id> ids;
    for (std::size_t q = 0; q < judged.queries.size(); ++q)
      for (const Id id : all.subspan(judged.queries[q].row * k, k))
        ids.push_back(id < opening_.pool.size()
                          ? static_cast<Id>(judged.queries[q].moment * opening_.pool.size() + id)
                          : id);
    const Errors found =
        knn::nearest_errors(judged.points, judged.at, k, ids, judged.truth, methods_[m].info.claim);
    Errors e = found;
    e.extra = Knobs::object();
    for (const auto& [name, value] : found.extra.items())
      e.extra["knn_dynamic" + name.substr(name.find('_'))] = value;
    e.extra["knn_dynamic_trees"] = answers.index()->trees();
    e.extra["knn_dynamic_batch"] =
        set.asks == Set::Asks::afterwards ? Knobs(nullptr) : Knobs(std::min(set.batch, n()));
    return e;
  }

 private:
  std::size_t operations(const Set& set) const {
    switch (set.asks) {
      case Set::Asks::nothing:
        return set.life.changes();
      case Set::Asks::newcomers:
        return set.life.changes() + opening_.pool.size();
      case Set::Asks::afterwards:
        return opening_.queries.size();
    }
    return 0;
  }

  const Judged& judged_of(std::size_t number) {
    std::optional<Judged>& judged = judged_[number];
    if (!judged) judged = judge(opening_.sets[number]);
    return *judged;
  }

  Judged judge(const Set& set) const {
    Judged j;
    const std::size_t steps = set.life.steps.size();
    if (set.asks == Set::Asks::nothing) {
      add_moment(j, set, steps, opening_.queries, 0);
    } else if (set.asks == Set::Asks::afterwards) {
      add_moment(j, set, stop_of(set.life), opening_.queries, 0);
    } else {
      for (std::size_t i = 1; i <= judged_moments; ++i) {
        const std::size_t after = steps * i / judged_moments;
        if (after == 0) continue;
        const auto [end, first, last] = set.life.steps[after - 1];
        add_moment(j, set, after, std::span<const Vec3f>(opening_.pool).subspan(first, last - first), first);
      }
    }
    return j;
  }

  /// queries[i] is answered in row first_row + i of the subject's ids; where nothing was asked, the judged
  /// queries are all there is.
  void add_moment(Judged& j, const Set& set, std::size_t steps, std::span<const Vec3f> queries,
                  std::size_t first_row) const {
    const std::size_t moment = j.points.size() / std::max<std::size_t>(opening_.pool.size(), 1);
    const std::vector<bool> there = set.life.there(steps, opening_.pool.size());
    std::vector<Vec3f> masked = opening_.pool;
    for (std::size_t i = 0; i < masked.size(); ++i)
      if (!there[i]) masked[i] = Vec3f::filled(std::numeric_limits<float>::quiet_NaN());
    const knn::DoubleScan scan(masked);
    const std::size_t most =
        set.asks == Set::Asks::newcomers ? judged_queries / judged_moments : judged_queries;
    std::vector<Vec3f> at;
    for (const std::uint32_t i : knn::spread_sample(queries.size(), most)) {
      at.push_back(queries[i]);
      j.queries.push_back({moment, set.asks == Set::Asks::nothing ? at.size() - 1 : first_row + i});
    }
    std::vector<std::uint32_t> all(at.size());
    std::iota(all.begin(), all.end(), 0u);
    const auto truth = knn::nearest_truth(scan, at, opening_.k, std::move(all), opening_.truth_threads);
    j.truth.k = truth.k;  // the same at every moment: more than k are there from the first on
    for (const std::uint32_t i : truth.sample)
      j.truth.sample.push_back(static_cast<std::uint32_t>(j.at.size()) + i);
    j.truth.answerable.insert(j.truth.answerable.end(), truth.answerable.begin(), truth.answerable.end());
    j.truth.distances.insert(j.truth.distances.end(), truth.distances.begin(), truth.distances.end());
    j.at.insert(j.at.end(), at.begin(), at.end());
    j.points.insert(j.points.end(), masked.begin(), masked.end());
  }

  const std::vector<Method>& methods_;
  const Opening opening_;
  std::vector<QuerySet> sets_;
  std::vector<std::optional<Judged>> judged_;
};

}  // namespace

std::unique_ptr<Block> open_block(const std::vector<Method>& methods, datasets::Dataset dataset,
                                  const RunContext& context) {
  using Asks = Set::Asks;
  Opening o;
  o.seed = dataset.seed, o.hash = dataset.hash();
  o.pool = std::move(dataset.cloud.points);
  const std::size_t pool = o.pool.size(), n = pool - pool / 2;
  if (n < 4 * judged_moments * neighbours)
    throw std::invalid_argument("has " + std::to_string(pool) + (pool == 1 ? " point" : " points") +
                                ", too few to come and go in batches");
  for (std::size_t i = 0; i < pool; ++i)
    if (!geometry::is_finite(o.pool[i]))
      throw std::invalid_argument("point " + std::to_string(i) + " has a coordinate that is not finite");
  o.truth_threads = all_threads();
  o.quick = context.profile == Profile::quick;
  const auto add = [&](const char* name, std::size_t batches, Goes goes, Asks asks) {
    const std::size_t batch = std::max<std::size_t>(1, batches == 0 ? 1 : n / batches);
    o.sets.push_back({name, batch, asks, life_of(pool, batch, goes, context.seed)});
  };
  add("single", 0, Goes::oldest, Asks::nothing);
  add("batches128", 128, Goes::oldest, Asks::nothing);
  add("batches16", 16, Goes::oldest, Asks::nothing);
  add("batches4", 4, Goes::oldest, Asks::nothing);
  add("random16", 16, Goes::random, Asks::nothing);
  add("asked16", 16, Goes::oldest, Asks::newcomers);
  add("knn8_after", 128, Goes::oldest, Asks::afterwards);
  // Asked are points that are there at the moments at which this is asked: the last batches.
  const std::size_t last_half = pool - n / 2;
  for (const std::uint32_t i : knn::spread_sample(n / 4, asked_after))
    o.queries.push_back(o.pool[last_half - n / 4 + i]);
  return std::make_unique<DynamicBlock>(methods, std::move(o));
}

std::unique_ptr<Block> open_hard_block(const std::vector<Method>& methods, datasets::HardCase hard_case,
                                       const RunContext& context) {
  datasets::Dataset dataset;
  dataset.cloud = std::move(hard_case.cloud);
  Opening o;
  o.seed = context.seed, o.hash = dataset.hash();
  o.pool = std::move(dataset.cloud.points);
  o.k = hard_case.k;
  o.queries = std::move(hard_case.queries);
  o.must_answer = true;
  const std::size_t batch = std::max<std::size_t>(1, o.pool.size() / 8);
  o.sets.push_back(
      {"batches4", batch, Set::Asks::nothing, life_of(o.pool.size(), batch, Goes::oldest, context.seed)});
  return std::make_unique<DynamicBlock>(methods, std::move(o));
}

}  // namespace treeline::bench::knn_dynamic
