#include "bench/knn/metric.hpp"

#include <algorithm>
#include <numeric>

#include "geometry/tolerances.hpp"

namespace treeline::bench::knn {

using accel::Id;
using geometry::Vec3d;
using geometry::Vec3f;

double float_floor() { return geometry::tolerance::gamma<float>(5); }
double double_floor() { return geometry::tolerance::gamma<double>(15); }

namespace {

// Per-query errors gathered into the figures of a row.
class Summary {
 public:
  void add(double error, double largest) {
    errors_.push_back(error);
    max_ = std::max(max_, largest);
  }
  void add_excess(double excess) {
    signed_sum_ += excess;
    unsigned_sum_ += std::abs(excess);
    ++excesses_;
  }
  Errors errors(double floor) {
    Errors e;
    e.floor = floor;
    if (errors_.empty()) return e;
    const double n = static_cast<double>(errors_.size());
    e.error = std::accumulate(errors_.begin(), errors_.end(), 0.0) / n;
    e.max = max_;
    // The smallest value that at least 99 % of the queries do not exceed.
    const auto rank = static_cast<std::size_t>(std::ceil(0.99 * n)) - 1;
    std::nth_element(errors_.begin(), errors_.begin() + static_cast<std::ptrdiff_t>(rank), errors_.end());
    e.p99 = errors_[rank];
    e.mean = excesses_ > 0 ? unsigned_sum_ / static_cast<double>(excesses_) : 0.0;
    e.bias = excesses_ > 0 ? signed_sum_ / static_cast<double>(excesses_) : 0.0;
    return e;
  }

