// Whatever a child does, the parent learns how it ended and what it had sent.
#include "bench/core/isolation.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <new>
#include <stdexcept>
#include <thread>

namespace treeline::bench {
namespace {

struct Result {
  Ending ending;
  std::vector<std::string> lines;
};

Result isolated(const std::function<void(const Send&)>& work, Limits limits = {}) {
  Result out;
  out.ending = run_isolated(work, limits, [&](const std::string& line) { out.lines.push_back(line); });
  return out;
}

TEST(Isolation, LinesArriveWholeAndInOrder) {
  const std::string longer_than_a_pipe(300000, 'x');
  const auto r = isolated([&](const Send& send) { send("a"), send(longer_than_a_pipe), send("c"); });
  EXPECT_EQ(r.ending.status, Status::ok);
  EXPECT_EQ(r.lines, (std::vector<std::string>{"a", longer_than_a_pipe, "c"}));
}

TEST(Isolation, CrashKeepsWhatWasSent) {
  const auto r = isolated([](const Send& send) {
    send("first");
    std::signal(SIGSEGV, SIG_DFL);
    raise(SIGSEGV);
  });
  EXPECT_EQ(r.ending.status, Status::crashed);
  EXPECT_NE(r.ending.reason.find("11"), std::string::npos) << r.ending.reason;
  EXPECT_EQ(r.lines, std::vector<std::string>{"first"});
}

TEST(Isolation, ReasonEndsWithTheLastOfStderr) {
  const auto r = isolated([](const Send&) {
    for (int i = 0; i < 100000; ++i) std::fputs("Wörterlärm ", stderr);  // more than a pipe holds
    std::fputs("\nassertion failed: x > 0\n", stderr);
    std::signal(SIGABRT, SIG_DFL);
    std::abort();
  });
  EXPECT_EQ(r.ending.status, Status::crashed);
  EXPECT_TRUE(r.ending.reason.ends_with("assertion failed: x > 0")) << r.ending.reason;
  EXPECT_LT(r.ending.reason.size(), 260u);
  EXPECT_NE(r.ending.reason.find(": Wörterlärm "), std::string::npos) << r.ending.reason;  // a whole word
}

TEST(Isolation, AFailedAssertionIsCalledOne) {
  const auto r = isolated([](const Send&) {
    std::signal(SIGABRT, SIG_DFL);
    std::fputs("bench: scene.cpp:7: void cast(): Assertion `valid(ray)' failed.\n", stderr);  // as glibc does
    std::abort();
  });
  EXPECT_EQ(r.ending.status, Status::crashed);
  EXPECT_TRUE(r.ending.reason.starts_with("an assertion that its package was built with failed, signal 6"))
      << r.ending.reason;
}

TEST(Isolation, TimeLimitIsPerStep) {
  const auto slow_but_steady = isolated(
      [](const Send& send) {
        for (int i = 0; i < 4; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(300)), send("step");
      },
      {.seconds = 1, .memory = 0});
  EXPECT_EQ(slow_but_steady.ending.status, Status::ok);
  const auto start = std::chrono::steady_clock::now();
  const auto stuck = isolated(
      [](const Send& send) {
        send("step");
        for (;;) pause();
      },
      {.seconds = 0.3, .memory = 0});
  EXPECT_EQ(stuck.ending.status, Status::timeout);
  EXPECT_EQ(stuck.lines.size(), 1u);
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(10));
}

#ifndef TREELINE_SANITIZED
TEST(Isolation, MemoryLimit) {
  const auto r = isolated(
      [](const Send& send) {
        std::vector<char> big(2ull << 30);
        send(std::to_string(big.size()));
      },
      {.seconds = 20, .memory = 1ull << 30});
  EXPECT_EQ(r.ending.status, Status::out_of_memory);
  EXPECT_TRUE(r.lines.empty());
}
#endif

TEST(Isolation, ExceptionsAndEarlyExitsAreCrashes) {
  const auto thrown = isolated([](const Send&) { throw std::runtime_error("unforeseen"); });
  EXPECT_EQ(thrown.ending.status, Status::crashed);
  EXPECT_TRUE(thrown.ending.reason.ends_with("unforeseen")) << thrown.ending.reason;
  EXPECT_EQ(isolated([](const Send&) { throw std::bad_alloc(); }).ending.status, Status::out_of_memory);
  EXPECT_EQ(isolated([](const Send&) { _exit(0); }).ending.status, Status::crashed);
  EXPECT_EQ(isolated([](const Send&) { _exit(3); }).ending.status, Status::crashed);
}

TEST(Isolation, ChildrenDoNotWriteToOurStdout) {
  testing::internal::CaptureStdout();
  isolated([](const Send&) { std::puts("chatter"), std::fflush(stdout); });
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
}

TEST(Isolation, CountsThreads) {
  const int before = thread_count();
  std::thread other([before] { EXPECT_EQ(thread_count(), before + 1); });
  other.join();
}

}  // namespace
}  // namespace treeline::bench
