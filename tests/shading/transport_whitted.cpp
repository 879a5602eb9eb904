// Whitted's tracer: how many rays there can be, and scenes whose light is known.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/shading/transport_common.hpp"

namespace treeline::test {
namespace {

using transport::Film, transport::WhittedCounts, transport::WhittedOptions;

/// Many balls of mirror and glass in a room with a lamp.
LitScene balls() {
  LitScene room = lamp_room();
  add_ball(room, {0.5f, -0.6f, 0.3f}, 0.35f, glass(1.5));
  add_ball(room, {-0.5f, 0.3f, 0.2f}, 0.3f, mirror(0.9f));
  add_ball(room, {0.5f, 0.3f, -0.2f}, 0.3f, glass(1.3));
  return room;
}

TEST(Whitted, RaysAreWithinTheirBounds) {
  const LitScene room = balls();
  Film film(24, 16);
  const WhittedOptions options{.max_bounces = 6, .shadow_rays = 3};
  const WhittedCounts counts = trace_whitted(room, options, film, 4);
  const auto n = static_cast<double>(counts.primary);
  EXPECT_EQ(counts.primary, 24u * 16 * 4);
  ASSERT_EQ(counts.bounces.size(), 7u);
  double arrived = n, all = n;
  for (std::size_t k = 0; k < counts.bounces.size(); ++k) {
    const transport::BounceCounts& c = counts.bounces[k];
    const double left = static_cast<double>(c.reflected + c.refracted);
    EXPECT_LE(left, 2 * arrived) << k;
    EXPECT_LE(left, std::pow(2, double(k) + 1) * n) << k;
    EXPECT_LE(static_cast<double>(c.shadow), 3 * arrived) << k;
    arrived = left, all += left;
  }
  EXPECT_LE(all, n * (std::pow(2, 7) - 1));
  EXPECT_EQ(arrived, 0) << "rays that leave the last hits are not followed";
  EXPECT_GT(counts.bounces[0].refracted, 0u);
  EXPECT_GT(counts.bounces[3].reflected, 0u);
}

// Between two panes of glass that never end, every ray becomes two at every bounce: the bound is met.
TEST(Whitted, BoundIsMetAmongPanes) {
  LitScene scene;
  for (int i = 0; i < 40; ++i) {
    const float z = static_cast<float>(i - 20);
    add_quad(scene, {-50, -50, z}, {50, -50, z}, {50, 50, z}, {-50, 50, z}, glass(1.0001));
  }
  Film film(1, 1);
  const WhittedCounts counts = trace_whitted(scene, {.max_bounces = 4}, film, 1, 1, [](auto...) {
    return geometry::Rayf{{0, 0, 0.5f}, {0, 0, 1}};
  });
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_EQ(counts.bounces[k].reflected, 1u << k);
    EXPECT_EQ(counts.bounces[k].refracted, 1u << k);
  }
  EXPECT_EQ(counts.bounces[4].reflected, 0u);
}

TEST(Whitted, MirrorsMultiply) {
  LitScene scene;  // two mirrors that face each other
  add_quad(scene, {-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1}, mirror(0.5f));
  add_quad(scene, {-1, -1, 1}, {-1, 1, 1}, {1, 1, 1}, {1, -1, 1}, mirror(0.25f));
  scene.background = {8, 8, 8};
  Film film(1, 1);
  const Vec3f way = normalized(Vec3f{0.6f, 0, -1});
  trace_whitted(scene, {}, film, 1, 1, [=](auto...) { return geometry::Rayf{{-0.9f, 0, 0}, way}; });
  EXPECT_NEAR(film.mean(0)[0], 8 * 0.5 * 0.25, 1e-6);  // met at x = -0.3 and 0.9; the third would be at 2.1
}

// A pane of glass, two surfaces: R passes on the outer side, and what goes through is all that is not sent
// back, summed over the reflections inside.
TEST(Whitted, PaneLetsThroughWhatTheSeriesSays) {
  LitScene scene;
  add_box(scene, {-50, -50, -0.5f}, {50, 50, 0.5f}, true, glass(1.5));
  add_quad(scene, {-500, -500, -2}, {500, -500, -2}, {500, 500, -2}, {-500, 500, -2}, diffuse(0, 1));
  Film film(1, 1);
  trace_whitted(scene, {.max_bounces = 12, .shadow_rays = 0}, film, 1, 1, [](auto...) {
    return geometry::Rayf{{0, 0, 3}, {0, 0, -1}};
  });
  const double r = 0.04;  // ((1.5 - 1) / (1.5 + 1))²
  EXPECT_NEAR(film.mean(0)[0], (1 - r) / (1 + r), 1e-5);
}

TEST(Whitted, DirectLightIsThatOfThePathTracer) {
  const LitScene room = lamp_room();
  Film film(24, 16);
  trace_whitted(room, {.shadow_rays = 4}, film, 50);
  const Estimate e = overall(film), truth = overall(traced(room, {.max_bounces = 1}, 200));
  EXPECT_NEAR(e.mean, truth.mean, 5 * std::hypot(e.error, truth.error));
}

TEST(Whitted, AmbientLightIsReflectedByDiffuseSurfaces) {
  LitScene room = furnace(0.5f);
  for (Material& m : room.materials) m.emission = {};
  Film film(16, 12);
  trace_whitted(room, {.ambient = {1, 2, 3}}, film, 1);
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(film.mean(7)[k], 0.5 * (k + 1), 1e-6);
}

TEST(Whitted, FilmsAndCountsDoNotDependOnThreads) {
  const LitScene room = balls();
  Film one(24, 16), many(24, 16);
  const WhittedCounts counts = trace_whitted(room, {}, one, 9, 1);
  const WhittedCounts first = trace_whitted(room, {}, many, 5, 3),
                      second = trace_whitted(room, {}, many, 4, 2);
  for (std::size_t i = 0; i < one.size(); ++i) ASSERT_EQ(one.mean(i), many.mean(i));
  for (std::size_t k = 0; k < counts.bounces.size(); ++k) {
    EXPECT_EQ(counts.bounces[k].refracted, first.bounces[k].refracted + second.bounces[k].refracted);
    EXPECT_EQ(counts.bounces[k].shadow, first.bounces[k].shadow + second.bounces[k].shadow);
  }
}

TEST(Whitted, RefusesOptionsOutOfRange) {
  const LitScene room = furnace(0.5f);
  Film film(16, 12);
  EXPECT_THROW(trace_whitted(room, {.max_bounces = -1}, film, 1), transport::InvalidOptions);
  EXPECT_THROW(trace_whitted(room, {.max_bounces = 21}, film, 1), transport::InvalidOptions);
  EXPECT_THROW(trace_whitted(room, {.shadow_rays = -1}, film, 1), transport::InvalidOptions);
  EXPECT_THROW(trace_whitted(room, {}, film, -1), transport::InvalidOptions);
}

TEST(Whitted, RefusesFilmsThatAreNotTheCameras) {
  const LitScene room = furnace(0.5f);
  Film wide(17, 12), turned(12, 16), pairs(16, 12, 2);
  for (Film* film : {&wide, &turned, &pairs})
    EXPECT_THROW(trace_whitted(room, {}, *film, 1), transport::InvalidOptions) << film->width();
}

}  // namespace
}  // namespace treeline::test
