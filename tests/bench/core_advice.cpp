// The cheapest rung that meets the tolerance, and why the next cheaper one does not.
#include "bench/core/advice.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "bench/core/break_even.hpp"
#include "bench/core/table.hpp"
#include "core_fake_task.hpp"
#include "core_helper.hpp"

namespace treeline::bench {
namespace {

// In the fake, a batch of exact takes 40 ms, of close 8 (error 1e-3 or 2e-3), of rough 0.2 (0.1) or 2 (0.01),
// and of wrong 0.05 (0.5, though it claims to be exact): far enough apart for a busy machine.
Finished advise_fake(const std::string& tolerance) {
  return run_fake("--dataset counting:1000 --advise " + tolerance + quickly);
}

std::string line_with(const std::string& text, const std::string& word) {
  for (const std::string& line : lines_of(text))
    if (line.find(word) != std::string::npos) return line;
  return "";
}

TEST(AdviceProgram, PicksTheCheapestThatMeetsTheTolerance) {
  const std::pair<const char*, const char*> expected[] = {
      {"0", "  exact"},
      {"1e-4", "  exact"},
      {"1.5e-3", "  close, build scale=1.0"},
      {"0.06", "  rough, query slower=10.0"},
      {"0.2", "  rough ("},
      {"10", "  rough ("}};  // wrong is cheaper still, but wrong is never advised
  for (const auto& [tolerance, start] : expected) {
    // What is measured lasts microseconds: where others run, a method that is kept waiting may seem twenty
    // times slower.
    std::string out;
    for (int attempt = 0; attempt < 3; ++attempt) {
      const auto run = advise_fake(tolerance);
      EXPECT_EQ(run.status, 0) << run.err;
      ASSERT_GE(lines_of(run.out).size(), 2u) << run.out;
      out = run.out;
      if (lines_of(out)[1].starts_with(start)) break;
    }
    EXPECT_TRUE(lines_of(out)[1].starts_with(start)) << tolerance << "\n" << out;
  }
}

TEST(AdviceProgram, NamesTheRungBelowAndTheLimitItBreaks) {
  const std::string below = line_with(advise_fake("0.06").out, "below");
  EXPECT_NE(below.find("rough at"), std::string::npos) << below;
  EXPECT_NE(below.find("error of forward is 0.1"), std::string::npos) << below;
}

TEST(AdviceProgram, LineToRepeatMeasuresTheChosenRungAlone) {
  const TemporaryFolder folder;
  const std::string line = line_with(advise_fake("0.06").out, "again");
  const std::string arguments = line.substr(line.find("--dataset"));
  run_fake(arguments + " --rows " + (folder / "rows") + quickly);
  const auto rows = read_rows(folder / "rows");
  ASSERT_EQ(rows.size(), 2u) << line;
  for (const Json& row : rows) {
    EXPECT_EQ(row["method"], "rough");
    EXPECT_EQ(row["query_knobs"]["slower"], 10.0);
  }
}

TEST(AdviceProgram, SaysSoIfNoneMeetsIt) {
  const auto run = run_fake("--dataset counting:1000 --advise 0 --benchmark_filter=/rough/" + quickly);
  EXPECT_EQ(run.status, 1);
  EXPECT_NE(run.out.find("No method"), std::string::npos) << run.out;
}

TEST(AdviceProgram, FailsIfOursAnswersWronglyThoughAnotherMeetsTheTolerance) {
  const auto run = run_fake("--dataset counting:1000 --advise 0.2" + quickly, "FAKE_OURS_WRONG=1");
  EXPECT_NE(run.out.find("Advice for"), std::string::npos) << run.out;
  EXPECT_EQ(run.status, 1);
  EXPECT_NE(run.err.find("failures of ours"), std::string::npos) << run.err;
}

// The report's advice asks about the sets that rows name, which are those that --advise asks about.
TEST(AdviceProgram, RowsSayWhichSetsItAsks) {
  const TemporaryFolder folder;
  run_fake("--dataset counting:1000 --rows " + (folder / "rows") + quickly);
  run_fake("--scaling --rows " + (folder / "threads") + quickly);
  ASSERT_FALSE(read_rows(folder / "rows").empty());
  ASSERT_FALSE(read_rows(folder / "threads").empty());
  for (const Json& row : read_rows(folder / "rows")) EXPECT_EQ(row["advised"], true) << row;
  for (const Json& row : read_rows(folder / "threads")) EXPECT_EQ(row["advised"], false) << row;
}

// ---- on rows made by hand ------------------------------------------------------------------------------

Row rung_row(const std::string& method, const std::string& set, double ns, double error) {
  Row row;
  row.method = method, row.query_set = set, row.query_ns = ns;
  row.errors.error = row.errors.max = error;
  return row;
}

std::string chosen(const Advice& advice) {
  return advice.chosen ? advice.rungs[*advice.chosen].rows.front().method : "";
}

TEST(Advice, EverySetMustMeetTheTolerance) {
  const std::vector<Row> rows{rung_row("fast", "a", 1, 0), rung_row("fast", "b", 1, 0.1),
                              rung_row("slow", "a", 9, 0), rung_row("slow", "b", 9, 0),
                              rung_row("partial", "a", 1, 0)};
  const FakeTask task;
  EXPECT_EQ(chosen(advise(task, rows, {"a", "b"}, 0.01)), "slow");
  EXPECT_EQ(chosen(advise(task, rows, {"a", "b"}, 0.1)), "fast");
  EXPECT_EQ(chosen(advise(task, rows, {"a"}, 0.01)), "fast");
}

TEST(Advice, EveryStatedErrorCounts) {
  for (auto error : {&Errors::max, &Errors::p99, &Errors::mean, &Errors::bias}) {
    Row row = rung_row("m", "a", 1, 0);
    row.errors.*error = -0.5;
    if (error != &Errors::bias) row.errors.*error = 0.5;
    EXPECT_EQ(chosen(advise(FakeTask(), {row}, {"a"}, 0.4)), "");
    EXPECT_EQ(chosen(advise(FakeTask(), {row}, {"a"}, 0.5)), "m");
  }
}

TEST(Advice, RoundingBelowTheFloorIsNoError) {
  Row row = rung_row("m", "a", 1, 1e-8);
  EXPECT_EQ(chosen(advise(FakeTask(), {row}, {"a"}, 0)), "");
  row.errors.floor = 1e-7;
  EXPECT_EQ(chosen(advise(FakeTask(), {row}, {"a"}, 0)), "m");
}

TEST(Advice, BelowTheFloorOnlyAClaimWillDo) {
  for (const auto& [claim, advised] :
       {std::pair(Claim::exact, true), std::pair(Claim::bounded, true), std::pair(Claim::approximate, false),
        std::pair(Claim::stochastic, false)}) {
    std::vector<Row> rows{rung_row("m", "a", 1, 0), rung_row("m", "b", 1, 0)};
    for (Row& row : rows) row.claim = claim;
    rows[1].errors.floor = 1e-7;
    EXPECT_EQ(chosen(advise(FakeTask(), rows, {"a"}, 0)), advised ? "m" : "") << "no floor";
    EXPECT_EQ(chosen(advise(FakeTask(), rows, {"a"}, 1e-9)), "m") << "a sample tells enough";
    for (const double tolerance : {0.0, 1e-9, 1e-7})
      EXPECT_EQ(chosen(advise(FakeTask(), rows, {"a", "b"}, tolerance)), advised ? "m" : "");
    EXPECT_EQ(chosen(advise(FakeTask(), rows, {"a", "b"}, 2e-7)), "m");
  }
}

TEST(Advice, ABoundByResolutionPromisesNoExactAnswers) {
  Row row = rung_row("m", "a", 1, 0);
  row.claim = Claim::bounded;
  EXPECT_EQ(chosen(advise(FakeTask(), {row}, {"a"}, 0)), "m");
  row.build_knobs = {{"resolution", 64}};
  EXPECT_EQ(chosen(advise(FakeTask(), {row}, {"a"}, 0)), "");
  EXPECT_EQ(chosen(advise(FakeTask(), {row}, {"a"}, 1e-9)), "m");
}

TEST(Advice, ABoundByEpsilonPromisesNoExactAnswers) {
  Row row = rung_row("m", "a", 1, 0);
  row.claim = Claim::bounded, row.query_knobs = {{"epsilon", 0.5}};
  EXPECT_EQ(chosen(advise(FakeTask(), {row}, {"a"}, 0)), "");
  EXPECT_EQ(chosen(advise(FakeTask(), {row}, {"a"}, 1e-9)), "m");
  row.query_knobs = {{"epsilon", 0.0}};
  EXPECT_EQ(chosen(advise(FakeTask(), {row}, {"a"}, 0)), "m");
}

TEST(Advice, SaysThatItWasExactOnThisSampleOnly) {
  Row row = rung_row("m", "a", 1, 0);
  for (const auto& [claim, error, said] :
       {std::tuple(Claim::approximate, 0.0, true), std::tuple(Claim::exact, 0.0, false),
        std::tuple(Claim::approximate, 0.1, false)}) {
    row.claim = claim, row.errors.error = error, row.errors.max = error;
    const std::string text = format_advice(advise(FakeTask(), {row}, {"a"}, 0.5), 0.5, "");
    EXPECT_EQ(text.find("exact on this sample") != std::string::npos, said) << text;
  }
}

TEST(Advice, WhatATruthOfSamplesCannotTellApartIsNotExact) {
  Row row = rung_row("m", "a", 1, 0);
  row.claim = Claim::stochastic, row.errors.error = row.errors.max = 5e-4, row.errors.floor = 1e-3;
  const std::string text = format_advice(advise(FakeTask(), {row}, {"a"}, 0.5), 0.5, "");
  EXPECT_NE(text.find("as right as the truth can tell"), std::string::npos) << text;
  EXPECT_EQ(text.find("exact on this sample"), std::string::npos) << text;
}

TEST(Advice, SaysThatAClaimIsTooWeakUnlessAnErrorSaysMore) {
  std::vector<Row> rows{rung_row("m", "a", 1, 0), rung_row("m", "b", 1, 0)};
  for (Row& row : rows) row.claim = Claim::stochastic;
  EXPECT_NE(advise(FakeTask(), rows, {"a", "b"}, 0).rungs[0].limit.find("its claim is stochastic"),
            std::string::npos);
  rows[1].errors.error = 0.25;
  EXPECT_NE(advise(FakeTask(), rows, {"a", "b"}, 0).rungs[0].limit.find("error of b is 0.25"),
            std::string::npos);
}

Row with_interval(Row row, double low, double high) {
  row.query_ns_low = low, row.query_ns_high = high, row.samples = {low, *row.query_ns, high};
  return row;
}

TEST(Advice, TellsTheIntervalAndWhatIsAsFast) {
  const std::vector<Row> rows{with_interval(rung_row("best", "a", 100, 0), 90, 120),
                              with_interval(rung_row("near", "a", 110, 0), 105, 130),
                              with_interval(rung_row("far", "a", 200, 0), 190, 210)};
  const std::string text = format_advice(advise(FakeTask(), rows, {"a"}, 0.1), 0.1, "");
  EXPECT_NE(line_with(text, "cost").find("100 ns [90, 120]"), std::string::npos) << text;
  EXPECT_NE(line_with(text, "close").find("near at 110 ns [105, 130]"), std::string::npos) << text;
  EXPECT_EQ(text.find("far"), std::string::npos) << text;
}

// On a tiny input everything is as fast as everything else; a screen of that would hide the advice.
TEST(Advice, NamesAFewOfWhatIsAsFastAndCountsTheRest) {
  std::vector<Row> rows;
  for (int i = 0; i < 7; ++i)
    rows.push_back(with_interval(rung_row("m" + std::to_string(i), "a", 100 + i, 0), 90, 120));
  const auto closes = [&] {
    std::vector<std::string> out;
    for (const auto& line : lines_of(format_advice(advise(FakeTask(), rows, {"a"}, 0.1), 0.1, "")))
      if (line.starts_with("  close")) out.push_back(line);
    return out;
  };
  ASSERT_EQ(closes().size(), 5u);
  EXPECT_EQ(closes().back(), "  close  2 more rungs meet it, too");
  rows.pop_back();
  EXPECT_EQ(closes().back(), "  close  1 more rung meets it, too");
  rows.pop_back();
  EXPECT_EQ(closes().size(), 4u);
}

TEST(Advice, IntervalsOfSeveralSetsAddUp) {
  const auto rung = [](double low_a, double high_a, double low_b, double high_b) {
    Rung r;
    r.rows = {with_interval(rung_row("m", "a", 100, 0), low_a, high_a),
              with_interval(rung_row("m", "b", 50, 0), low_b, high_b)};
    return r;
  };
  EXPECT_TRUE(as_fast(rung(90, 110, 45, 55), rung(110, 120, 50, 60)));   // 135 to 165, 160 to 180
  EXPECT_FALSE(as_fast(rung(90, 110, 45, 55), rung(110, 120, 56, 60)));  // 166 to 180
}

TEST(Advice, NamesAnotherRungForASetAlone) {
  const std::vector<Row> rows{rung_row("even", "a", 50, 0), rung_row("even", "b", 50, 0),
                              rung_row("for_a", "a", 10, 0), rung_row("for_a", "b", 500, 0)};
  const Advice advice = advise(FakeTask(), rows, {"a", "b"}, 0.1);
  EXPECT_EQ(chosen(advice), "even");
  EXPECT_EQ(advice.alone, std::vector<std::string>{"a: for_a at 10 ns"});
  EXPECT_NE(line_with(format_advice(advice, 0.1, ""), "alone").find("a: for_a"), std::string::npos);
}

TEST(Advice, AnswersWhereEachSetHasARungOfItsOwn) {
  const std::vector<std::string> both{"a", "b"};
  const auto answered = [&](double even_b, double for_a_b) {
    const std::vector<Row> rows{rung_row("even", "a", 50, 0.5), rung_row("even", "b", 50, even_b),
                                rung_row("for_a", "a", 10, 0), rung_row("for_a", "b", 10, for_a_b)};
    const Advice advice = advise(FakeTask(), rows, both, 0.1);
    return std::pair(advice.chosen.has_value(), answers(advice, both.size()));
  };
  EXPECT_EQ(answered(0, 0.5), std::pair(false, true));     // one for a, the other for b
  EXPECT_EQ(answered(0.5, 0.5), std::pair(false, false));  // none for b
  EXPECT_EQ(answered(0.5, 0), std::pair(true, true));
  EXPECT_FALSE(answers(advise(FakeTask(), {rung_row("m", "a", 1, 0.5)}, {"a"}, 0.1), 1));
}

TEST(Advice, WarnsOfABusyMachineAsTheReportDoes) {
  std::vector<Row> rows(40, rung_row("m", "a", 100, 0));
  for (Row& row : rows) row.query_cpu_ns = 95;
  EXPECT_EQ(format_busy(rows), "");
  rows[0].query_cpu_ns = 80;  // one in forty: chance
  EXPECT_EQ(format_busy(rows), "");
  rows[1].query_cpu_ns = rows[2].query_cpu_ns = 80;
  EXPECT_NE(format_busy(rows).find("in 3 of 40 timed cells"), std::string::npos) << format_busy(rows);
  for (Row& row : rows) row.threads = 2;  // a thread's share of the processor says little
  EXPECT_EQ(format_busy(rows), "");
}

TEST(Advice, CountsOneAndMany) {
  EXPECT_EQ(counted(1, "element"), "1 element");
  EXPECT_EQ(counted(0, "element"), "0 elements");
  EXPECT_EQ(counted(2, "query", "queries"), "2 queries");
  Row row = rung_row("m", "a", 1, 0);
  row.n = 1;
  EXPECT_NE(format_advice(advise(FakeTask(), {row}, {"a"}, 0), 0, "").find("(1 element)"), std::string::npos);
}

TEST(Advice, OnlyWhatIsOkIsAdvised) {
  Row row = rung_row("m", "a", 1, 0);
  row.status = Status::wrong;
  EXPECT_EQ(chosen(advise(FakeTask(), {row}, {"a"}, 1)), "");
  row.status = Status::ok, row.errors.error.reset(),
  row.errors.max.reset();  // nobody knows how far off it is
  EXPECT_EQ(chosen(advise(FakeTask(), {row}, {"a"}, 1)), "");
}

// ---- break-even ----------------------------------------------------------------------------------------

Row built_row(const std::string& method, const std::string& family, double build_s, double ns,
              double error = 0) {
  Row row = rung_row(method, "a", ns, error);
  row.family = family, row.build_s = build_s;
  return row;
}

Advice advised_of(const std::vector<Row>& rows) { return advise(FakeTask(), rows, {"a"}, 1e-3); }

const Rung& rung_of(const Advice& advice, const std::string& method) {
  for (const Rung& rung : advice.rungs)
    if (rung.rows.front().method == method) return rung;
  throw std::out_of_range(method);
}

TEST(BreakEven, IsWhereBuildAndQueriesTogetherCostTheSame) {
  const Advice advice =
      advised_of({built_row("tree", "kd", 0.5, 100), built_row("scan", "brute", 0.1, 1100)});
  const Rung &tree = rung_of(advice, "tree"), &scan = rung_of(advice, "scan");
  const double queries = *break_even(tree, scan);
  const auto total_ns = [](const Rung& rung, double n) {
    return *rung.rows.front().build_s * 1e9 + n * rung.cost_ns;
  };
  EXPECT_DOUBLE_EQ(total_ns(tree, queries), total_ns(scan, queries));
  EXPECT_LT(total_ns(scan, queries - 1), total_ns(tree, queries - 1));
  EXPECT_GT(total_ns(scan, queries + 1), total_ns(tree, queries + 1));
}

TEST(BreakEven, NeverAndAlwaysAndUnknown) {
  const Advice advice =
      advised_of({built_row("tree", "kd", 0.5, 100), built_row("slow_build", "kd", 0.9, 200),
                  built_row("same", "kd", 0.2, 100), rung_row("unknown", "a", 300, 0)});
  const Rung& tree = rung_of(advice, "tree");
  EXPECT_EQ(break_even(tree, rung_of(advice, "slow_build")), 0);
  EXPECT_TRUE(std::isinf(*break_even(tree, rung_of(advice, "same"))));
  EXPECT_FALSE(break_even(tree, rung_of(advice, "unknown")));
}

TEST(BreakEven, NamesBruteForceAndTheCheapestBuildThatMeetsTheTolerance) {
  const std::string text =
      format_break_even(advised_of({built_row("tree", "kd", 0.5, 100), built_row("scan", "brute", 0.1, 1100),
                                    built_row("cheap", "kd", 0.3, 300), built_row("cheaper", "kd", 0.2, 400),
                                    built_row("cheapest_but_rough", "kd", 0.01, 50, 0.5)}));
  const auto lines = lines_of(text);
  ASSERT_EQ(lines.size(), 2u) << text;
  EXPECT_NE(lines[0].find("up to 400000 queries of each set scan"), std::string::npos) << text;
  EXPECT_NE(lines[1].find("up to 1000000 queries of each set cheaper"), std::string::npos) << text;
}

TEST(BreakEven, SaysWhatWasNotMeasuredOrNeverWins) {
  const std::string none = format_break_even(advised_of({built_row("tree", "kd", 0.5, 100)}));
  EXPECT_NE(none.find("no brute force"), std::string::npos) << none;
  EXPECT_NE(none.find("no cheaper build"), std::string::npos) << none;
  const std::string never = format_break_even(
      advised_of({built_row("tree", "kd", 0.5, 100), built_row("scan", "brute", 0.6, 900)}));
  EXPECT_NE(never.find("brute force builds no faster (scan: build 600 ms)"), std::string::npos) << never;
  EXPECT_EQ(format_break_even(advised_of({built_row("rough", "kd", 0.5, 100, 1)})), "");
}

TEST(BreakEven, StandsInTheAdvice) {
  const std::string out = advise_fake("0.06").out;
  EXPECT_NE(out.find("  few  "), std::string::npos) << out;
}

}  // namespace
}  // namespace treeline::bench
