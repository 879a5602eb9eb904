#include "bench/knn_nd/block.hpp"

#include <algorithm>

#include "bench/core/all_threads.hpp"
#include "bench/core/refusal.hpp"
#include "bench/core/truth_cache.hpp"
#include "bench/knn_nd/metric.hpp"
#include "geometry/random.hpp"

namespace treeline::bench::knn_nd {
namespace {

RowsView view_of(const datasets::Vectors& v) { return {v.scalars.data(), v.size(), v.columns}; }

// An index with its latest answers. Where refusing is not allowed, a refusal is kept and judged like an
// answer.
class RowSubject final : public Subject {
 public:
  explicit RowSubject(const Questions& questions) : questions_(questions) {}

  template <class Build>
  void build(Build make) {
    keep_refusal(questions_.must_answer, refusal_, [&] { index_ = make(); });
  }

  void run(std::size_t query_set, const Knobs& knobs, int threads) override {
    if (!index_) return;  // its refusal is kept
    refusal_.clear();
    const std::size_t k = questions_.sets[query_set].k;
    ids_.assign(questions_.rows.size() * k, accel::no_id);
    keep_refusal(questions_.must_answer, refusal_,
                 [&] { index_->nearest(view_of(questions_.rows), k, knobs, threads, ids_); });
  }

  std::optional<std::pair<double, double>> work(std::size_t query_set, const Knobs& knobs) override {
    if (!index_ || !refusal_.empty() || questions_.rows.size() == 0) return std::nullopt;
    const auto work = index_->nearest_work(view_of(questions_.rows), questions_.sets[query_set].k, knobs);
    if (!work) return std::nullopt;
    const double scale = 1.0 / static_cast<double>(questions_.rows.size());
    return std::pair{scale * static_cast<double>(work->nodes), scale * static_cast<double>(work->primitives)};
  }

  const std::vector<Id>& ids() const { return ids_; }
  const std::string& refusal() const { return refusal_; }

 private:
  const Questions& questions_;
  std::unique_ptr<Index> index_;
  std::vector<Id> ids_;
  std::string refusal_;
};

class RowBlock final : public Block {
 public:
  RowBlock(const std::vector<Method>& methods, datasets::Dataset dataset, Questions questions,
           int task_version, const RunContext& context)
      : methods_(methods),
        dataset_(std::move(dataset)),
        hash_(dataset_.hash()),
        questions_(std::move(questions)),
        task_version_(task_version),
        truth_cache_(questions_.hard ? "" : context.truth_cache) {
    for (const Questions::Set& s : questions_.sets) sets_.push_back({s.name, questions_.rows.size()});
  }

  const std::vector<QuerySet>& query_sets() const override { return sets_; }
  std::size_t n() const override { return dataset_.size(); }
  std::uint64_t seed() const override { return dataset_.seed; }
  std::uint64_t dataset_hash() const override { return hash_; }
  std::optional<std::size_t> input_bytes() const override {
    return dataset_.vectors.scalars.size() * sizeof(float);
  }

  std::unique_ptr<Subject> build(std::size_t m, const Knobs& knobs, int threads) override {
    auto subject = std::make_unique<RowSubject>(questions_);
    subject->build([&] { return methods_[m].build({view_of(dataset_.vectors), threads}, knobs); });
    return subject;
  }

  Errors check(std::size_t m, const Subject& subject, std::size_t number, const Knobs& knobs) override {
    const auto& answers = dynamic_cast<const RowSubject&>(subject);
    if (!answers.refusal().empty()) return refused_wrongly(answers.refusal());
    const double epsilon = knobs.contains("epsilon") ? knobs.at("epsilon").get<double>() : 0;
    return errors_of(view_of(dataset_.vectors), view_of(questions_.rows), questions_.sets[number].k,
                     answers.ids(), truth(), methods_[m].info.claim, epsilon);
  }

 private:
  // One truth serves all sets, which ask at the same queries: that of the largest k.
  const Truth& truth() {
    if (truth_) return *truth_;
    std::size_t k = 0;
    for (const Questions::Set& s : questions_.sets) k = std::max(k, s.k);
    datasets::Dataset asked;
    asked.kind = datasets::Kind::vectors, asked.vectors = questions_.rows;
    const TruthKey key{"knn_nd", task_version_, hash_, geometry::hash_u64(asked.hash(), k)};
    if (const auto bytes = load_truth(truth_cache_, key)) try {
        truth_ = truth_from_bytes({reinterpret_cast<const char*>(bytes->data()), bytes->size()},
                                  questions_.rows.size());
        return *truth_;
      } catch (const std::invalid_argument&) {
        // Damaged: counts as absent.
      }
    const int threads = questions_.hard ? 1 : all_threads();
    truth_ = truth_of(view_of(dataset_.vectors), view_of(questions_.rows), k, threads);
    const std::string bytes = to_bytes(*truth_);
    store_truth(truth_cache_, key, std::as_bytes(std::span(bytes)));
    return *truth_;
  }

  const std::vector<Method>& methods_;
  const datasets::Dataset dataset_;
  const std::uint64_t hash_;
  const Questions questions_;
  const int task_version_;
  const std::string truth_cache_;
  std::vector<QuerySet> sets_;
  std::optional<Truth> truth_;
};

}  // namespace

std::unique_ptr<Block> open_block(const std::vector<Method>& methods, datasets::Dataset dataset,
                                  Questions questions, int task_version, const RunContext& context) {
  return std::make_unique<RowBlock>(methods, std::move(dataset), std::move(questions), task_version, context);
}

}  // namespace treeline::bench::knn_nd
