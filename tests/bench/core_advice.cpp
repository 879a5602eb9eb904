// The cheapest rung that meets the tolerance, and why the next cheaper one does not.
#include "bench/core/advice.hpp"

#include <gtest/gtest.h>

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
    const auto run = advise_fake(tolerance);
    EXPECT_EQ(run.status, 0) << run.err;
    ASSERT_GE(lines_of(run.out).size(), 2u) << run.out;
    EXPECT_TRUE(lines_of(run.out)[1].starts_with(start)) << tolerance << "\n" << run.out;
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

TEST(Advice, SaysThatAClaimIsTooWeakUnlessAnErrorSaysMore) {
  std::vector<Row> rows{rung_row("m", "a", 1, 0), rung_row("m", "b", 1, 0)};
  for (Row& row : rows) row.claim = Claim::stochastic;
  EXPECT_NE(advise(FakeTask(), rows, {"a", "b"}, 0).rungs[0].limit.find("its claim is stochastic"),
            std::string::npos);
  rows[1].errors.error = 0.25;
  EXPECT_NE(advise(FakeTask(), rows, {"a", "b"}, 0).rungs[0].limit.find("error of b is 0.25"),
            std::string::npos);
}

TEST(Advice, OnlyWhatIsOkIsAdvised) {
  Row row = rung_row("m", "a", 1, 0);
  row.status = Status::wrong;
  EXPECT_EQ(chosen(advise(FakeTask(), {row}, {"a"}, 1)), "");
  row.status = Status::ok, row.errors.error.reset(),
  row.errors.max.reset();  // nobody knows how far off it is
  EXPECT_EQ(chosen(advise(FakeTask(), {row}, {"a"}, 1)), "");
}

}  // namespace
}  // namespace treeline::bench
