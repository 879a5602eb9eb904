#include "bench/knn/block.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <type_traits>

#include "bench/core/all_threads.hpp"
#include "bench/core/refusal.hpp"
#include "bench/core/truth_cache.hpp"
#include "bench/knn/metric.hpp"
#include "bench/knn/questions.hpp"
#include "geometry/random.hpp"

namespace treeline::bench::knn {
namespace {

using Kind = QuestionKinds::Kind;

// An index with its latest answers. Where refusing is not allowed, a refusal is kept and judged like an
// answer.
template <class T>
class KnnSubject final : public Subject {
 public:
  KnnSubject(const QuestionsOf<T>& questions, bool keep_refusals)
      : questions_(questions), keep_refusals_(keep_refusals) {}

  template <class Build>
  void build(Build make) {
    keep_refusal(keep_refusals_, refusal_, [&] { index_ = make(); });
  }

  void run(std::size_t query_set, const Knobs& knobs, int threads) override {
    if (!index_) return;  // its refusal is kept
    refusal_.clear();
    visits_.reset(), knobs_ = knobs;
    keep_refusal(keep_refusals_, refusal_, [&] { ask(questions_.sets[query_set], knobs, threads); });
  }

  std::optional<std::pair<double, double>> work(std::size_t query_set, const Knobs&) override {
    const auto& seen = visits(query_set);
    const auto n = static_cast<double>(questions_.size_of(questions_.sets[query_set]));
    if (!seen || n == 0) return std::nullopt;
    return std::pair{static_cast<double>(seen->nodes) / n, static_cast<double>(seen->primitives) / n};
  }

  /// What the whole query set touched that ran last; counted when first asked for.
  const std::optional<Visits>& visits(std::size_t query_set) const {
    if (!visits_ && index_ && refusal_.empty()) visits_ = counted(questions_.sets[query_set]);
    return visits_;
  }

  const std::vector<Id>& ids() const { return ids_; }
  const Lists<Id>& lists() const { return lists_; }
  const std::string& refusal() const { return refusal_; }

 private:
  std::optional<Visits> counted(const QuestionKinds::Set& set) const {
    switch (set.kind) {
      case Kind::nearest:
        return index_->nearest_visits(questions_.points_of(set), set.k, knobs_);
      case Kind::within:
        return index_->within_visits(questions_.points_of(set), questions_.radius);
      case Kind::inside:
        return index_->inside_visits(questions_.boxes);
    }
    return std::nullopt;
  }

  void ask(const QuestionKinds::Set& set, const Knobs& knobs, int threads) {
    switch (set.kind) {
      case Kind::nearest: {
        const auto& queries = questions_.points_of(set);
        ids_.assign(queries.size() * set.k, accel::no_id);
        index_->nearest(queries, set.k, knobs, threads, ids_);
        break;
      }
      case Kind::within:
        index_->within(questions_.points_of(set), questions_.radius, knobs, threads, lists_);
        break;
      case Kind::inside:
        index_->inside(questions_.boxes, knobs, threads, lists_);
        break;
    }
  }

  const QuestionsOf<T>& questions_;
  bool keep_refusals_;
  std::unique_ptr<IndexOf<T>> index_;
  std::vector<Id> ids_;
  Lists<Id> lists_;
  std::string refusal_;
  Knobs knobs_;  // of the run whose answers these are
  mutable std::optional<Visits> visits_;
};

template <class T>
struct Opening {
  std::vector<geometry::Vec<T, 3>> points;
  std::uint64_t seed = 0, hash = 0;
  int task_version = 0;
  int truth_threads = 1;
  bool must_answer = false;
  bool quick = false;
  bool brute_force = true;
  std::string truth_cache;
};

template <class T>
class KnnBlock final : public Block {
  using Point = geometry::Vec<T, 3>;
  static constexpr bool doubles = std::is_same_v<T, double>;

 public:
  template <class Ask>
  KnnBlock(const std::vector<Method>& methods, Opening<T> opening, Ask ask)
      : methods_(methods), opening_(std::move(opening)), scan_(opening_.points), questions_(ask(scan_)) {
    for (const QuestionKinds::Set& s : questions_.sets) sets_.push_back({s.name, questions_.size_of(s)});
    range_truths_.resize(questions_.sets.size());
  }

