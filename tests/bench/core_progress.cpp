// Who waits hears how far it is: in a log, too, and within a block.
#include "bench/core/progress.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include "core_helper.hpp"

namespace treeline::bench {
namespace {

std::vector<std::string> told(double line_every) {
  testing::internal::CaptureStderr();
  {
    Progress progress({1, 1}, line_every);
    progress.block(0, "mesh:1000");
    progress.step(0.5, "camera by bvh");
    progress.block(1, "mesh:2000");
    progress.step(0.5, "shadow by kd_tree");
  }
  return lines_of(testing::internal::GetCapturedStderr());
}

TEST(Progress, ALogGetsALineABlockAndMoreWhileOneTakesLong) {
  const auto all = told(0);
  ASSERT_EQ(all.size(), 4u);
  EXPECT_TRUE(all[0].starts_with("block 1 of 2  mesh:1000  elapsed 0:00")) << all[0];
  EXPECT_TRUE(all[1].ends_with("camera by bvh")) << all[1];
  EXPECT_TRUE(all[3].starts_with("block 2 of 2") && all[3].ends_with("shadow by kd_tree")) << all[3];
  EXPECT_EQ(told(3600).size(), 2u) << "steps that follow each other closely are not all told";
}

}  // namespace
}  // namespace treeline::bench
