// Strips: which configurations differ in one knob alone.
#include <gtest/gtest.h>

#include "bench/core/strip.hpp"

namespace treeline::bench {
namespace {

using Steps = std::vector<std::size_t>;

TEST(Strip, LongestRunOfOneKnobFromItsLeast) {
  const std::vector<Configuration> all{{{{"size", 256}}, {{"radius", 4}, {"smooth", true}}, 0.3},
                                       {{{"size", 256}}, {{"radius", 1}, {"smooth", true}}, 0.5},
                                       {{{"size", 256}}, {{"radius", 10}, {"smooth", true}}, 0.4},
                                       {{{"size", 256}}, {{"radius", 20}, {"smooth", true}}, 0.45},
                                       {{{"size", 512}}, {{"radius", 1}, {"smooth", true}}, 0.9},
                                       {{{"size", 256}}, {{"radius", 2}, {"smooth", false}}, 0.0}};
  const auto strip = strip_of(all);
  ASSERT_TRUE(strip);
  EXPECT_EQ(strip->knob, "radius");
  EXPECT_EQ(strip->steps, (Steps{1, 0, 2, 3}));  // by value, not as words; others are not in it
  EXPECT_DOUBLE_EQ(strip->change, 0.2);          // from the worst to the best, wherever they are
  EXPECT_EQ(value_at(all[2], "radius"), 10);
  EXPECT_EQ(value_at(all[4], "size"), 512);
}

TEST(Strip, BuildsMakeOneToo) {
  std::vector<Configuration> all;
  for (const int size : {1024, 64, 256}) all.push_back({{{"size", size}}, {{"bias", 1}}, 1.0 / size});
  const auto strip = strip_of(all);
  ASSERT_TRUE(strip);
  EXPECT_EQ(strip->knob, "size");
  EXPECT_EQ(strip->steps, (Steps{1, 2, 0}));
}

TEST(Strip, WordsAndTooFewStepsMakeNone) {
  EXPECT_FALSE(strip_of({}));
  const std::vector<Configuration> words{
      {{}, {{"form", "a"}}, 1}, {{}, {{"form", "b"}}, 2}, {{}, {{"form", "c"}}, 3}};
  EXPECT_FALSE(strip_of(words));
  const std::vector<Configuration> two{{{}, {{"n", 1}}, 1}, {{}, {{"n", 2}}, 2}};
  EXPECT_FALSE(strip_of(two));
  EXPECT_TRUE(strip_of(two, 2));
}

}  // namespace
}  // namespace treeline::bench