  const std::vector<QuerySet>& query_sets() const override { return sets_; }
  std::size_t n() const override { return opening_.points.size(); }
  std::uint64_t seed() const override { return opening_.seed; }
  std::uint64_t dataset_hash() const override { return opening_.hash; }
  std::optional<std::size_t> input_bytes() const override { return n() * sizeof(Point); }
  bool offers(std::size_t m) const override {
    if (!opening_.brute_force && !doubles && methods_[m].info.family == "brute") return false;
    return doubles ? methods_[m].build_double != nullptr : methods_[m].build != nullptr;
  }
  bool in_double() const override { return doubles; }
  bool quick() const override { return opening_.quick; }

  std::unique_ptr<Subject> build(std::size_t m, const Knobs& knobs, int threads) override {
    auto subject = std::make_unique<KnnSubject<T>>(questions_, opening_.must_answer);
    const InputOf<T> input{opening_.points, scan_.size() == opening_.points.size(), questions_.spacing,
                           threads};
    subject->build([&] {
      if constexpr (doubles)
        return methods_[m].build_double(input, knobs);
      else
        return methods_[m].build(input, knobs);
    });
    return subject;
  }

  Errors check(std::size_t m, const Subject& subject, std::size_t number, const Knobs& knobs) override {
    const auto& answers = dynamic_cast<const KnnSubject<T>&>(subject);
    if (!answers.refusal().empty()) return refused_wrongly(answers.refusal());
    const QuestionKinds::Set& set = questions_.sets[number];
    const Claim claim = methods_[m].info.claim;
    Errors e = set.kind == Kind::nearest
                   ? nearest_errors(std::span<const Point>(opening_.points), questions_.points_of(set), set.k,
                                    answers.ids(), nearest_truth_of(set.place), claim,
                                    knobs.contains("epsilon") ? knobs.at("epsilon").get<double>() : 0)
                   : range_errors(answers.lists(), range_truth_of(number), claim, methods_[m].rounds_points);
    const std::size_t queries = questions_.size_of(set);
    if (const auto& seen = answers.visits(number); seen && queries > 0)
      e.extra["knn_leaves"] = static_cast<double>(seen->leaves) / static_cast<double>(queries);
    return e;
  }

 private:
  std::vector<std::uint32_t> sample(std::size_t queries) const {
    return spread_sample(queries, checked_queries(scan_.size(), queries));
  }

  // One truth serves all sets that ask at the same points: the one of largest k.
  const NearestTruth& nearest_truth_of(QuestionKinds::Place place) {
    std::optional<NearestTruth>& truth = nearest_truths_[place];
    if (truth) return *truth;
    if (place == QuestionKinds::sorted) {  // the same queries under other numbers
      truth = nearest_truth_of(QuestionKinds::self);
      std::vector<std::uint32_t> number(questions_.order.size());
      for (std::uint32_t i = 0; i < number.size(); ++i) number[questions_.order[i]] = i;
      for (std::uint32_t& i : truth->sample) i = number[i];
      return *truth;
    }
    std::size_t k = 0;
    for (const QuestionKinds::Set& s : questions_.sets) {
      const QuestionKinds::Place asked_at = s.place == QuestionKinds::sorted ? QuestionKinds::self : s.place;
      if (s.kind == Kind::nearest && asked_at == place) k = std::max(k, s.k);
    }
    const std::vector<Point>& queries = questions_.points[place];
    constexpr const char* parts[] = {"knn_self", "knn_sorted", "knn_off", "knn_far"};
    truth = cached<NearestTruth>(parts[place], k, nearest_from_bytes, [&] {
      return nearest_truth(scan_, queries, k, sample(queries.size()), opening_.truth_threads);
    });
    return *truth;
  }

  const RangeTruth& range_truth_of(std::size_t number) {
    std::optional<RangeTruth>& truth = range_truths_[number];
    if (truth) return *truth;
    const QuestionKinds::Set& set = questions_.sets[number];
    const bool within = set.kind == Kind::within;
    truth = cached<RangeTruth>(within ? "knn_within" : "knn_inside", 0, range_from_bytes, [&] {
      auto asked = sample(questions_.size_of(set));
      return within ? within_truth(scan_, questions_.points_of(set), questions_.radius, std::move(asked),
                                   opening_.truth_threads)
                    : inside_truth(scan_, questions_.boxes, std::move(asked), opening_.truth_threads);
    });
    return *truth;
  }

