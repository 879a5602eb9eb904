#include "bench/core/measure.hpp"

#include <chrono>
#include <cmath>

#include "bench/core/bytes.hpp"
#include "bench/core/timing.hpp"

namespace treeline::bench {
namespace {

constexpr double short_batch_s = 0.01;  // shorter batches are run twice to know what they take

class Stopwatch {
 public:
  double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

void check(Block& block, Subject& subject, Cell& cell) {
  Row& row = cell.row;
  try {
    row.errors = block.check(cell.method, subject, cell.query_set, row.query_knobs);
  } catch (const std::exception& e) {
    row.status = Status::wrong, row.reason = std::string("its answers cannot be judged: ") + e.what();
    return;
  }
  Errors& e = row.errors;
  for (auto* figure : {&e.error, &e.max, &e.p99, &e.mean, &e.bias, &e.floor})
    if (*figure && std::isnan(**figure)) figure->reset();  // undefined: does not apply, as in the row
  if (!e.within_claim) row.status = Status::wrong, row.reason = e.reason;
}

}  // namespace

Build timed_build(Block& block, std::size_t method, const Knobs& build_knobs, int threads,
                  const BuildRuns& runs) {
  Build out;
  std::vector<double> seconds;
  double spent = 0;
  try {
    block.warm_up(method, threads);
    for (int i = 0; i < runs.most; ++i) {
      out.subject.reset();  // never two at a time
      ByteCount count;
      const Stopwatch watch;
      out.subject = block.build(method, build_knobs, threads);
      seconds.push_back(watch.seconds());
      out.bytes = count.live();  // of the last build, where pools are full that nobody warmed up
      if ((spent += seconds.back()) > runs.enough_s) break;
    }
    out.seconds = median_interval(seconds).median;
  } catch (...) {
    out.subject.reset();
    std::tie(out.status, out.reason) = classify(std::current_exception());
  }
  return out;
}

void note_build(Row& row, const Build& build, const MethodInfo& method, const Block& block) {
  if (!build.subject) {
    row.status = build.status, row.reason = build.reason;
    return;
  }
  row.build_s = build.seconds, row.bytes = build.bytes;
  if (const auto input = block.input_bytes()) row.input_bytes = method.keeps_no_copy ? *input : 0;
}

double run_and_check(Block& block, Subject& subject, Cell& cell) {
  Row& row = cell.row;
  double seconds = 0;
  try {
    subject.prepare(cell.query_set, row.threads);
    const Stopwatch watch;
    subject.run(cell.query_set, row.query_knobs, row.threads);
    seconds = watch.seconds();
  } catch (...) {
    std::tie(row.status, row.reason) = classify(std::current_exception());
    return seconds;
  }
  check(block, subject, cell);
  if (seconds < short_batch_s) try {  // the first run found cold caches and empty buffers
      const Stopwatch again;
      subject.run(cell.query_set, row.query_knobs, row.threads);
      seconds = std::min(seconds, again.seconds());
    } catch (const std::exception&) {  // the timed runs will hear the same
    }
  try {
    if (const auto work = subject.work(cell.query_set, row.query_knobs))
      row.work_nodes = work->first, row.work_primitives = work->second;
  } catch (const std::exception&) {  // it answered; that it cannot count is no failure
  }
  return seconds;
}

bool is_failure(const Row& row, bool must_answer) {
  if (row.source != Source::ours) return false;
  return row.status == Status::wrong || row.status == Status::crashed || row.status == Status::timeout ||
         (must_answer && row.status == Status::refused);
}

}  // namespace treeline::bench
