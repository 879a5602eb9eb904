#include "bench/ray/block.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "bench/core/truth_cache.hpp"
#include "geometry/random.hpp"
#include "geometry/tolerances.hpp"

namespace treeline::bench::ray {
namespace {

class RaySubject final : public Subject {
 public:
  RaySubject(std::unique_ptr<Index> index, const std::vector<RaySet>& sets)
      : index_(std::move(index)), sets_(sets) {}

  void run(std::size_t set, const Knobs& knobs, int threads) override {
    const auto& rays = sets_[set].rays;
    if (sets_[set].any) {
      blocked.resize(rays.size());
      index_->any(rays, blocked, knobs, threads);
    } else {
      hits.resize(rays.size());
      index_->closest(rays, hits, knobs, threads);
    }
  }
  std::optional<std::pair<double, double>> work(std::size_t set, const Knobs&) override {
    return index_->work(sets_[set].rays, sets_[set].any);
  }

  std::vector<RayAnswer> hits;
  std::vector<std::uint8_t> blocked;

 private:
  std::unique_ptr<Index> index_;
  const std::vector<RaySet>& sets_;
};

std::vector<std::size_t> evenly_spread(std::size_t size, std::size_t most) {
  std::vector<std::size_t> r(std::min(size, most));
  for (std::size_t i = 0; i < r.size(); ++i) r[i] = i * size / r.size();
  return r;
}

std::string describe(std::size_t number, const geometry::Rayf& ray, const TrueHit& truth,
                     const RayAnswer& answer, bool any, Verdict verdict) {
  const auto corner = [](const geometry::Vec3f& v) { return fmt::format("({}, {}, {})", v[0], v[1], v[2]); };
  const auto hit = [&](accel::Id primitive, double t) {
    if (primitive == accel::no_id) return std::string("nothing");
    return any ? std::string("a hit") : fmt::format("triangle {} at t {:.9g}", primitive, t);
  };
  return fmt::format("ray {} from {} along {}: {}, answered {}, true is {}", number, corner(ray.origin),
                     corner(ray.direction), to_string(verdict), hit(answer.primitive, answer.t),
                     hit(truth.primitive, truth.t));
}

/// What an exact method may add to t by answering in float: half an ulp, and the rounding of the judge's own
/// t.
constexpr double float_answer = 2 * geometry::tolerance::unit_roundoff<float>;

}  // namespace

RayBlock::RayBlock(BlockInput input, const std::vector<Method>& methods)
    : input_(std::move(input)), methods_(methods), truths_(input_.sets.size()) {
  for (const RaySet& set : input_.sets) {
    query_sets_.push_back({set.name, set.rays.size()});
    float_judges_.emplace_back(input_.mesh, geometry::tolerance::unit_roundoff<float>);
    double_judges_.emplace_back(input_.mesh, geometry::tolerance::unit_roundoff<double>);
  }
}

std::unique_ptr<Subject> RayBlock::build(std::size_t m, const Knobs& build_knobs, int threads) {
  return std::make_unique<RaySubject>(methods_[m].build(input_.mesh, build_knobs, threads), input_.sets);
}

const RayBlock::Truth& RayBlock::truth_of(std::size_t query_set) {
  const std::size_t source = input_.sets[query_set].truth;
  std::optional<Truth>& truth = truths_[source];
  if (truth) return *truth;
  const auto& all = input_.sets[source].rays;
  truth.emplace();
  truth->rays = evenly_spread(all.size(), input_.judged);
  std::vector<geometry::Rayf> rays;
  for (const std::size_t i : truth->rays) rays.push_back(all[i]);
  const TruthKey key{"ray_closest", input_.version, input_.dataset_hash, hash_of(rays)};
  if (auto cached = load_truth_as<TrueHit>(input_.truth_cache, key);
      cached && cached->size() == rays.size()) {
    truth->hits = std::move(*cached);
  } else {
    truth->hits = true_closest(input_.mesh, rays, input_.threads);
    store_truth(input_.truth_cache, key, truth->hits);
  }
  return *truth;
}

Errors RayBlock::check(std::size_t m, const Subject& subject, std::size_t query_set, const Knobs&) {
  const auto& answers = static_cast<const RaySubject&>(subject);
  const RaySet& set = input_.sets[query_set];
  const Truth& truth = truth_of(query_set);
  const Claim claim = methods_[m].info.claim;
  Judge& judge = (claim == Claim::exact ? double_judges_ : float_judges_)[set.truth];

  std::size_t false_hits = 0, false_misses = 0, borderline = 0, wrong_primitive = 0, wrong_t = 0;
  double bias = 0;
  std::vector<double> errors;
  Errors result;
  for (std::size_t i = 0; i < truth.rays.size(); ++i) {
    const std::size_t number = truth.rays[i];
    RayAnswer answer;
    if (!set.any)
      answer = answers.hits[number];
    else if (answers.blocked[number])
      answer.primitive = 0;
    Judged judged = set.any ? judge.any(number, set.rays[number], truth.hits[i], static_cast<bool>(answer))
                            : judge.closest(number, set.rays[number], truth.hits[i], answer);
    // From inside a closed mesh there is a hit however the ray is moved: nothing borderline about a miss.
    if (input_.from_inside && truth.hits[i] && !answer)
      judged = {Verdict::false_miss, judged.excused || judged.verdict == Verdict::borderline, 1, 0};
    errors.push_back(judged.error);
    bias += judged.signed_error;
    borderline += judged.verdict == Verdict::borderline;
    false_hits += judged.verdict == Verdict::false_hit;
    false_misses += judged.verdict == Verdict::false_miss;
    wrong_primitive += judged.verdict == Verdict::wrong_primitive;
    wrong_t += judged.verdict == Verdict::wrong_t;
    bool kept = judged.counts_as_right() || (claim == Claim::approximate && judged.excused);
    if (claim == Claim::exact && judged.verdict == Verdict::right && judged.error > float_answer)
      kept = false;
    if (!kept && result.within_claim) {
      result.within_claim = false;
      result.reason = describe(number, set.rays[number], truth.hits[i], answer, set.any, judged.verdict);
    }
  }
  std::size_t leaks = 0;
  if (input_.from_inside)
    for (std::size_t i = 0; i < set.rays.size(); ++i)
      leaks += set.any ? answers.blocked[i] == 0 : !answers.hits[i];
  if (leaks > 0 && claim != Claim::approximate && result.within_claim) {
    result.within_claim = false;
    result.reason = std::to_string(leaks) + " rays from inside a closed mesh got out";
  }

  if (!errors.empty()) {
    const double n = static_cast<double>(errors.size());
    std::ranges::sort(errors);
    result.mean = std::accumulate(errors.begin(), errors.end(), 0.0) / n;
    result.error = result.mean;
    result.max = errors.back();
    result.p99 = errors[static_cast<std::size_t>(0.99 * (n - 1))];
    result.bias = bias / n;
    // Answers are floats: below half an ulp of t there is nothing to tell methods apart by.
    if (!set.any) result.floor = geometry::tolerance::unit_roundoff<float>;
  }
  const auto hit = std::ranges::count_if(truth.hits, [](const TrueHit& h) { return static_cast<bool>(h); });
  result.extra = {{"ray_judged", errors.size()},
                  {"ray_hit_share", truth.hits.empty() ? Knobs(nullptr)
                                                       : Knobs(static_cast<double>(hit) /
                                                               static_cast<double>(truth.hits.size()))},
                  {"ray_false_hits", false_hits},
                  {"ray_false_misses", false_misses},
                  {"ray_borderline", borderline},
                  {"ray_wrong_primitive", wrong_primitive},
                  {"ray_wrong_t", wrong_t},
                  {"ray_leaks", input_.from_inside ? Knobs(leaks) : Knobs(nullptr)}};
  return result;
}

}  // namespace treeline::bench::ray
