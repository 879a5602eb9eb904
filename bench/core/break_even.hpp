// Break-even: for how few queries another rung is worth more than the advised one, because its build costs
// less.
//
// A tree is not worth building for a handful of queries. From build_s and the cost of one query of each set,
// both as measured: other.build + q·other.cost = advised.build + q·advised.cost. Known weakness: times are
// taken on warm caches, so that the first queries after a build cost more than this says.
#pragma once

#include "bench/core/advice.hpp"

namespace treeline::bench {

/// Queries of each set below which `other` costs less in all, its build included; 0 if it never does,
/// infinite if it always does, nothing if a build or query time of either is not known.
std::optional<double> break_even(const Rung& advised, const Rung& other);

/// For people: one line for brute force and one for the cheapest build among the others that meet the
/// tolerance. Empty if there is no advice.
std::string format_break_even(const Advice&);

}  // namespace treeline::bench
