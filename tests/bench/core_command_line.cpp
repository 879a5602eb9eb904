// Bad arguments are named and end with status 2; what matches nothing ends with 1.
#include <gtest/gtest.h>

#include <set>
#include <thread>

#include "core_helper.hpp"

namespace treeline::bench {
namespace {

struct Bad {
  const char* arguments;
  const char* named;  // must be in the message
};

class BadArguments : public testing::TestWithParam<Bad> {};

TEST_P(BadArguments, AreNamedWithStatusTwo) {
  const auto run = run_fake(GetParam().arguments);
  EXPECT_EQ(run.status, 2) << run.out << run.err;
  EXPECT_NE(run.err.find(GetParam().named), std::string::npos) << run.err;
  EXPECT_EQ(run.out, "");
  for (const std::string& line : lines_of(run.err)) EXPECT_LT(line.size(), 300u) << line;
}

INSTANTIATE_TEST_SUITE_P(
    All, BadArguments,
    testing::Values(
        Bad{"--nonsense", "--nonsense"}, Bad{"--profile huge", "--profile"}, Bad{"stray", "stray"},
        Bad{"--threads 0", "--threads"}, Bad{"--threads two", "--threads"}, Bad{"--seed -1", "--seed"},
        Bad{"--seed x", "--seed"}, Bad{"--seed 18446744073709551616", "--seed"}, Bad{"--seed 1.5", "--seed"},
        Bad{"--scaling --stress", "--scaling"}, Bad{"--scaling --threads 2", "--scaling"},
        Bad{"--dataset nowhere", "nowhere"}, Bad{"--dataset counting:many", "many"},
        Bad{"--dataset counting:-5", "-5"}, Bad{"--block 0", "--block"}, Bad{"--block 3", "--block 3"},
        Bad{"--block x", "--block"}, Bad{"--advise 1e-3", "--advise"},
        Bad{"--advise -1 --dataset counting", "--advise"}, Bad{"--advise nan --dataset counting", "--advise"},
        Bad{"--advise x --dataset counting", "--advise"}, Bad{"--input ''", "--input"},
        Bad{"--input '' --dataset counting", "--input"}, Bad{"--advise '' --dataset counting", "--advise"},
        Bad{"--rows ''", "--rows"}, Bad{"--stress --stress-seconds -1", "--stress-seconds"},
        Bad{"--stress --stress-seconds nan", "--stress-seconds"},
        Bad{"--stress --stress-bytes 0", "--stress-bytes"},
        Bad{"--benchmark_repetitions=-1", "--benchmark_repetitions"},
        Bad{"--benchmark_repetitions=0", "--benchmark_repetitions"},
        Bad{"--benchmark_min_time=-1", "--benchmark_min_time"},
        Bad{"--benchmark_min_time=nan", "--benchmark_min_time"}, Bad{"--resume", "--resume"},
        Bad{"--input /nowhere.ply", "/nowhere.ply"}, Bad{"--input a.ply --dataset counting", "--input"},
        Bad{"--stress --dataset counting", "counting"}, Bad{"--stress --advise 1", "--advise"},
        Bad{"--rows /nowhere/at/all", "/nowhere/at/all"},
        Bad{"--benchmark_nonsense=1", "--benchmark_nonsense"},
        Bad{"--benchmark_repetitions=few", "--benchmark_repetitions"},
        Bad{"--benchmark_format=xml", "--benchmark_format"},
        Bad{"--benchmark_filter=*[", "--benchmark_filter"}));

TEST(CommandLine, RowsCarryTheThreadsThatThereAre) {
  const TemporaryFolder folder;
  const auto run =
      run_fake("--profile smoke --threads 4096 --benchmark_filter=/exact/ --rows " + (folder / "rows"));
  EXPECT_EQ(run.status, 0) << run.err;
  const unsigned there = std::thread::hardware_concurrency();
  if (there == 0 || there >= 4096) GTEST_SKIP() << "a machine of unknown or enormous size";
  EXPECT_NE(run.err.find("--threads 4096"), std::string::npos) << run.err;
  for (const Json& row : read_rows(folder / "rows")) EXPECT_EQ(row["threads"], there);
}

TEST(CommandLine, EverySeedOf64BitsIsTaken) {
  const TemporaryFolder folder;
  for (const std::string seed : {"0", "18446744073709551615"}) {
    const auto run =
        run_fake("--profile smoke --benchmark_filter=/exact/ --seed " + seed + " --rows " + (folder / seed));
    EXPECT_EQ(run.status, 0) << run.err;
    for (const Json& row : read_rows(folder / seed)) EXPECT_EQ(row["seed"].dump(), seed);
  }
}

TEST(CommandLine, ScalingMeasuresAtEveryPowerOfTwoThreads) {
  const TemporaryFolder folder;
  const auto run = run_fake("--scaling --rows " + (folder / "rows") + quickly);
  EXPECT_EQ(run.status, 0) << run.err;
  std::map<int, std::set<std::string>> methods;
  for (const Json& row : read_rows(folder / "rows"))
    if (row["status"] == "ok") methods[row["threads"]].insert(row["method"]);
  const int there = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  std::set<int> wanted{1, there}, found;
  for (int t = 2; t < there; t *= 2) wanted.insert(t);
  for (const auto& [threads, names] : methods) {
    found.insert(threads);
    EXPECT_TRUE(names.contains("exact"));
    EXPECT_FALSE(names.contains("rough")) << "a method that does not scale";
  }
  EXPECT_EQ(found, wanted);
}

TEST(CommandLine, FilterThatMatchesNothingIsStatusOne) {
  const auto run = run_fake("--dataset squares --benchmark_filter=unheard_of");
  EXPECT_EQ(run.status, 1);
  EXPECT_NE(run.err.find("unheard_of"), std::string::npos) << run.err;
}

TEST(CommandLine, FilterChoosesCellsAndNegates) {
  const TemporaryFolder folder;
  run_fake("--dataset squares --benchmark_filter='forward/(exact|wrong)/' --rows " + (folder / "a") +
           quickly);
  const auto a = read_rows(folder / "a");
  ASSERT_EQ(a.size(), 2u);
  EXPECT_EQ(a[0]["query_set"], "forward");
  run_fake("--dataset squares --benchmark_filter=-wrong --rows " + (folder / "b") + quickly);
  const auto b = statuses_by_method(read_rows(folder / "b"));
  EXPECT_EQ(b.count("wrong"), 0u);
  EXPECT_EQ(b.count("exact"), 1u);
}

TEST(CommandLine, ListNamesBlocksMethodsAndKnobs) {
  const auto run = run_fake("--list");
  EXPECT_EQ(run.status, 0);
  for (const char* expected :
       {"counting:1000", "squares:400", "exact", "scale=2.0", "slower=10.0", "LibAbsent", "hard/"})
    EXPECT_NE(run.out.find(expected), std::string::npos) << expected;
}

TEST(CommandLine, BlocksAddUpToTheWhole) {
  const TemporaryFolder folder;
  run_fake("--block 1 --rows " + (folder / "1") + quickly);
  run_fake("--block 2 --rows " + (folder / "2") + quickly);
  run_fake("--rows " + (folder / "all") + quickly);
  std::vector<std::string> parts, whole;
  for (const char* part : {"1", "2"})
    for (const Json& row : read_rows(folder / part)) parts.push_back(Row::from_json(row).key());
  for (const Json& row : read_rows(folder / "all")) whole.push_back(Row::from_json(row).key());
  EXPECT_EQ(parts, whole);
}

TEST(CommandLine, PicturesOfTheSmallestBlockOfEachDataset) {
  const TemporaryFolder folder;
  const auto run = run_fake("--pictures " + (folder / "p"));
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(read_text((folder / "p") + "/counting.txt"), "1000");
  EXPECT_EQ(read_text((folder / "p") + "/squares.txt"), "400");
}

TEST(CommandLine, ProgressAndTable) {
  const auto run = run_fake("--dataset counting:1000" + quickly);
  EXPECT_NE(run.err.find("block 1 of 1  counting:1000"), std::string::npos) << run.err;
  EXPECT_EQ(run.err.find('\r'), std::string::npos);  // no terminal
  EXPECT_NE(run.out.find("exact"), std::string::npos);
}

}  // namespace
}  // namespace treeline::bench