  template <class Truth, class Compute>
  Truth cached(const char* part, std::size_t k, Truth (*parse)(std::string_view), Compute compute) const {
    const TruthKey key{part, opening_.task_version, opening_.hash, query_hash(k)};
    if (const auto bytes = load_truth(opening_.truth_cache, key)) try {
        return parse({reinterpret_cast<const char*>(bytes->data()), bytes->size()});
      } catch (const std::invalid_argument&) {
        // Damaged: counts as absent.
      }
    Truth truth = compute();
    const std::string bytes = to_bytes(truth);
    store_truth(opening_.truth_cache, key, std::as_bytes(std::span(bytes)));
    return truth;
  }

  std::uint64_t query_hash(std::size_t k) const {
    std::uint64_t h = geometry::hash_u64(k, questions_.points[QuestionKinds::self].size());
    using Bits = std::conditional_t<doubles, std::uint64_t, std::uint32_t>;
    const auto add = [&](T x) { h = geometry::hash_u64(h, std::bit_cast<Bits>(x)); };
    for (const auto& list : questions_.points)
      for (const Point& p : list) add(p[0]), add(p[1]), add(p[2]);
    for (const auto& b : questions_.boxes)
      for (int a = 0; a < 3; ++a) add(b.low[a]), add(b.high[a]);
    add(questions_.radius);
    return h;
  }

  const std::vector<Method>& methods_;
  const Opening<T> opening_;
  const ScanOf<T> scan_;
  const QuestionsOf<T> questions_;
  std::vector<QuerySet> sets_;
  std::array<std::optional<NearestTruth>, QuestionKinds::places> nearest_truths_;
  std::vector<std::optional<RangeTruth>> range_truths_;
};

template <class T>
std::unique_ptr<Block> open_over(const std::vector<Method>& methods, std::vector<geometry::Vec<T, 3>> points,
                                 const datasets::Dataset& dataset, const Asked& asked, int task_version,
                                 const RunContext& context) {
  Opening<T> o;
  o.seed = dataset.seed;
  o.hash = dataset.hash();
  o.task_version = task_version;
  o.truth_threads = all_threads();
  o.truth_cache = context.truth_cache;
  o.quick = context.profile == Profile::quick;
  o.brute_force = asked.brute_force;
  o.points = std::move(points);
  const int threads = o.truth_threads;
  return std::make_unique<KnnBlock<T>>(methods, std::move(o), [&](const ScanOf<T>& scan) {
    QuestionsOf<T> questions = questions_about(scan, asked.queries, context.seed, threads);
    if (!asked.sets.empty())
      std::erase_if(questions.sets,
                    [&](const auto& set) { return std::ranges::count(asked.sets, set.name) == 0; });
    for (QuestionKinds::Set& set : questions.sets)
      if (!asked.suffix.empty()) set.name.replace(set.name.rfind('_'), std::string::npos, asked.suffix);
    return questions;
  });
}

}  // namespace

std::unique_ptr<Block> open_block(const std::vector<Method>& methods, datasets::Dataset dataset,
                                  const Asked& asked, int task_version, const RunContext& context) {
  if (dataset.precise.size() > 0)
    return open_over<double>(methods, dataset.precise.points, dataset, asked, task_version, context);
  return open_over<float>(
      methods, dataset.kind == datasets::Kind::cloud ? dataset.cloud.points : dataset.mesh.vertices, dataset,
      asked, task_version, context);
}

std::unique_ptr<Block> open_hard_block(const std::vector<Method>& methods, datasets::HardCase hard_case,
                                       int task_version, const RunContext& context) {
  datasets::Dataset dataset;
  dataset.cloud = hard_case.cloud;
  Opening<float> o;
  o.seed = context.seed;
  o.hash = dataset.hash();
  o.task_version = task_version;
  o.must_answer = hard_case.expect == datasets::Expect::answers;
  o.points = hard_case.cloud.points;
  return std::make_unique<KnnBlock<float>>(
      methods, std::move(o), [&](const DoubleScan& scan) { return questions_of(hard_case, scan); });
}

}  // namespace treeline::bench::knn
