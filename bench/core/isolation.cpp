#include "bench/core/isolation.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <tbb/global_control.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>
#include <new>
#include <system_error>
#include <vector>

namespace treeline::bench {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t tail_length = 200;  // characters of stderr that a reason keeps
constexpr int exit_done = 0, exit_no_memory = 77, exit_exception = 78;
// Those of the SingleThreaded that live.
std::vector<std::unique_ptr<tbb::global_control>>& controls() {
  static std::vector<std::unique_ptr<tbb::global_control>> all;
  return all;
}

constexpr const char* end_mark = "\x04";  // last line of a child that came to its end

struct Pipe {
  int ends[2];
  Pipe() {
    if (pipe2(ends, O_CLOEXEC) != 0) throw std::system_error(errno, std::generic_category(), "pipe");
  }
  ~Pipe() { close_reader(), close_writer(); }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  void close_reader() { close_end(0); }
  void close_writer() { close_end(1); }

 private:
  void close_end(int i) {
    if (ends[i] >= 0) close(ends[i]);
    ends[i] = -1;
  }
};

void write_all(int file, std::string_view text) {
  while (!text.empty()) {
    const ssize_t n = write(file, text.data(), text.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) _exit(exit_exception);  // the parent is gone
    text.remove_prefix(static_cast<std::size_t>(n));
  }
}

void limit(decltype(RLIMIT_AS) what, std::size_t value) {
  const rlimit bound{value, value};
  setrlimit(what, &bound);
}

#ifndef TREELINE_SANITIZED  // sanitizers reserve terabytes of address space, so there is no limit
std::size_t address_space() {
  std::ifstream statm("/proc/self/statm");
  std::size_t pages = 0;
  statm >> pages;
  return pages * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}
#endif

[[noreturn]] void child(const std::function<void(const Send&)>& work, const Limits& limits, int results,
                        int errors) {
  // Whoever calls exit() ends here: what libraries clean up behind main may wait for threads that a child of
  // a fork does not have (log4cplus, which comes with OpenImageIO, does).
  on_exit([](int status, void*) { std::fflush(nullptr), _exit(status); }, nullptr);
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  const int nowhere = open("/dev/null", O_RDWR);
  dup2(nowhere, STDIN_FILENO), dup2(nowhere, STDOUT_FILENO), dup2(errors, STDERR_FILENO);
  limit(RLIMIT_CORE, 0);
#ifndef TREELINE_SANITIZED
  if (limits.memory > 0) limit(RLIMIT_AS, address_space() + limits.memory);
#else
  (void)limits;
#endif
  try {
    work([&](const std::string& line) { write_all(results, line + "\n"); });
    write_all(results, std::string(end_mark) + "\n");
    _exit(exit_done);
  } catch (const std::bad_alloc&) {
    _exit(exit_no_memory);
  } catch (const std::exception& e) {
    write_all(STDERR_FILENO, e.what());
  } catch (...) {
    write_all(STDERR_FILENO, "an exception that is no std::exception");
  }
  _exit(exit_exception);
}

/// Both pipes of a child, read until it closes them or the time runs out.
class Reader {
 public:
  Reader(int results, int errors, double seconds, const std::function<void(const std::string&)>& on_line)
      : files_{{results, POLLIN, 0}, {errors, POLLIN, 0}}, seconds_(seconds), on_line_(on_line) {
    restart_clock();
  }

  /// False: the time ran out.
  bool read_to_end() {
    // Only the results' end counts: a grandchild may keep stderr open.
    while (files_[0].fd >= 0) {
      const auto left =
          std::chrono::duration_cast<std::chrono::milliseconds>(deadline_ - Clock::now()).count();
      if (left <= 0) return false;
      if (poll(files_, 2, static_cast<int>(std::min<long long>(left + 1, 1 << 30))) < 0 && errno != EINTR)
        throw std::system_error(errno, std::generic_category(), "poll");
      for (int i = 0; i < 2; ++i)
        if (files_[i].revents != 0) take(i);
    }
    return true;
  }

  /// What stderr still holds once the child has ended, without waiting for more.
  void drain_errors() {
    while (files_[1].fd >= 0 && poll(&files_[1], 1, 0) > 0 && files_[1].revents != 0) take(1);
  }

