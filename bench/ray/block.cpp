#include "bench/ray/block.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numeric>

#include "bench/core/tally.hpp"
#include "bench/core/truth_cache.hpp"
#include "bench/ray/subject.hpp"
#include "geometry/random.hpp"
#include "geometry/tolerances.hpp"

namespace treeline::bench::ray {
namespace {

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

/// Spacing of the floats at t.
double float_ulp(double t) {
  const double least = std::numeric_limits<float>::denorm_min();
  return t == 0 || !std::isfinite(t) ? least : std::max(least, std::ldexp(1.0, std::ilogb(t) - 23));
}

/// Does t lie, by more than `slack` as a length, outside of the stretch of the ray along which the triangle
/// lies?
bool outside_of(const geometry::Triangle3f& triangle, const geometry::Rayf& ray, double t, double slack) {
  const geometry::Triangle3d corners(triangle);
  const geometry::Vec3d origin(ray.origin), direction(ray.direction);
  const double length2 = geometry::length2(direction);
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const auto& corner : {corners.a, corners.b, corners.c}) {
    const double at = geometry::dot(corner - origin, direction) / length2;
    low = std::min(low, at), high = std::max(high, at);
  }
  const double rounding = slack / std::sqrt(length2) + float_ulp(t);
  return t < low - rounding || t > high + rounding;
}

/// Sums over the answers to one query set.
struct Tally : ErrorTally {
  std::vector<double> ulps;
  std::array<std::size_t, 6> of_verdict{};  // by Verdict
  std::size_t outside = 0, surplus = 0, missing = 0;

  std::size_t operator[](Verdict v) const { return of_verdict[static_cast<std::size_t>(v)]; }
  void add(const Judged& judged) {
    ErrorTally::add(judged.error, judged.signed_error);
    ++of_verdict[static_cast<std::size_t>(judged.verdict)];
  }
  /// Only where both are of one surface: elsewhere the difference says nothing about rounding.
  void add_t(const Judged& judged, double truth, double t) {
    if (judged.verdict == Verdict::right || judged.verdict == Verdict::wrong_t)
      ulps.push_back(std::abs(t - truth) / float_ulp(truth));
  }
};

double per_million(std::size_t part, std::size_t whole) {
  return whole == 0 ? 0 : 1e6 * static_cast<double>(part) / static_cast<double>(whole);
}

}  // namespace

RayBlock::RayBlock(BlockInput input, const std::vector<Method>& methods)
    : MeshBlock(std::move(input), methods), truths_(input_.sets.size()) {
  frames_ = std::move(input_.moved);
  frames_.insert(frames_.begin(), std::move(input_.mesh));
  std::vector<double> largest;
  for (const geometry::Mesh3f& frame : frames_) largest.push_back(Judge::largest_coordinate(frame));
  for (const RaySet& set : input_.sets) {
    query_sets_.push_back({set.name, set.rays.size()});
    const geometry::Mesh3f& mesh = frames_.at(set.frame);
    float_judges_.emplace_back(mesh, geometry::tolerance::unit_roundoff<float>, largest[set.frame]);
    double_judges_.emplace_back(mesh, geometry::tolerance::unit_roundoff<double>, largest[set.frame]);
  }
}

std::unique_ptr<Subject> RayBlock::build(std::size_t m, const Knobs& build_knobs, int threads) {
  return std::make_unique<RaySubject>(methods_[m], build_knobs, threads, frames_, input_.sets);
}

void RayBlock::find_truth() {
  for (std::size_t set = 0; set < input_.sets.size(); ++set) truth_of(set);
}

const RayBlock::Truth& RayBlock::truth_of(std::size_t query_set) {
  const std::size_t source = input_.sets[query_set].truth;
  std::optional<Truth>& truth = truths_[source];
  if (truth) return *truth;
  const RaySet& set = input_.sets[source];
  truth.emplace();
  truth->rays = evenly_spread(set.rays.size(), input_.judged);
  std::vector<geometry::Rayf> rays;
  for (const std::size_t i : truth->rays) rays.push_back(set.rays[i]);
  const std::uint64_t hash =
      set.frame == 0 ? input_.dataset_hash : geometry::hash_u64(input_.dataset_hash, set.frame);
  const TruthKey key{"ray_closest", input_.version, hash, hash_of(rays)};
  if (auto cached = load_truth_as<TrueHit>(input_.truth_cache, key);
      cached && cached->size() == rays.size()) {
    truth->hits = std::move(*cached);
  } else {
    truth->hits = true_closest(frames_[set.frame], rays, input_.threads);
    store_truth(input_.truth_cache, key, truth->hits);
  }
  return *truth;
}

