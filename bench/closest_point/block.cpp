#include "bench/closest_point/block.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "bench/core/tally.hpp"
#include "bench/core/truth_cache.hpp"

namespace treeline::bench::closest_point {
namespace {

constexpr double off = 1e-6;  // of the diagonal: more than what float leaves of an answer

class ClosestPointSubject final : public Subject {
 public:
  ClosestPointSubject(std::unique_ptr<Index> index, const std::vector<PointSet>& sets)
      : index_(std::move(index)), sets_(sets) {}

  void run(std::size_t set, const Knobs& knobs, int threads) override {
    index_->closest(sets_[set].points, answers, knobs, threads);
  }
  std::optional<std::pair<double, double>> work(std::size_t set, const Knobs&) override {
    constexpr std::size_t most = 2048;  // counted, evenly spread
    const auto& points = sets_[set].points.floats;
    std::vector<geometry::Vec3f> some;
    const std::size_t count = std::min(most, points.size());
    for (std::size_t i = 0; i < count; ++i) some.push_back(points[i * points.size() / count]);
    return index_->work(Queries(std::move(some)));
  }
  const Index& index() const { return *index_; }

  Answers answers;

 private:
  std::unique_ptr<Index> index_;
  const std::vector<PointSet>& sets_;
};

std::string describe(std::size_t number, const geometry::Vec3f& q, const TrueClosest& truth,
                     const Answer& answer, Verdict verdict) {
  const auto place = [](accel::Id primitive, double distance) {
    if (primitive == accel::no_id) return std::string("nothing");
    return fmt::format("triangle {} at {:.9g}", primitive, distance);
  };
  const double answered = geometry::length(geometry::Vec3d(q) - answer.point);
  const std::string told =
      verdict == Verdict::wrong_distance ? fmt::format(", told {:.9g}", std::sqrt(answer.distance2)) : "";
  return fmt::format("query {} at ({}, {}, {}): {}, answered {}{}, true is {}", number, q[0], q[1], q[2],
                     to_string(verdict), place(answer.primitive, answered), told,
                     place(truth.primitive, std::sqrt(truth.distance2)));
}

/// Sums over the answers to one query set.
struct Tally : ErrorTally {
  double off_triangle = 0, relative = 0, relative_max = 0;
  std::size_t far_off = 0, farther = 0, much_farther = 0;

  void add(const Judged& judged) {
    ErrorTally::add(judged.error, judged.signed_error);
    relative += judged.relative;
    relative_max = std::max(relative_max, judged.relative);
    off_triangle = std::max(off_triangle, judged.off_triangle);
    far_off += judged.error > off, farther += judged.farther, much_farther += judged.much_farther;
  }
};

}  // namespace

ClosestPointBlock::ClosestPointBlock(BlockInput input, const std::vector<Method>& methods)
    : MeshBlock(std::move(input), methods), truths_(input_.sets.size()), judge_(input_.mesh) {
  for (const PointSet& set : input_.sets) query_sets_.push_back({set.name, set.points.size()});
}

std::unique_ptr<Subject> ClosestPointBlock::build(std::size_t m, const Knobs& build_knobs, int threads) {
  return std::make_unique<ClosestPointSubject>(methods_[m].build(input_.mesh, build_knobs, threads),
                                               input_.sets);
}

void ClosestPointBlock::find_truth() {
  for (std::size_t set = 0; set < input_.sets.size(); ++set) truth_of(set);
}

const ClosestPointBlock::Truth& ClosestPointBlock::truth_of(std::size_t query_set) {
  const std::size_t source = input_.sets[query_set].truth;
  std::optional<Truth>& truth = truths_[source];
  if (truth) return *truth;
  const auto& points = input_.sets[source].points.floats;
  truth.emplace();
  truth->queries = evenly_spread(points.size(), input_.judged);
  std::vector<geometry::Vec3f> judged;
  for (const std::size_t i : truth->queries) judged.push_back(points[i]);
  const TruthKey key{"closest_point", input_.version, input_.dataset_hash, hash_of(judged)};
  if (auto cached = load_truth_as<TrueClosest>(input_.truth_cache, key);
      cached && cached->size() == judged.size()) {
    truth->answers = std::move(*cached);
  } else {
    truth->answers = true_closest(input_.mesh, judged, input_.threads);
    store_truth(input_.truth_cache, key, truth->answers);
  }
  return *truth;
}

Errors ClosestPointBlock::check(std::size_t m, const Subject& subject, std::size_t query_set, const Knobs&) {
  const auto& answered = static_cast<const ClosestPointSubject&>(subject);
  const PointSet& set = input_.sets[query_set];
  const Truth& truth = truth_of(query_set);
  const Method& method = methods_[m];
  const Promise promise{method.info.claim, method.roundoff, method.names_triangles,
                        answered.answers.in_float()};

  Tally tally;
  Errors result;
  for (std::size_t i = 0; i < truth.queries.size(); ++i) {
    const std::size_t number = truth.queries[i];  // in the set that the truth is of
    const std::size_t place = set.place.empty() ? number : set.place[number];
    const geometry::Vec3f& query = set.points.floats[place];
    const Answer answer = answered.answers[place];
    const Judged judged = judge_(query, truth.answers[i], answer, promise);
    tally.add(judged);
    if (judged.verdict != Verdict::right && result.within_claim) {
      result.within_claim = false;
      result.reason = describe(place, query, truth.answers[i], answer, judged.verdict);
    }
  }
  Knobs& extra = result.extra;
  extra["closest_point_judged"] = tally.errors.size();
  if (!tally.errors.empty()) {
    const auto n = static_cast<double>(tally.errors.size());
    tally.write(result);
    result.floor = judge_.floor();
    extra["closest_point_far_off"] = static_cast<double>(tally.far_off) / n;
    extra["closest_point_relative_mean"] = tally.relative / n;
    extra["closest_point_relative_max"] = tally.relative_max;
    if (method.names_triangles) {
      extra["closest_point_wrong_triangle"] = static_cast<double>(tally.farther) / n;
      extra["closest_point_much_farther"] = static_cast<double>(tally.much_farther) / n;
      extra["closest_point_off_triangle_max"] = tally.off_triangle;
    }
  }
  extra.update(answered.index().facts());
  return result;
}

}  // namespace treeline::bench::closest_point
