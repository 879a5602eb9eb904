// The interval of a median, against the binomial law it is derived from.
#include "bench/core/timing.hpp"

#include <gtest/gtest.h>

#include "geometry/random.hpp"

namespace treeline::bench {
namespace {

TEST(MedianInterval, FewSamplesGiveTheirRange) {
  const auto m = median_interval({3, 1, 2});
  EXPECT_EQ(m.median, 2);
  EXPECT_EQ(m.low, 1);
  EXPECT_EQ(m.high, 3);
  EXPECT_EQ(median_interval({4, 2}).median, 3);
}

TEST(MedianInterval, KnownOrderStatistics) {
  // Textbook table of the sign test at 95 %: n = 9 → 2nd and 8th, n = 20 → 6th and 15th smallest.
  std::vector<double> nine(9), twenty(20);
  for (int i = 0; i < 20; ++i) twenty[i] = i + 1;
  for (int i = 0; i < 9; ++i) nine[i] = i + 1;
  EXPECT_EQ(median_interval(nine).low, 2);
  EXPECT_EQ(median_interval(nine).high, 8);
  EXPECT_EQ(median_interval(twenty).low, 6);
  EXPECT_EQ(median_interval(twenty).high, 15);
}

TEST(MedianInterval, HoldsTheMedianAtLeastAsOftenAsItSays) {
  int held = 0;
  constexpr int trials = 4000;
  for (int t = 0; t < trials; ++t) {
    std::vector<double> samples(12);
    for (int i = 0; i < 12; ++i)
      samples[i] = geometry::uniform_at(11, static_cast<std::uint64_t>(t) * 12 + i);
    const auto m = median_interval(samples);
    held += m.low <= 0.5 && 0.5 <= m.high;
  }
  // Exact coverage for n = 12 is 0.9614; four standard errors of the count are 0.0122.
  EXPECT_NEAR(static_cast<double>(held) / trials, 0.9614, 0.0122);
}

}  // namespace
}  // namespace treeline::bench
