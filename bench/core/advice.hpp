// Advice: model no more than the input needs. Of all rungs (method and knobs) the cheapest whose every stated
// error meets the tolerance on every query set, and why the next cheaper one does not.
//
// Whoever allows no error beyond the truth's own asks for a promise. Methods that claim to be approximate or
// stochastic, or bound their error by an epsilon, give none, however well they did on the queries at hand,
// and are not advised then.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bench/core/task.hpp"

namespace treeline::bench {

struct Rung {
  std::vector<Row> rows;  // one a query set
  double cost_ns = 0;     // median query times, summed over the query sets; infinite if one has none
  int ladder = 0;         // order at equal cost
  std::string limit;      // the first limit it breaks; empty: meets the tolerance
};

struct Advice {
  std::vector<Rung> rungs;            // by cost
  std::optional<std::size_t> chosen;  // none meets the tolerance: empty
  std::vector<std::string> alone;     // "set: rung at time", where one set alone would choose another rung
};

/// From rows of one block; those of other query sets than `sets` do not count. A rung that lacks a set is
/// left out. Errors are held against the tolerance, or against the truth's own error where that is larger.
Advice advise(const Task&, const std::vector<Row>&, const std::vector<std::string>& sets, double tolerance);

/// Whether each of so many query sets has a rung that meets the tolerance: one for all, or others for some.
bool answers(const Advice&, std::size_t sets);

/// Whether two rungs cannot be told apart in time: the sums of their intervals overlap, or one has none.
bool as_fast(const Rung&, const Rung&);

/// A warning where the machine had other work while these rows were timed, in words of the report; else
/// empty.
std::string format_busy(const std::vector<Row>&);

/// For people, with the number of queries below which a cheaper build is worth more (break_even.hpp). `again`
/// is a command line that measures the chosen rung alone; %FILTER% in it is replaced.
std::string format_advice(const Advice&, double tolerance, const std::string& again);

}  // namespace treeline::bench
