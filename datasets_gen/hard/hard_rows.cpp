#include "datasets_gen/hard/hard_rows.hpp"

#include <limits>

#include "datasets_gen/portable.hpp"

namespace treeline::datasets {
namespace {

constexpr float nan = std::numeric_limits<float>::quiet_NaN(),
                endless = std::numeric_limits<float>::infinity();

Vectors random_rows(std::uint64_t seed, std::size_t n, std::size_t columns) {
  Vectors r;
  r.columns = columns;
  for (std::size_t i = 0; i < n; ++i) {
    Draws draws(seed, i);
    for (std::size_t a = 0; a < columns; ++a) r.scalars.push_back(static_cast<float>(draws.uniform(-1, 1)));
  }
  return r;
}
template <class F>
Vectors mapped(Vectors v, F f) {
  for (std::size_t i = 0; i < v.scalars.size(); ++i)
    v.scalars[i] = f(v.scalars[i], i / v.columns, i % v.columns);
  return v;
}

HardRows named(std::string name, std::string source, std::string law, Vectors rows, Vectors queries) {
  HardRows c;
  c.name = std::move(name), c.source = std::move(source), c.law = std::move(law);
  c.rows = std::move(rows), c.queries = std::move(queries);
  return c;
}

// Ties, duplicates, and too few rows.
void add_few_and_equal(std::vector<HardRows>& all) {
  const std::string as_many = "all n rows are returned where n < k, each once, in order of distance";
  const std::string by_distance =
      "the k distances equal those of brute force; which of equals is returned is free";
  all.push_back(named("rows_empty", "measured: FLANN crashes on an empty cloud", "nothing is found",
                      random_rows(101, 0, 16), random_rows(102, 10, 16)));
  all.push_back(named("rows_one", "derivation: a root that is a leaf", as_many, random_rows(103, 1, 16),
                      random_rows(104, 10, 16)));
  all.push_back(named("rows_k_above_n", "derivation: a search that stops early must still find n rows",
                      as_many, random_rows(105, 50, 16), random_rows(106, 20, 16)));
  all.back().k = 64;
  const Vectors few = random_rows(107, 60, 24);
  all.push_back(named(
      "rows_all_equal", "measured: equal points overflow stacks, or are scanned one by one",
      "all k neighbours are at the one distance there is",
      mapped(random_rows(107, 4000, 24), [&](float, std::size_t, std::size_t a) { return few.scalars[a]; }),
      random_rows(108, 20, 24)));
  all.push_back(named("rows_duplicates", "kiddo #78: a leaf that overflows with equal points cannot be split",
                      by_distance,
                      mapped(random_rows(109, 6000, 24),
                             [&](float, std::size_t i, std::size_t a) { return few.row(i % 60)[a]; }),
                      few));
  all.back().k = 32;
  const auto sign = [](float x, std::size_t, std::size_t) { return x < 0 ? 0.f : 1.f; };
  all.push_back(named("rows_binary", "derivation: squared distances are whole numbers of 17 values",
                      by_distance, mapped(random_rows(111, 4000, 16), sign),
                      mapped(random_rows(112, 100, 16), sign)));
  all.push_back(named("rows_one_column", "derivation: nothing to choose an axis from", by_distance,
                      random_rows(113, 4000, 1), random_rows(114, 100, 1)));
  const auto two_columns = [](float x, std::size_t, std::size_t a) { return a == 7 || a == 31 ? x : 0.25f; };
  all.push_back(named("rows_constant_columns", "derivation: 30 of 32 columns have a variance of 0",
                      by_distance, mapped(random_rows(115, 4000, 32), two_columns),
                      random_rows(116, 100, 32)));
}

// Scale and place.
void add_scales(std::vector<HardRows>& all) {
  const std::string right = "the k distances equal those of brute force up to rounding";
  const auto at_scale = [&](const char* name, const char* source, float scale, float offset) {
    const auto move = [&](float x, std::size_t, std::size_t) { return x * scale + offset; };
    all.push_back(named(name, source, right, mapped(random_rows(121, 4000, 16), move),
                        mapped(random_rows(122, 100, 16), move)));
  };
  at_scale("rows_huge", "measured: squared distances overflow beyond 1e19", 3e37f, 0);
  at_scale("rows_tiny", "measured: squared distances vanish below 1e-22", 1e-25f, 0);
  at_scale("rows_far", "faiss #297: norms minus twice the product cancel far from the origin", 1, 4096);
  all.push_back(named("rows_one_outlier", "derivation: bounds and scales taken from the largest row", right,
                      mapped(random_rows(123, 4000, 16),
                             [](float x, std::size_t i, std::size_t) { return i == 1000 ? 1e30f : x; }),
                      random_rows(124, 100, 16)));
}

void add_not_finite(std::vector<HardRows>& all) {
  const auto add = [&](const char* name, const char* source, const char* law, auto spoil_row,
                       auto spoil_query) {
    all.push_back(named(name, source, law, mapped(random_rows(131, 4000, 16), spoil_row),
                        mapped(random_rows(132, 100, 16), spoil_query)));
    all.back().expect = Expect::answers_or_refuses;
  };
  const auto as_is = [](float x, std::size_t, std::size_t) { return x; };
  const char* finite_part = "refused with a clear error, or the neighbours among the finite rows";
  add(
      "rows_some_nan", "FLANN #320: filter first", finite_part,
      [](float x, std::size_t i, std::size_t a) { return i % 500 == 3 && a == 5 ? nan : x; }, as_is);
  add(
      "rows_first_nan", "measured in three dimensions: a box that starts from NaN never grows", finite_part,
      [](float x, std::size_t i, std::size_t) { return i == 0 ? nan : x; }, as_is);
  add(
      "rows_infinite", "derivation: the mean of a column is infinite", finite_part,
      [](float x, std::size_t i, std::size_t a) { return i == 77 && a == 2 ? endless : x; }, as_is);
  add("rows_nan_query", "measured in three dimensions: arbitrary ids",
      "refused with a clear error, or nothing found", as_is,
      [](float x, std::size_t, std::size_t a) { return a == 4 ? nan : x; });
  add("rows_infinite_query", "derivation: every distance is infinite, so all rows tie",
      "refused with a clear error, or every distance infinite", as_is,
      [](float x, std::size_t, std::size_t a) { return a == 4 ? -endless : x; });
}

}  // namespace

std::vector<HardRows> hard_rows() {
  std::vector<HardRows> all;
  add_few_and_equal(all);
  add_scales(all);
  add_not_finite(all);
  return all;
}

}  // namespace treeline::datasets
