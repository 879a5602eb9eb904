#include "bench/knn_nd/metric.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/tolerances.hpp"

namespace treeline::bench::knn_nd {

double rounding_floor(std::size_t columns) {
  return static_cast<double>(geometry::tolerance::gamma<float>(static_cast<int>(columns) + 2));
}

namespace {

void blame(Errors& e, std::size_t query, const std::string& what) {
  if (!e.within_claim) return;
  e.within_claim = false;
  e.reason = "query " + std::to_string(query) + ": " + what;
}

// The distances of one row of answers, sorted, and what is wrong with its ids.
struct Answered {
  std::vector<double> distances;
  std::size_t invalid = 0, repeated = 0;
};

Answered answered(RowsView rows, std::span<const float> query, std::span<const Id> ids) {
  Answered r;
  std::vector<Id> seen;
  for (const Id id : ids) {
    if (id == accel::no_id) continue;
    if (id >= rows.rows || !is_finite(rows[id])) {
      ++r.invalid;
    } else {
      seen.push_back(id);
    }
  }
  std::sort(seen.begin(), seen.end());
  const auto last = std::unique(seen.begin(), seen.end());
  r.repeated = static_cast<std::size_t>(seen.end() - last);
  seen.erase(last, seen.end());
  for (const Id id : seen) r.distances.push_back(std::sqrt(distance2(rows[id], query)));
  std::sort(r.distances.begin(), r.distances.end());
  return r;
}

double excess_of(double distance, double truth) {
  if (distance == truth) return 0;
  return truth > 0 ? (distance - truth) / truth : 1.0;
}

// Sums over the queries.
struct Totals {
  std::size_t wanted = 0, met = 0, missing = 0;
  double unsigned_excess = 0, signed_excess = 0, largest = 0, worst_recall = 1;

  void add_query(std::size_t wanted_here, std::size_t met_here) {
    wanted += wanted_here, met += met_here;
    if (wanted_here > 0)
      worst_recall = std::min(worst_recall, static_cast<double>(met_here) / static_cast<double>(wanted_here));
  }
  void add_excess(double excess) {
    largest = std::max(largest, std::abs(excess));
    signed_excess += std::min(excess, 1.0), unsigned_excess += std::min(std::abs(excess), 1.0);
  }
  void fill(Errors& e) const {
    if (wanted == 0) {
      e.error = e.mean = e.bias = 0, e.floor = 0;
      return;
    }
    const double n = static_cast<double>(wanted), recall = static_cast<double>(met) / n;
    e.error = static_cast<double>(wanted - met) / n;
    e.mean = unsigned_excess / n, e.bias = signed_excess / n;
    e.floor = 0.5 / n;
    e.extra["knn_nd_recall"] = recall;
    e.extra["knn_nd_worst_recall"] = worst_recall;
    e.extra["knn_nd_excess_max"] = largest;
    e.extra["knn_nd_missing"] = static_cast<double>(missing) / n;
  }
};

}  // namespace

Errors errors_of(RowsView rows, RowsView queries, std::size_t k, std::span<const Id> ids, const Truth& truth,
                 Claim claim, double epsilon) {
  Totals totals;
  Errors e;
  const double floor = rounding_floor(rows.columns);
  for (std::size_t i = 0; i < queries.rows; ++i) {
    const auto answers = ids.subspan(i * k, k);
    const bool silent = std::all_of(answers.begin(), answers.end(), [](Id id) { return id == accel::no_id; });
    if (silent && !is_finite(queries[i])) continue;
    if (!truth.answerable[i]) {
      totals.add_query(k, 0);
      for (std::size_t j = 0; j < k; ++j) totals.add_excess(1);
      blame(e, i, "returned neighbours of a query that is not a number");
      continue;
    }
    const std::size_t expected = std::min(k, truth.k);
    const auto right = truth.row(i).first(expected);
    const Answered got = answered(rows, queries[i], answers);
    double largest = 0;
    std::size_t met = 0;
    for (std::size_t j = 0; j < expected; ++j) {
      const bool there = j < got.distances.size();
      const double excess = there ? excess_of(got.distances[j], right[j]) : 1.0;
      largest = std::max(largest, std::abs(excess));
      totals.add_excess(excess);
      totals.missing += there ? 0u : 1u;
      if (there && got.distances[j] <= right[expected - 1] * (1 + floor)) ++met;
    }
    totals.add_query(expected, met);
    if (got.invalid > 0) blame(e, i, std::to_string(got.invalid) + " invalid ids");
    if (got.repeated > 0) blame(e, i, std::to_string(got.repeated) + " repeated ids");
    if (got.distances.size() < expected)
      blame(e, i,
            std::to_string(expected - got.distances.size()) + " of " + std::to_string(expected) + " missing");
    const double allowed = claim == Claim::exact     ? floor
                           : claim == Claim::bounded ? epsilon + (1 + epsilon) * floor
                                                     : std::numeric_limits<double>::infinity();
    if (largest > allowed)
      blame(e, i, "a distance is off by " + std::to_string(largest) + " relative, beyond what is claimed");
  }
  totals.fill(e);
  return e;
}

}  // namespace treeline::bench::knn_nd