Errors RayBlock::check(std::size_t m, const Subject& subject, std::size_t query_set, const Knobs&) {
  const auto& answers = static_cast<const RaySubject&>(subject);
  const RaySet& set = input_.sets[query_set];
  const geometry::Mesh3f& mesh = frames_[set.frame];
  const Truth& truth = truth_of(query_set);
  const Claim claim = methods_[m].info.claim;
  Judge& judge = (claim == Claim::exact ? double_judges_ : float_judges_)[set.truth];

  Tally tally;
  Errors result;
  for (std::size_t i = 0; i < truth.rays.size(); ++i) {
    const std::size_t number = truth.rays[i];  // in the set that the truth is of
    const std::size_t place = set.place.empty() ? number : set.place[number];
    const geometry::Rayf& ray = set.rays[place];
    RayAnswer answer;
    if (!set.any)
      answer = answers.hits[place];
    else if (answers.blocked[place])
      answer.primitive = 0;
    Judged judged = set.any ? judge.any(number, ray, truth.hits[i], static_cast<bool>(answer))
                            : judge.closest(number, ray, truth.hits[i], answer);
    // From inside a closed mesh there is a hit however the ray is moved: nothing borderline about a miss.
    if (input_.from_inside && truth.hits[i] && !answer)
      judged = {Verdict::false_miss, judged.excused || judged.verdict == Verdict::borderline, 1, 0};
    tally.add(judged);
    tally.surplus += answer && !truth.hits[i], tally.missing += !answer && truth.hits[i];
    if (!set.any && answer && truth.hits[i]) tally.add_t(judged, truth.hits[i].t, answer.t);
    if (!set.any && answer.primitive < mesh.size())
      tally.outside +=
          outside_of(mesh.triangle(answer.primitive), ray, answer.t, judge.eps(ray, {&answer.primitive, 1}));
    bool kept = judged.counts_as_right() || (claim == Claim::approximate && judged.excused);
    if (claim == Claim::exact && judged.verdict == Verdict::right && judged.error > float_answer)
      kept = false;
    if (!kept && result.within_claim) {
      result.within_claim = false;
      result.reason = describe(place, ray, truth.hits[i], answer, set.any, judged.verdict);
    }
  }
  const auto answered = [&](std::size_t i) {
    return set.any ? answers.blocked[i] != 0 : static_cast<bool>(answers.hits[i]);
  };
  std::size_t hits = 0;
  for (std::size_t i = 0; i < set.rays.size(); ++i) hits += answered(i);
  std::optional<double> leaks;
  if (input_.from_inside)
    leaks = per_million(set.rays.size() - hits, set.rays.size());
  else if (input_.closed)
    leaks = per_million(tally[Verdict::false_miss], tally.errors.size());
  if (input_.from_inside && *leaks > 0 && claim != Claim::approximate && result.within_claim) {
    result.within_claim = false;
    result.reason = std::to_string(set.rays.size() - hits) + " rays from inside a closed mesh got out";
  }

  tally.write(result);
  // Answers are floats: below half an ulp of t there is nothing to tell methods apart by.
  if (!tally.errors.empty() && !set.any) result.floor = geometry::tolerance::unit_roundoff<float>;
  const auto true_hits = std::ranges::count_if(truth.hits, [](const TrueHit& h) { return bool(h); });
  const auto known = [](const auto& value) { return value ? Knobs(*value) : Knobs(nullptr); };
  std::optional<double> share, ulp_max, ulp_mean, self_hits;
  std::optional<std::size_t> outside;
  if (!truth.hits.empty()) share = static_cast<double>(true_hits) / static_cast<double>(truth.hits.size());
  if (!tally.ulps.empty()) {
    ulp_max = std::ranges::max(tally.ulps);
    ulp_mean =
        std::accumulate(tally.ulps.begin(), tally.ulps.end(), 0.0) / static_cast<double>(tally.ulps.size());
  }
  if (!set.any) outside = tally.outside;
  if (set.outward) self_hits = per_million(hits, set.rays.size());
  result.extra = {{"ray_judged", tally.errors.size()},
                  {"ray_hit_share", known(share)},
                  {"ray_false_hits", tally[Verdict::false_hit]},
                  {"ray_false_misses", tally[Verdict::false_miss]},
                  {"ray_surplus", tally.surplus},
                  {"ray_missing", tally.missing},
                  {"ray_borderline", tally[Verdict::borderline]},
                  {"ray_wrong_primitive", tally[Verdict::wrong_primitive]},
                  {"ray_wrong_t", tally[Verdict::wrong_t]},
                  {"ray_t_outside", known(outside)},
                  {"ray_t_ulp_max", known(ulp_max)},
                  {"ray_t_ulp_mean", known(ulp_mean)},
                  {"ray_leaks_per_million", known(leaks)},
                  {"ray_self_hits_per_million", known(self_hits)},
                  {"ray_update_s", known(answers.update_seconds())}};
  result.extra.update(answers.index().facts());
  return result;
}

}  // namespace treeline::bench::ray
