// The literal pseudo-code has the biases that theory gives it, to the figure, and mended none.
//
// Seeds are fixed; five standard errors, as in transport_paths.cpp.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/shading/transport_common.hpp"

namespace treeline::test {
namespace {

using transport::Film, transport::TextbookOptions;

Estimate read(const LitScene& room, const TextbookOptions& options, int samples) {
  Film film(room.camera.width, room.camera.height);
  trace_textbook(room, options, film, samples);
  return overall(film);
}
/// The share of the furnace's radiance, which is 1, that is seen.
void expect(const LitScene& room, const TextbookOptions& options, double truth, const char* what) {
  const Estimate e = read(room, options, 200);
  EXPECT_NEAR(e.mean, truth, 5 * e.error) << what;
  EXPECT_LT(e.error, 0.02) << what;
}

// Each surface emits ½ and reflects ½: ¼ is light drawn at the first hit, ¼ comes later, ½ is seen at once.
TEST(Textbook, EmissiveFurnaceAsWrittenIsAQuarter) {
  const LitScene room = furnace(0.5f);
  expect(room, {}, 0.25, "as written");
  expect(room, {.emission_seen = true}, 0.75, "what is seen emits");
  expect(room, {.drop_reflected_emitters = false, .emission_seen = true}, 1, "mended");
}

TEST(Textbook, RouletteBeforeUndividedLightGivesPTimesTheTruth) {
  LitScene room = furnace(0.5f);
  for (const float p : {0.5f, 0.8f}) {
    // With emission reflected and not seen, the truth is ½.
    expect(room, {.survival = p, .roulette_first = true, .drop_reflected_emitters = false}, 0.5 * double(p),
           "first");
    expect(room, {.survival = p, .drop_reflected_emitters = false}, 0.5, "after");
  }
}

// The n-th reflection is 4^-n of what it should be: ½ · Σ (½)^n becomes ½ · ½ · Σ (⅛)^n.
TEST(Textbook, HemisphereOfHalfPiDarkensEachBounceFourfold) {
  expect(furnace(0.5f), {.hemisphere_half_pi = true, .drop_reflected_emitters = false}, 0.25 / (1 - 0.125),
         "pi / 2");
}

TEST(Textbook, MendedItAgreesWithThePathTracer) {
  const LitScene room = lamp_room();
  const Estimate truth = overall(traced(room, {.seed = 3}, 100));
  const Estimate mended = read(room, {.drop_reflected_emitters = false, .emission_seen = true}, 200);
  EXPECT_NEAR(mended.mean, truth.mean, 5 * std::hypot(mended.error, truth.error));
  // As written it is right here, too: the lamp is out of sight, and reflects nothing.
  const Estimate literal = read(room, {}, 200);
  EXPECT_NEAR(literal.mean, truth.mean, 5 * std::hypot(literal.error, truth.error));
}

TEST(Textbook, FilmsDoNotDependOnThreads) {
  const LitScene room = furnace(0.5f);
  Film one(16, 12), many(16, 12);
  trace_textbook(room, {}, one, 20, 1);
  trace_textbook(room, {}, many, 13, 3), trace_textbook(room, {}, many, 7, 2);
  for (std::size_t i = 0; i < one.size(); ++i) ASSERT_EQ(one.mean(i), many.mean(i));
}

TEST(Textbook, RefusesOptionsOutOfRange) {
  const LitScene room = furnace(0.5f);
  Film film(16, 12);
  for (const float p : {0.0f, -1.0f, 1.5f, NAN})
    EXPECT_THROW(trace_textbook(room, {.survival = p}, film, 1), transport::InvalidOptions) << p;
  EXPECT_THROW(trace_textbook(room, {.max_bounces = -1}, film, 1), transport::InvalidOptions);
  EXPECT_THROW(trace_textbook(room, {}, film, -1), transport::InvalidOptions);
}

TEST(Textbook, RefusesFilmsThatAreNotTheCameras) {
  const LitScene room = furnace(0.5f);
  Film wide(17, 12), turned(12, 16), pairs(16, 12, 2);
  for (Film* film : {&wide, &turned, &pairs})
    EXPECT_THROW(trace_textbook(room, {}, *film, 1), transport::InvalidOptions) << film->width();
}

}  // namespace
}  // namespace treeline::test
