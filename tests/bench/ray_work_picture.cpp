// Heat maps: one scale for all panels, lighter where a ray costs more, panels where they belong.
#include <gtest/gtest.h>

#include "bench/ray/work_picture.hpp"

namespace treeline::bench::ray {
namespace {

accel::Work steps(std::uint64_t nodes, std::uint64_t primitives) {
  accel::Work w;
  w.nodes = nodes, w.primitives = primitives;
  return w;
}

double light(const shading::Image& image, int x) { return image(x, 0, 0) + image(x, 0, 1) + image(x, 0, 2); }

TEST(RayWorkPicture, IsLighterWhereARayCostsMore) {
  std::vector<accel::Work> work;
  for (std::uint64_t i = 0; i <= 20; ++i) work.push_back(steps(i, i));
  const shading::Image image = heat_map(work, 21, 1, 40);
  for (int x = 1; x <= 20; ++x) EXPECT_GT(light(image, x), light(image, x - 1)) << x;
  EXPECT_GT(light(image, 20), 2.8);
  EXPECT_LT(light(image, 0), 0.1);
  EXPECT_EQ(light(heat_map(work, 21, 1, 20), 15), light(heat_map(work, 21, 1, 20), 20)) << "above the scale";
}

TEST(RayWorkPicture, TheScaleIsThatOfTheDearestPanelButForItsDearestRays) {
  std::vector<accel::Work> cheap(1000, steps(3, 2)), dear(1000, steps(10, 4));
  dear[0] = steps(100'000, 0);
  using Panels = std::vector<std::vector<accel::Work>>;
  EXPECT_EQ(common_scale(Panels{cheap, dear}), 14);
  EXPECT_EQ(common_scale(Panels(1, cheap)), 5);
}

TEST(RayWorkPicture, PanelsStandRowByRow) {
  std::vector<shading::Image> panels;
  for (const float shade : {0.1f, 0.2f, 0.3f}) panels.emplace_back(4, 2, 3, shade);
  const shading::Image all = beside(panels, 2);
  const int gap = all.width - 8;
  EXPECT_GT(gap, 0);
  EXPECT_EQ(all.height, 4 + gap);
  EXPECT_EQ(all(0, 0, 0), 0.1f);
  EXPECT_EQ(all(4 + gap, 1, 2), 0.2f);
  EXPECT_EQ(all(3, 2 + gap, 1), 0.3f);
  EXPECT_EQ(all(4 + gap, 2 + gap, 0), 1.0f) << "where no panel is";
  EXPECT_EQ(all(5, 0, 0), 1.0f) << "between panels";
}

}  // namespace
}  // namespace treeline::bench::ray
