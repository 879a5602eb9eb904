// Bytes of the first build in a process: a library's thread pools and caches are not its tree's. A program of
// its own, for in one process there is one first build.
#include <gtest/gtest.h>

#include "bench/core/measure.hpp"
#include "bench/ray/task.hpp"

namespace treeline::bench::ray {
namespace {

#ifdef TREELINE_SANITIZED
TEST(RayBytes, FirstBuildCountsNoMoreThanTheSecond) { GTEST_SKIP() << "bytes are not counted"; }
#else

TEST(RayBytes, FirstBuildCountsNoMoreThanTheSecond) {
  const RayTask task;
  const auto block = task.open(BlockSpec{"icosphere", 20'000}, {.profile = Profile::smoke});
  // Peers first: ours, on one thread, make no pools.
  for (const Source source : {Source::peer, Source::ours})
    for (std::size_t m = 0; m < task.methods().size(); ++m) {
      const MethodInfo& info = task.methods()[m];
      if (info.source != source || info.hard_cases_only) continue;
      const Build first = timed_build(*block, m, info.build_knobs.front(), 1, {});
      const Build second = timed_build(*block, m, info.build_knobs.front(), 1, {});
      if (!first.subject) continue;  // packets of sixteen rays are not on every machine
      ASSERT_TRUE(first.bytes && second.bytes) << info.name;
      const auto more = static_cast<double>(*first.bytes) - static_cast<double>(*second.bytes);
      EXPECT_LT(std::abs(more), 0.02 * static_cast<double>(*second.bytes) + 4096)
          << info.name << ": " << *first.bytes << " bytes, then " << *second.bytes;
    }
}

#endif

}  // namespace
}  // namespace treeline::bench::ray
