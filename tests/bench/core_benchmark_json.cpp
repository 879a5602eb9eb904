// Google Benchmark's own output stays one valid document over all query sets and blocks.
#include <gtest/gtest.h>

#include "core_helper.hpp"

namespace treeline::bench {
namespace {

constexpr int timed_cells = 2 + 4 + 4 + 2 + 1;  // exact, close, rough, wrong, unable on a block of 1000
// The block of 400 has small_only's two as well.

TEST(BenchmarkJson, FileHoldsEveryRepetitionOfEveryCell) {
  const TemporaryFolder folder;
  const auto run = run_fake("--benchmark_out=" + (folder / "out.json") + quickly);
  EXPECT_EQ(run.status, 0) << run.err;
  const Json out = Json::parse(read_text(folder / "out.json"));
  int repetitions = 0;
  for (const Json& entry : out["benchmarks"]) repetitions += entry["run_type"] == "iteration";
  EXPECT_EQ(repetitions, 2 * (timed_cells + timed_cells + 2));
  EXPECT_TRUE(out.contains("context"));
}

TEST(BenchmarkJson, OnStdoutNothingElseIsPrinted) {
  const auto run = run_fake("--dataset squares --benchmark_format=json" + quickly);
  EXPECT_EQ(run.status, 0);
  const Json out = Json::parse(run.out);
  EXPECT_GT(out["benchmarks"].size(), 0u);
}

TEST(BenchmarkJson, IsValidEvenIfNothingCouldBeTimed) {
  const TemporaryFolder folder;
  run_fake("--dataset squares --benchmark_filter=refuses --benchmark_out=" + (folder / "out.json"));
  EXPECT_EQ(Json::parse(read_text(folder / "out.json"))["benchmarks"].size(), 0u);
}

TEST(BenchmarkJson, AggregatesOnlyStillLeavesRepetitionsInRows) {
  const TemporaryFolder folder;
  run_fake(
      "--dataset squares --benchmark_filter=exact --benchmark_report_aggregates_only=true --benchmark_out=" +
      (folder / "out.json") + " --rows " + (folder / "rows") + quickly);
  for (const Json& entry : Json::parse(read_text(folder / "out.json"))["benchmarks"])
    EXPECT_EQ(entry["run_type"], "aggregate");
  EXPECT_EQ(read_rows(folder / "rows").at(0)["samples"].size(), 2u);
}

TEST(BenchmarkJson, ExistingFileIsNotOverwritten) {
  const TemporaryFolder folder;
  std::ofstream(folder / "out.json") << "precious";
  EXPECT_EQ(run_fake("--benchmark_out=" + (folder / "out.json")).status, 2);
  EXPECT_EQ(read_text(folder / "out.json"), "precious");
}

TEST(BenchmarkJson, ListTestsPrintsNamesAndMeasuresNothing) {
  const TemporaryFolder folder;
  const auto run = run_fake("--dataset squares --benchmark_list_tests --benchmark_filter=exact",
                            "FAKE_LOG=" + (folder / "log"));
  EXPECT_EQ(run.out, "squares:400/forward/exact/-/-\nsquares:400/backward/exact/-/-\n");
  EXPECT_FALSE(std::filesystem::exists(folder / "log"));
}

}  // namespace
}  // namespace treeline::bench
