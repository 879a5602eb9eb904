// However a method behaves, each of its cells ends in a row that says so.
#include <gtest/gtest.h>

#include <set>

#include "bench/core/probe.hpp"
#include "core_fake_task.hpp"
#include "core_helper.hpp"

namespace treeline::bench {
namespace {

using Counts = std::map<std::string, int>;

TEST(Statuses, OfAnOrdinaryBlock) {
  const TemporaryFolder folder;
  const auto run = run_fake("--dataset counting:1000 --rows " + (folder / "rows") + quickly);
  EXPECT_EQ(run.status, 0) << run.err;  // only a peer is wrong
  const auto rows = read_rows(folder / "rows");
  const auto found = statuses_by_method(rows);
  EXPECT_EQ(found.at("exact"), (Counts{{"ok", 2}}));
  EXPECT_EQ(found.at("close"), (Counts{{"ok", 4}}));  // two build knobs
  EXPECT_EQ(found.at("rough"), (Counts{{"ok", 4}}));  // two query knobs
  EXPECT_EQ(found.at("wrong"), (Counts{{"wrong", 2}}));
  EXPECT_EQ(found.at("refuses"), (Counts{{"refused", 2}}));
  EXPECT_EQ(found.at("unable"), (Counts{{"ok", 1}, {"unsupported", 1}}));
  EXPECT_EQ(found.at("small_only"), (Counts{{"unsupported", 2}}));
  EXPECT_EQ(found.at("greedy"), (Counts{{"out_of_memory", 2}}));
  EXPECT_EQ(found.at("absent"), (Counts{{"not_built", 2}}));
  EXPECT_EQ(one_row(rows, "refuses")["reason"], "point 3 is not finite");
  EXPECT_NE(one_row(rows, "absent")["reason"].get<std::string>().find("LibAbsent"), std::string::npos);
  EXPECT_NE(one_row(rows, "wrong")["reason"].get<std::string>().find("query 0"), std::string::npos);
}

TEST(Statuses, RowsCarryTimesErrorsAndOrigin) {
  const TemporaryFolder folder;
  run_fake("--dataset counting:1000 --seed 7 --rows " + (folder / "rows") +
           " --benchmark_min_time=0.001 --benchmark_repetitions=3");
  const auto rows = read_rows(folder / "rows");
  const Json exact = one_row(rows, "exact"), close = one_row(rows, "close");
  EXPECT_EQ(exact["block"], "counting:1000");
  EXPECT_EQ(exact["seed"], 7);
  EXPECT_EQ(exact["samples"].size(), 3u);
  EXPECT_GE(exact["query_ns"].get<double>(), 40000.0);  // it works 40 ms for 1000 queries
  EXPECT_LE(exact["query_ns_low"], exact["query_ns"]);
  EXPECT_LE(exact["query_ns"], exact["query_ns_high"]);
  EXPECT_GT(exact["query_cpu_ns"].get<double>(), 0.0);
  EXPECT_GE(exact["build_s"].get<double>(), 0.0);
  EXPECT_EQ(exact["work_nodes"], 3.0);
  EXPECT_TRUE(close["work_nodes"].is_null());
  EXPECT_NEAR(close["error"].get<double>(), 1e-3, 1e-9);
  EXPECT_TRUE(close["bias"].is_null());  // the task said NaN
  EXPECT_EQ(close["fake_answers"], 1000);
  EXPECT_FALSE(exact["commit"].get<std::string>().empty());
}

TEST(Statuses, EveryWayToFailAHardCase) {
  const TemporaryFolder folder;
  const auto run = run_fake(
      "--stress --stress-seconds 3 --stress-bytes 300000000 --rows " + (folder / "rows"), "FAKE_WILD=1");
  EXPECT_EQ(run.status, 0) << run.err;
  const auto rows = read_rows(folder / "rows");
  const auto found = statuses_by_method(rows);  // two cases with two query sets each
  EXPECT_EQ(found.at("exact"), (Counts{{"ok", 4}}));
  EXPECT_EQ(found.at("wrong"), (Counts{{"wrong", 4}}));
  EXPECT_EQ(found.at("refuses"), (Counts{{"refused", 4}}));
  EXPECT_EQ(found.at("unable"), (Counts{{"ok", 2}, {"unsupported", 2}}));
  EXPECT_EQ(found.at("segfault"), (Counts{{"ok", 2}, {"crashed", 2}}));
  EXPECT_EQ(found.at("segfault_build"), (Counts{{"crashed", 4}}));
  EXPECT_EQ(found.at("segfault_late"), (Counts{{"ok", 4}, {"crashed", 4}}));
  EXPECT_EQ(found.at("aborts"), (Counts{{"crashed", 4}}));
  EXPECT_EQ(found.at("exits"), (Counts{{"crashed", 4}}));
  EXPECT_EQ(found.at("hangs"), (Counts{{"timeout", 4}}));
#ifndef TREELINE_SANITIZED  // no limit on memory there
  EXPECT_EQ(found.at("devours"), (Counts{{"out_of_memory", 4}}));
#endif
  EXPECT_EQ(found.at("absent"), (Counts{{"not_built", 4}}));
  // Its second build faces hard cases up to n = 40 only: the rows of larger ones say so.
  EXPECT_EQ(found.at("close"), (Counts{{"ok", 4}, {"unsupported", 4}}));
  for (const Json& row : rows)
    if (row["method"] == "close" && row["status"] == "unsupported") {
      EXPECT_EQ(row["build_knobs"]["scale"], 2.0);
      EXPECT_NE(row["reason"].get<std::string>().find("40"), std::string::npos) << row["reason"];
    }
  EXPECT_NE(one_row(rows, "aborts")["reason"].get<std::string>().find("the wolf is at the door"),
            std::string::npos);
  std::set<std::string> keys;
  for (const Json& row : rows) EXPECT_TRUE(keys.insert(Row::from_json(row).key()).second);
}

// A user's file may crash a peer: that costs its rows, and no others.
TEST(Statuses, PeersThatCrashOnAFileCostTheirRowsOnly) {
  const TemporaryFolder folder;
  std::ofstream(folder / "f.xyz") << "1 2 3\n1 2 3\n4 5 6\n";
  const std::string arguments = "--input " + (folder / "f.xyz") + quickly +
                                "--benchmark_filter='/(exact|rough|refuses|segfault.*|aborts|exits)/' ";
  const std::string rows = "--rows " + (folder / "rows");
  const auto run = run_fake(arguments + rows, "FAKE_WILD=1");
  EXPECT_EQ(run.status, 0) << run.err;
  const auto found = statuses_by_method(read_rows(folder / "rows"));
  EXPECT_EQ(found.at("exact"), (Counts{{"ok", 2}}));
  EXPECT_EQ(found.at("rough"), (Counts{{"ok", 4}}));
  EXPECT_EQ(found.at("refuses"), (Counts{{"refused", 2}}));
  for (const char* method : {"segfault", "segfault_build", "aborts", "exits"})
    EXPECT_EQ(found.at(method), (Counts{{"crashed", 2}})) << method;
  EXPECT_EQ(found.at("segfault_late"), (Counts{{"crashed", 4}})) << "at its second query knobs";
  EXPECT_NE(one_row(read_rows(folder / "rows"), "segfault_late")["reason"].get<std::string>().find(
                "(in forward late=true)"),
            std::string::npos);
  EXPECT_NE(one_row(read_rows(folder / "rows"), "aborts")["reason"].get<std::string>().find("wolf"),
            std::string::npos);

  const std::string before = read_text(folder / "rows");
  EXPECT_EQ(run_fake(arguments + rows + " --resume", "FAKE_WILD=1 FAKE_LOG=" + (folder / "log")).status, 0);
  EXPECT_EQ(read_text(folder / "rows"), before);
  EXPECT_FALSE(std::filesystem::exists(folder / "log"));

  const auto advice = run_fake(arguments + "--advise 0", "FAKE_WILD=1");
  EXPECT_EQ(advice.status, 0) << advice.err;
  EXPECT_NE(advice.out.find("  exact"), std::string::npos) << advice.out;
}

TEST(Statuses, TrialEndsPeersThatHang) {
  setenv("FAKE_WILD", "1", 1);
  const FakeTask task;
  unsetenv("FAKE_WILD");
  const BlockSpec spec{"counting", 3, false};
  const RowFile none;
  const Filter filter("/(exact|hangs|aborts)/");
  const Broken broken = try_peers(task, spec, [&] { return task.open(spec, RunContext()); },
                                  {filter, none, {}, 1}, {.seconds = 1, .memory = 0});
  std::map<std::string, Status> found;
  for (const auto& [build, ending] : broken) found[task.methods()[build.first].name] = ending.status;
  EXPECT_EQ(found, (std::map<std::string, Status>{{"hangs", Status::timeout}, {"aborts", Status::crashed}}));
}

TEST(Statuses, OursMustAnswerUnlessTheCaseAllowsToRefuse) {
  // The fake's first hard case demands answers, its second allows to refuse.
  EXPECT_EQ(run_fake("--stress --block 1", "FAKE_OURS_REFUSE=1").status, 1);
  EXPECT_EQ(run_fake("--stress --block 2", "FAKE_OURS_REFUSE=1").status, 0);
}

TEST(Statuses, ACaseThatCannotBeOpenedIsNamedAndEndsNoOther) {
  const TemporaryFolder folder;
  const auto run = run_fake("--stress --rows " + (folder / "rows"), "FAKE_UNOPENED=1");
  EXPECT_EQ(run.status, 1);
  EXPECT_NE(run.err.find("cannot be opened"), std::string::npos) << run.err;
  EXPECT_NE(run.err.find("no way in"), std::string::npos) << run.err;
  EXPECT_FALSE(read_rows(folder / "rows").empty());  // of the second case
}

// A child that is forked from a process with TBB's workers may wait for one that it does not have.
TEST(Statuses, OpeningACaseStartsNoThreadsThatChildrenWouldMiss) {
  const auto run = run_fake("--stress --benchmark_filter=/exact/", "FAKE_THREADS=1");
  EXPECT_NE(run.err.find("threads: 1\n"), std::string::npos) << run.err;
  EXPECT_EQ(run.err.find("threads: 2\n"), std::string::npos) << run.err;
}

TEST(Statuses, OursWrongFailsTheRun) {
  EXPECT_EQ(run_fake("--dataset squares" + quickly).status, 0);
  const auto run = run_fake("--profile smoke", "FAKE_OURS_WRONG=1");
  EXPECT_EQ(run.status, 1);
  EXPECT_NE(run.err.find("failures of ours"), std::string::npos);
}

}  // namespace
}  // namespace treeline::bench