  bool ended() const { return ended_; }

  std::string tail() const {
    std::string out = tail_;
    for (char& c : out)
      if (static_cast<unsigned char>(c) < ' ') c = ' ';
    if (const std::size_t word = out.find(' '); cut_ && word != std::string::npos) out.erase(0, word);
    const std::size_t first = out.find_first_not_of(' ');
    if (first == std::string::npos) return "";
    return out.substr(first, out.find_last_not_of(' ') - first + 1);
  }

 private:
  void restart_clock() {
    deadline_ =
        Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds_));
  }

  void take(int i) {
    char buffer[4096];
    const ssize_t n = read(files_[i].fd, buffer, sizeof buffer);
    if (n < 0 && errno == EINTR) return;
    if (n <= 0) {
      files_[i].fd = -1, files_[i].revents = 0;
      return;
    }
    if (i == 1) {
      tail_.append(buffer, static_cast<std::size_t>(n));
      if (tail_.size() > tail_length) {
        tail_.erase(0, tail_.size() - tail_length);
        cut_ = true;
      }
      return;
    }
    partial_.append(buffer, static_cast<std::size_t>(n));
    for (std::size_t end; (end = partial_.find('\n')) != std::string::npos; partial_.erase(0, end + 1)) {
      const std::string line = partial_.substr(0, end);
      if (line == end_mark)
        ended_ = true;
      else
        on_line_(line);
      restart_clock();
    }
  }

  pollfd files_[2];
  double seconds_;
  const std::function<void(const std::string&)>& on_line_;
  Clock::time_point deadline_;
  std::string partial_, tail_;
  bool ended_ = false, cut_ = false;  // cut: the tail is not all, and may begin within a word
};

std::string with_tail(std::string reason, const std::string& tail) {
  return tail.empty() ? reason : std::move(reason) + ": " + tail;
}

}  // namespace

Ending run_isolated(const std::function<void(const Send&)>& work, const Limits& limits,
                    const std::function<void(const std::string&)>& on_line) {
  std::fflush(nullptr);
  std::cout.flush(), std::cerr.flush();
  Pipe results, errors;
  const pid_t pid = fork();
  if (pid < 0) throw std::system_error(errno, std::generic_category(), "fork");
  if (pid == 0) child(work, limits, results.ends[1], errors.ends[1]);
  results.close_writer(), errors.close_writer();

  Reader reader(results.ends[0], errors.ends[0], limits.seconds, on_line);
  const bool in_time = reader.read_to_end();
  if (!in_time) kill(pid, SIGKILL);
  int status = 0;
  while (waitpid(pid, &status, 0) < 0 && errno == EINTR) {
  }
  reader.drain_errors();

  const std::string tail = reader.tail();
  if (!in_time)
    return {Status::timeout, with_tail(fmt::format("no answer within {:g} s", limits.seconds), tail)};
  if (WIFSIGNALED(status)) {
    const int signal = WTERMSIG(status);
    if (signal == SIGKILL) return {Status::out_of_memory, with_tail("killed by the system", tail)};
    if (tail.find("std::bad_alloc") != std::string::npos)  // it could not unwind, and aborted
      return {Status::out_of_memory, with_tail("memory limit reached", tail)};
    std::string how = "signal " + std::to_string(signal) + " (" + strsignal(signal) + ")";
    if (signal == SIGABRT && tail.find("Assertion `") != std::string::npos)
      how = "an assertion that its package was built with failed, " + how;
    return {Status::crashed, with_tail(std::move(how), tail)};
  }
  const int code = WEXITSTATUS(status);
  if (code == exit_done && reader.ended()) return {};
  if (code == exit_no_memory) return {Status::out_of_memory, with_tail("memory limit reached", tail)};
  if (code == exit_exception) return {Status::crashed, with_tail("uncaught exception", tail)};
  return {Status::crashed, with_tail("ended early with exit status " + std::to_string(code), tail)};
}

SingleThreaded::SingleThreaded() {
  controls().push_back(
      std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism, 1));
}

SingleThreaded::~SingleThreaded() { controls().pop_back(); }

void SingleThreaded::lift() { controls().clear(); }

int thread_count() {
  int n = 0;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/task")) (void)entry, ++n;
  return n;
}

}  // namespace treeline::bench
