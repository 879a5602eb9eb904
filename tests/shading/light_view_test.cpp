// The frame of a light: place() and at() undo each other, and what is fitted holds what it was fitted to.
#include "shading/shadow/light_view.hpp"

#include <gtest/gtest.h>

#include "geometry/random.hpp"

namespace treeline::shading::shadow {
namespace {

using geometry::Box3d;

double uniform(std::uint64_t i) { return double(geometry::hash_u64(5, i) >> 11) * 0x1p-53; }

Light light(LightKind kind, const Vec3d& position, const Vec3d& direction) {
  Light r;
  r.kind = kind, r.position = position, r.direction = normalized(direction), r.angle = 0.6;
  return r;
}

std::vector<Light> lights() {
  return {light(LightKind::directional, {}, {0, -1, 0}), light(LightKind::directional, {}, {1, 2, -3}),
          light(LightKind::point, {1, 9, -3}, {0, 1, 0}), light(LightKind::rectangle, {0, 7, 0}, {0, -1, 0}),
          light(LightKind::disc, {-6, 8, 4}, {6, -8, -4})};
}

TEST(LightView, PlaceAndAtUndoEachOther) {
  const Box3d box{{-2, -1, -3}, {1, 2, 3}};
  std::uint64_t i = 0;
  for (const Light& l : lights()) {
    const LightView view = fit_view(l, box);
    for (int k = 0; k < 200; ++k) {
      const LightView::Place q{uniform(i++), uniform(i++), uniform(i++)};
      const LightView::Place back = view.place(view.at(q));
      EXPECT_NEAR(back.x, q.x, 1e-12);
      EXPECT_NEAR(back.y, q.y, 1e-12);
      EXPECT_NEAR(back.depth, q.depth, 1e-11);
    }
  }
}

TEST(LightView, HoldsTheBox) {
  const Box3d box{{-2, -1, -3}, {1, 2, 3}};
  std::uint64_t i = 0;
  for (const Light& l : lights()) {
    const LightView view = fit_view(l, box, 0.01);
    EXPECT_NEAR(dot(view.right, view.down), 0, 1e-15);
    EXPECT_NEAR(length(cross(view.right, view.down) - view.forward), 0, 1e-15) << "left-handed";
    for (int k = 0; k < 500; ++k) {
      Vec3d p;
      for (int a = 0; a < 3; ++a) p[a] = box.low[a] + (box.high[a] - box.low[a]) * uniform(i++);
      const LightView::Place q = view.place(p);
      for (const double share : {q.x, q.y, q.depth}) {
        EXPECT_GT(share, 0);
        EXPECT_LT(share, 1);
      }
    }
  }
}

TEST(LightView, TheBoxFillsTheViewFromHoweverFar) {
  const Box3d box{{-2, -1, -3}, {1, 2, 3}};
  for (const double away : {1e2, 1e6, 1.5e11}) {  // as far as the sun
    const LightView view = fit_view(light(LightKind::point, {0, away, 0}, {0, -1, 0}), box, 0.01);
    double x = 0, y = 0;
    for (int corner = 0; corner < 8; ++corner) {
      const LightView::Place q =
          view.place({corner & 1 ? box.high[0] : box.low[0], corner & 2 ? box.high[1] : box.low[1],
                      corner & 4 ? box.high[2] : box.low[2]});
      x = std::max(x, std::abs(2 * q.x - 1)), y = std::max(y, std::abs(2 * q.y - 1));
    }
    EXPECT_NEAR(x, 1 / 1.01, 1e-6) << away;
    EXPECT_NEAR(y, 1 / 1.01, 1e-6) << away;
  }
}

TEST(LightView, RefusesWhatOneViewCannotHold) {
  const Box3d box{{-2, -1, -3}, {1, 2, 3}};
  EXPECT_THROW(fit_view(light(LightKind::point, {0, 0, 0}, {0, -1, 0}), box), InvalidScene) << "inside";
  EXPECT_THROW(fit_view(light(LightKind::rectangle, {0, 0, 9}, {0, -1, 0}), box), InvalidScene) << "beside";
  EXPECT_THROW(fit_view(light(LightKind::directional, {}, {0, 1, 0}), Box3d{}), InvalidScene) << "nothing";
  Light none;
  none.direction = {};
  EXPECT_THROW(fit_view(none, box), InvalidScene);
}

}  // namespace
}  // namespace treeline::shading::shadow
