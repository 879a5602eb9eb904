// A killed run loses at most the query set at hand, and goes on where it was.
#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <set>
#include <thread>

#include "core_helper.hpp"

namespace treeline::bench {
namespace {

std::multiset<std::string> keys_of(const std::string& path) {
  std::multiset<std::string> out;
  for (const Json& row : read_rows(path)) out.insert(Row::from_json(row).key());
  return out;
}

TEST(Resume, TornLineIsMadeGoodWithoutRepeats) {
  const TemporaryFolder folder;
  run_fake("--rows " + (folder / "whole") + quickly);
  const std::string whole = read_text(folder / "whole");
  const auto expected = keys_of(folder / "whole");
  std::ofstream(folder / "torn") << whole.substr(0, whole.size() * 2 / 3);
  EXPECT_EQ(run_fake("--resume --rows " + (folder / "torn") + quickly).status, 0);
  EXPECT_EQ(keys_of(folder / "torn"), expected);
  EXPECT_EQ(read_text(folder / "torn").substr(0, 1000), whole.substr(0, 1000));  // the old rows stay
}

TEST(Resume, FinishedRunBuildsNothingAndKeepsItsStatus) {
  const TemporaryFolder folder;
  const std::string rows = " --profile smoke --rows " + (folder / "rows");
  EXPECT_EQ(run_fake(rows, "FAKE_OURS_WRONG=1").status, 1);
  const std::string before = read_text(folder / "rows");
  EXPECT_EQ(run_fake(rows + " --resume", "FAKE_OURS_WRONG=1 FAKE_LOG=" + (folder / "log")).status, 1);
  EXPECT_EQ(read_text(folder / "rows"), before);
  EXPECT_FALSE(std::filesystem::exists(folder / "log"));
}

TEST(Resume, StressGoesOnToo) {
  const TemporaryFolder folder;
  run_fake("--stress --rows " + (folder / "whole"));
  const std::string whole = read_text(folder / "whole");
  std::ofstream(folder / "torn") << whole.substr(0, whole.size() / 2);
  run_fake("--stress --resume --rows " + (folder / "torn"));
  EXPECT_EQ(keys_of(folder / "torn"), keys_of(folder / "whole"));
}

TEST(Resume, ExistingFileIsNotOverwritten) {
  const TemporaryFolder folder;
  std::ofstream(folder / "rows") << "precious\n";
  const auto run = run_fake("--rows " + (folder / "rows"));
  EXPECT_EQ(run.status, 2);
  EXPECT_NE(run.err.find(folder / "rows"), std::string::npos) << run.err;
  EXPECT_EQ(read_text(folder / "rows"), "precious\n");
}

TEST(Resume, AfterSigkillInTheMiddle) {
  const TemporaryFolder folder;
  const std::string rows = folder / "rows";
  const pid_t child = fork();
  if (child == 0) {
    setenv("FAKE_SLOW_MS", "30", 1);
    freopen("/dev/null", "w", stdout), freopen("/dev/null", "w", stderr);
    execl(FAKE_TASK, FAKE_TASK, "--rows", rows.c_str(), "--benchmark_min_time=0.001",
          "--benchmark_repetitions=2", nullptr);
    _exit(127);
  }
  ASSERT_GT(child, 0);
  // Killed as soon as rows that took timing are there: in the middle, whatever the machine's speed.
  for (int i = 0; i < 2000; ++i) {
    if (read_text(rows).find("\"status\":\"ok\"") != std::string::npos) break;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  kill(child, SIGKILL);
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_TRUE(WIFSIGNALED(status)) << "it ended before it could be killed";
  const auto saved = lines_of(read_text(rows));
  ASSERT_FALSE(saved.empty());

  EXPECT_EQ(run_fake("--resume --rows " + rows + quickly).status, 0);
  run_fake("--rows " + (folder / "whole") + quickly);
  EXPECT_EQ(keys_of(rows), keys_of(folder / "whole"));
  EXPECT_EQ(lines_of(read_text(rows)).front(), saved.front());
}

}  // namespace
}  // namespace treeline::bench
