// How far answers are from the truth. Ids come in, distances are derived here, in double.
//
// error: 1 - recall over all queries: the share of the true neighbours that no answer meets by distance
//   (within rounding of the true k-th or nearer), so that ties are free. A missing, repeated or invalid id
//   meets nothing.
// mean, bias: the relative excess of the sorted distances over the true ones, unsigned and signed, each cut
//   off at 1, where also what is missing counts. knn_nd_excess_max is the largest of them, not cut off;
//   knn_nd_worst_recall that of the worst query.
// error_max and error_p99 stay empty: recall of a single query moves in steps of 1/k, and no search that
//   stops early promises it, so an advice that had to keep it would never leave exact search.
// floor: half of what one missed neighbour makes; a smaller error is none.
// A query with a NaN has no right answer but none: any id is a full error. From an infinite query all rows
// tie; returning nothing is as right as returning any of them.
#pragma once

#include "bench/core/row.hpp"
#include "bench/knn_nd/truth.hpp"

namespace treeline::bench::knn_nd {

/// Rounding floor of a search that compares float distances of so many columns, relative: a squared distance
/// summed one by one carries columns + 2 roundings, hence a returned one exceeds the true one by twice that,
/// and the distance by half as much again.
double rounding_floor(std::size_t columns);

/// `ids` holds rows of k. Claim exact: wrong if a distance exceeds the true one by more than rounding;
/// bounded: by more than epsilon and rounding. Any claim: wrong for missing, repeated and invalid ids.
Errors errors_of(RowsView rows, RowsView queries, std::size_t k, std::span<const Id> ids, const Truth&, Claim,
                 double epsilon = 0);

}  // namespace treeline::bench::knn_nd