 private:
  std::vector<double> errors_;
  double max_ = 0, signed_sum_ = 0, unsigned_sum_ = 0;
  std::size_t excesses_ = 0;
};

void blame(Errors& e, std::uint32_t query, const std::string& what) {
  if (!e.within_claim) return;
  e.within_claim = false;
  e.reason = "query " + std::to_string(query) + ": " + what;
}

void note_queries(Errors& e, std::size_t wrong, std::size_t checked) {
  if (checked > 0) e.extra["knn_wrong"] = static_cast<double>(wrong) / static_cast<double>(checked);
  e.extra["knn_checked"] = checked;
}

// The distances of one row of answers, sorted, and what is wrong with its ids.
struct Answered {
  std::vector<double> distances;
  std::size_t invalid = 0, repeated = 0;
};

template <class Point>
Answered answered(std::span<const Point> points, const Point& query, std::span<const Id> row) {
  Answered r;
  std::vector<Id> seen;
  for (const Id id : row) {
    if (id == accel::no_id) continue;
    if (id >= points.size() || !geometry::is_finite(points[id])) {
      ++r.invalid;
    } else {
      seen.push_back(id);
    }
  }
  std::sort(seen.begin(), seen.end());
  const auto last = std::unique(seen.begin(), seen.end());
  r.repeated = static_cast<std::size_t>(seen.end() - last);
  seen.erase(last, seen.end());
  for (const Id id : seen) r.distances.push_back(geometry::distance(Vec3d(points[id]), Vec3d(query)));
  std::sort(r.distances.begin(), r.distances.end());
  return r;
}

double excess_of(double distance, double truth) {
  if (distance == truth) return 0;
  return truth > 0 ? (distance - truth) / truth : 1.0;
}

template <class Point>
Errors errors_above(double floor, std::span<const Point> points, std::span<const Point> queries,
                    std::size_t k, std::span<const Id> ids, const NearestTruth& truth, Claim claim,
                    double bound) {
  Summary summary;
  Errors verdict;
  std::size_t met = 0, met_1pct = 0, met_10pct = 0, wanted = 0, missing = 0, wrong = 0;
  for (std::size_t i = 0; i < truth.sample.size(); ++i) {
    const std::uint32_t number = truth.sample[i];
    const auto row = ids.subspan(number * k, k);
    const bool silent = std::all_of(row.begin(), row.end(), [](Id id) { return id == accel::no_id; });
    if (silent && !geometry::is_finite(queries[number])) {
      summary.add(0, 0);
      continue;
    }
    if (!truth.answerable[i]) {
      summary.add(1, 1);
      ++wrong;
      blame(verdict, number, "returned neighbours of a query that is not a number");
      continue;
    }
    const std::size_t expected = std::min(k, truth.k);
    const auto right = truth.row(i).first(expected);
    const Answered got = answered(points, queries[number], row);
    double largest = 0;
    for (std::size_t j = 0; j < expected; ++j) {
      const bool there = j < got.distances.size();
      const double excess = there ? excess_of(got.distances[j], right[j]) : 1.0;
      largest = std::max(largest, std::abs(excess));
      summary.add_excess(std::min(excess, 1.0));
      if (!there) {
        ++missing;
        continue;
      }
      const double last = right[expected - 1];
      if (got.distances[j] <= last * (1 + 1e-6)) ++met;
      if (got.distances[j] <= last * 1.01) ++met_1pct;
      if (got.distances[j] <= last * 1.1) ++met_10pct;
    }
    wanted += expected;
    if (got.invalid + got.repeated > 0) largest = std::max(largest, 1.0);
    summary.add(std::min(largest, 1.0), largest);
    wrong += largest > floor ? 1 : 0;

    if (got.invalid > 0) blame(verdict, number, std::to_string(got.invalid) + " invalid ids");
    if (got.repeated > 0) blame(verdict, number, std::to_string(got.repeated) + " repeated ids");
    if (got.distances.size() < expected)
      blame(verdict, number,
            std::to_string(expected - got.distances.size()) + " of " + std::to_string(expected) + " missing");
    if (claim == Claim::exact && largest > floor)
      blame(verdict, number,
            "a distance is off by " + std::to_string(largest) + " relative, beyond rounding");
    if (claim == Claim::bounded && largest > bound + floor * (1 + bound))
      blame(verdict, number,
            "a distance is off by " + std::to_string(largest) + " relative, beyond " + std::to_string(bound));
  }
  Errors e = summary.errors(floor);
  e.within_claim = verdict.within_claim, e.reason = verdict.reason;
  if (wanted > 0) {
    const auto share = [&](std::size_t n) { return static_cast<double>(n) / static_cast<double>(wanted); };
    e.extra["knn_recall"] = share(met);
    e.extra["knn_recall_1pct"] = share(met_1pct), e.extra["knn_recall_10pct"] = share(met_10pct);
    e.extra["knn_missing"] = share(missing);
  }
  note_queries(e, wrong, truth.sample.size());
  return e;
}

}  // namespace

Errors nearest_errors(std::span<const Vec3f> points, std::span<const Vec3f> queries, std::size_t k,
                      std::span<const Id> ids, const NearestTruth& truth, Claim claim, double bound) {
  return errors_above(float_floor(), points, queries, k, ids, truth, claim, bound);
}
Errors nearest_errors(std::span<const Vec3d> points, std::span<const Vec3d> queries, std::size_t k,
                      std::span<const Id> ids, const NearestTruth& truth, Claim claim, double bound) {
  return errors_above(double_floor(), points, queries, k, ids, truth, claim, bound);
}

Errors range_errors(const accel::Lists<Id>& ids, const RangeTruth& truth, Claim claim, bool rounds_points) {
  Summary summary;
  Errors verdict;
  std::size_t all_missing = 0, all_surplus = 0, all_right = 0, wrong = 0;
  std::vector<Id> got;
  for (std::size_t i = 0; i < truth.sample.size(); ++i) {
    const std::uint32_t number = truth.sample[i];
    const auto list = ids[number];
    const RangeAnswer& right = truth.answers[i];
    got.assign(list.begin(), list.end());
    std::sort(got.begin(), got.end());
    const auto last = std::unique(got.begin(), got.end());
    const auto repeated = static_cast<std::size_t>(got.end() - last);
    std::size_t surplus = repeated;
    got.erase(last, got.end());
    std::size_t found = 0;
    for (const Id id : got) {
      if (std::binary_search(right.must.begin(), right.must.end(), id)) {
        ++found;
      } else if (!std::binary_search(right.may.begin(), right.may.end(), id)) {
        ++surplus;
      }
    }
    const std::size_t missing = right.must.size() - found;
    const double scale = static_cast<double>(std::max<std::size_t>(right.must.size(), 1));
    const double error = static_cast<double>(missing + surplus) / scale;
    summary.add(error, error);
    summary.add_excess((static_cast<double>(surplus) - static_cast<double>(missing)) / scale);
    all_missing += missing, all_surplus += surplus, all_right += right.must.size();
    wrong += missing + surplus > 0 ? 1 : 0;
    if (!truth.answerable[i] && !list.empty())
      blame(verdict, number, "returned points for a query that is not a number");
    if (rounds_points ? repeated > 0 : surplus > 0)
      blame(verdict, number, std::to_string(surplus) + " surplus ids");
    if (missing > 0 && claim == Claim::exact)
      blame(verdict, number,
            std::to_string(missing) + " of " + std::to_string(right.must.size()) + " missing");
  }
  Errors e = summary.errors(0);
  e.within_claim = verdict.within_claim, e.reason = verdict.reason;
  const double scale = static_cast<double>(std::max<std::size_t>(all_right, 1));
  if (all_right > 0) e.extra["knn_recall"] = 1 - static_cast<double>(all_missing) / scale;
  e.extra["knn_missing"] = static_cast<double>(all_missing) / scale;
  e.extra["knn_surplus"] = static_cast<double>(all_surplus) / scale;
  note_queries(e, wrong, truth.sample.size());
  return e;
}

}  // namespace treeline::bench::knn
