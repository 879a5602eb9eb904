// How far answers are from the truth. Ids come in, distances are derived here, in double.
//
// nearest: the answered points of a query are sorted by distance and the i-th is compared with the true i-th:
//   excess = (distance - true) / true. A missing, repeated or invalid id counts as 1, and so does a positive
//   distance where the true one is 0. A query's error is its largest excess, but at most 1: twice as far is
//   no better than missing. error and p99 are taken over the queries' errors; max is the largest excess, not
//   cut off at 1; mean and bias are the mean excess over all answers (each cut off at 1), unsigned and
//   signed. Ids are never compared, so ties are free.
// within, inside: error of a query = (missing + surplus) / right ones (1 if none is right), surplus including
//   repeated and invalid ids; ids on the border count neither way. bias is signed: surplus minus missing.
// A query with a NaN has no right answer but none: any id is a full error. From an infinite query all points
// tie; returning nothing is as right as returning any of them.
#pragma once

#include "bench/core/row.hpp"
#include "bench/knn/truth.hpp"

namespace treeline::bench::knn {

/// Rounding floor of a search that compares float distances, relative: squared distances carry one rounding
/// for the difference (twice, by the square), one for the square and two for the sums, hence a returned one
/// exceeds the true one by at most 2·gamma(5), and the distance by gamma(5).
double float_floor();

/// The same where points and queries are doubles: the search rounds as above with 2^-53, and so does the
/// truth that it is held against, and the distance derived here.
double double_floor();

/// `ids` holds rows of k. knn_recall: share of the true answers that are met by distance, ties allowed
/// (distance ≤ true k-th · (1 + 1e-6)); knn_recall_1pct, knn_recall_10pct: the same for distances up to 1 %
/// and 10 % above it (Aumüller, Bernhardsson and Faithfull 2020); knn_missing: share of them that are
/// missing, repeated or invalid; knn_wrong: share of the queries whose answer errs beyond the floor. Claim
/// exact: wrong above the floor. bounded: wrong above `bound` and the floor together. Otherwise: wrong only
/// for missing, repeated and invalid ids.
Errors nearest_errors(std::span<const geometry::Vec3f> points, std::span<const geometry::Vec3f> queries,
                      std::size_t k, std::span<const accel::Id> ids, const NearestTruth& truth, Claim claim,
                      double bound = 0);

/// The same over doubles.
Errors nearest_errors(std::span<const geometry::Vec3d> points, std::span<const geometry::Vec3d> queries,
                      std::size_t k, std::span<const accel::Id> ids, const NearestTruth& truth, Claim claim,
                      double bound = 0);

/// knn_recall: share of the right answers that are found; knn_missing, knn_surplus: per right answer, over
/// all queries; knn_wrong: share of the queries with any of either. Claim exact: wrong for any of either.
/// Otherwise: wrong for surplus only; where the method says that it rounds the points, a border moves for
/// some, and only repeated ids are wrong.
Errors range_errors(const accel::Lists<accel::Id>& ids, const RangeTruth& truth, Claim claim,
                    bool rounds_points = false);

}  // namespace treeline::bench::knn
