// Path tracing against closed forms and against itself: every way to draw paths has the same mean, which is
// the right one.
//
// Seeds are fixed; a mean may be off by five of its standard errors, which chance exceeds once in two million
// comparisons.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "tests/shading/transport_common.hpp"

namespace treeline::test {
namespace {

using transport::Directions, transport::Film, transport::Lights, transport::PathOptions, transport::Points;

constexpr double deviations = 5;

std::vector<PathOptions> all_ways() {
  std::vector<PathOptions> ways;
  for (const Lights lights : {Lights::none, Lights::next_event, Lights::mis})
    for (const Directions directions : {Directions::uniform, Directions::cosine, Directions::bsdf})
      ways.push_back({.directions = directions, .lights = lights, .seed = ways.size()});
  ways.push_back({.points = Points::sobol_owen, .seed = 17});
  ways.push_back({.survival = transport::survive_with(0.6f), .seed = 18});
  return ways;
}

std::string name(const PathOptions& o) {
  return "directions " + std::to_string(int(o.directions)) + ", lights " + std::to_string(int(o.lights)) +
         ", seed " + std::to_string(o.seed);
}

TEST(Paths, WhiteFurnaceStaysWhite) {
  const LitScene room = furnace(0.5f);
  for (const PathOptions& o : all_ways()) {
    const Estimate e = overall(traced(room, o, 64));
    EXPECT_NEAR(e.mean, 1, deviations * e.error) << name(o);
    EXPECT_LT(e.error, 0.02) << name(o);
  }
}

TEST(Paths, FurnaceWithMirrorsAndGlassStaysWhite) {
  LitScene room = furnace(0.5f);
  add_ball(room, {-0.3f, 0, -0.2f}, 0.3f, mirror(1));
  add_ball(room, {0.4f, 0.1f, 0.1f}, 0.25f, glass(1.5));
  for (const PathOptions& o : all_ways()) {
    const Estimate e = overall(traced(room, o, 64));
    EXPECT_NEAR(e.mean, 1, deviations * e.error) << name(o);
    EXPECT_LT(e.error, 0.03) << name(o);
  }
}

// Met by chance, each surface brings (1 - albedo) albedo^bounce, without noise.
TEST(Paths, DepthLadderOfTheFurnaceIsAGeometricSum) {
  const LitScene room = furnace(0.5f);
  for (const int bounces : {0, 1, 2, 5, 10}) {
    PathOptions o{.directions = Directions::cosine, .lights = Lights::none, .max_bounces = bounces};
    o.survival = {};
    const Film film = traced(room, o, 2);
    for (std::size_t i = 0; i < film.size(); ++i)
      ASSERT_NEAR(film.mean(i)[1], 1 - std::pow(0.5, bounces + 1), 1e-6) << bounces;
    o.lights = Lights::mis, o.directions = Directions::uniform;
    const Estimate e = overall(traced(room, o, 64));
    EXPECT_NEAR(e.mean, 1 - std::pow(0.5, bounces + 1), deviations * e.error + 1e-6) << bounces;
  }
}

// Paths that end with probability 1 - q at each hit: the variance is albedo² (1 - q) / (q - albedo²).
TEST(Paths, RouletteHasTheVarianceOfTheory) {
  const LitScene room = furnace(0.5f);
  for (const float q : {0.5f, 0.8f}) {
    PathOptions o{.directions = Directions::cosine, .lights = Lights::none, .max_bounces = 1000};
    o.survival = transport::survive_with(q);
    const Film film = traced(room, o, 1000);
    const Estimate e = overall(film);
    EXPECT_NEAR(e.mean, 1, deviations * e.error);
    const double variance = 0.25 * (1 - double(q)) / (double(q) - 0.25);
    const double measured = e.error * e.error * double(film.size()) * 1000;
    EXPECT_NEAR(measured / variance, 1, 0.05) << q;
  }
}

// A point on the floor sees a parallel rectangle whose corner is above it at height h, of sides a and b: the
// form factor is in every textbook on radiative transfer (Howell, configuration B-3).
double corner_form_factor(double a, double b, double h) {
  const double x = a / h, y = b / h, p = std::sqrt(1 + x * x), q = std::sqrt(1 + y * y);
  return (x / p * std::atan(y / p) + y / q * std::atan(x / q)) / (2 * std::numbers::pi);
}

TEST(Paths, DirectLightIsThatOfTheFormFactor) {
  for (const float height : {1.0f, 0.1f, 0.01f}) {
    LitScene scene;
    add_quad(scene, {-2, 0, -2}, {-2, 0, 2}, {2, 0, 2}, {2, 0, -2}, diffuse(0.5f));
    add_quad(scene, {0, height, 0}, {1, height, 0}, {1, height, 0.5f}, {0, height, 0.5f}, diffuse(0, 3));
    const transport::Film empty(1, 1);
    for (PathOptions o : all_ways()) {
      if (o.points == Points::sobol_owen) o.set = 1024;
      o.max_bounces = 1;
      // Area sampling has a variance of some 4 A / (3 pi h²) means: at 0.01 it is left to the others.
      if (height < 0.1f && o.lights == Lights::next_event) continue;
      Film film(1, 1, o.points == Points::sobol_owen ? o.set : 1);
      trace(scene, o, film, 1 << 14, 1, [](std::size_t, float, float) {
        return geometry::Rayf{{0, 5e-3f, 0}, {0, -1, 0}};
      });
      const Estimate e = overall(film);
      const double truth = 0.5 * 3 * corner_form_factor(1, 0.5, double(height));
      EXPECT_NEAR(e.mean, truth, deviations * e.error + 1e-6) << name(o) << ", height " << height;
      EXPECT_LT(e.error, 0.05 * truth) << name(o) << ", height " << height;
    }
  }
}

// A lamp of side 1 over a closed room: what it sends down falls on the floor, as its form factor says, and
// the rest in equal parts on four walls. A pixel a wall, whose rays end anywhere on it.
TEST(Paths, EachWallOfAClosedBoxIsLitAsFormFactorsSay) {
  constexpr float height = 0.9f, albedo = 0.6f;
  LitScene room;
  add_box(room, {-1, -1, -1}, {1, 1, 1}, false, diffuse(albedo));
  add_quad(room, {-0.5f, height, -0.5f}, {0.5f, height, -0.5f}, {0.5f, height, 0.5f}, {-0.5f, height, 0.5f},
           diffuse(0, 3));
  constexpr int axis[] = {1, 0, 0, 2, 2};
  const Source at_walls = [&](std::size_t wall, float u, float v) {
    const int a = axis[wall];
    geometry::Rayf ray{{}, {}};
    ray.direction[a] = wall == 0 || wall % 2 == 1 ? -1.0f : 1.0f;
    ray.origin[a] = 0.99f * ray.direction[a];
    ray.origin[(a + 1) % 3] = 2 * u - 1, ray.origin[(a + 2) % 3] = 2 * v - 1;
    return ray;
  };
  const auto film_of = [&](PathOptions o, int samples) {
    if (o.points == Points::sobol_owen) o.set = 64;
    Film film(5, 1, o.points == Points::sobol_owen ? o.set : 1);
    trace(room, o, film, samples, 1, at_walls);
    return film;
  };

  constexpr int n = 16;  // points of the lamp along a side
  double to_floor = 0;
  for (int i = 0; i < n; ++i)
    for (int k = 0; k < n; ++k)
      for (const int x : {-1, 1})
        for (const int z : {-1, 1})
          to_floor += corner_form_factor(1 + x * ((i + 0.5) / n - 0.5), 1 + z * ((k + 0.5) / n - 0.5),
                                         1 + double(height)) /
                      (n * n);
  for (PathOptions o : all_ways()) {
    o.max_bounces = 1;
    const Film film = film_of(o, 2048);
    for (std::size_t wall = 0; wall < 5; ++wall) {
      const double share = wall == 0 ? to_floor : (1 - to_floor) / 4, truth = double(albedo) * 3 * share / 4;
      const double error = film.standard_error(wall)[1];
      EXPECT_NEAR(film.mean(wall)[1], truth, deviations * error) << name(o) << ", wall " << wall;
      EXPECT_LT(error, 0.2 * truth) << name(o) << ", wall " << wall;
    }
  }
  const Film reference = film_of({.lights = Lights::next_event, .seed = 100}, 4096);
  for (const PathOptions& o : all_ways()) {
    const Film film = film_of(o, 512);
    for (std::size_t wall = 0; wall < 5; ++wall) {
      const double error = std::hypot(film.standard_error(wall)[1], reference.standard_error(wall)[1]);
      EXPECT_NEAR(film.mean(wall)[1], reference.mean(wall)[1], deviations * error)
          << name(o) << ", wall " << wall;
      EXPECT_LT(error, 0.2 * reference.mean(wall)[1]) << name(o) << ", wall " << wall;
    }
  }
}

TEST(Paths, ClosedRoomIsTheSameByEveryEstimator) {
  const LitScene room = lamp_room();
  const Film reference = traced(room, {.lights = Lights::none, .seed = 100}, 400);
  const Estimate truth = overall(reference);
  for (const PathOptions& o : all_ways()) {
    const Estimate e = overall(traced(room, o, 64));
    EXPECT_NEAR(e.mean, truth.mean, deviations * std::hypot(e.error, truth.error)) << name(o);
  }
}

TEST(Paths, RoughSurfacesAreTheSameByEveryEstimator) {
  LitScene room = lamp_room();
  Material rough;
  rough.kind = shading::SurfaceKind::microfacet, rough.alpha_x = 0.4, rough.alpha_y = 0.2;
  rough.fresnel = shading::FresnelKind::schlick, rough.reflectance = {0.9f, 0.8f, 0.7f};
  add_ball(room, {0.4f, -0.3f, 0.1f}, 0.3f, rough);
  for (Material& m : room.materials)
    if (m.reflectance[0] == 0.7f) m = rough;  // the walls that are not of another albedo
  const Estimate truth = overall(traced(room, {.lights = Lights::none, .seed = 100}, 400));
  for (const PathOptions& o : all_ways()) {
    const Estimate e = overall(traced(room, o, 64));
    EXPECT_NEAR(e.mean, truth.mean, deviations * std::hypot(e.error, truth.error)) << name(o);
  }
}

TEST(Paths, SkyAboveAFloorIsReflectedByItsAlbedo) {
  LitScene scene;
  add_quad(scene, {-2, 0, -2}, {-2, 0, 2}, {2, 0, 2}, {2, 0, -2}, diffuse(0.25f));
  scene.background = {1, 2, 4};
  scene.camera = {
      .position = {0, 1, 0.001}, .target = {0, 0, 0}, .height_angle = 0.5, .width = 4, .height = 4};
  const Film film = traced(scene, {}, 4);
  for (std::size_t i = 0; i < film.size(); ++i)
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(film.mean(i)[k], 0.25 * double(scene.background[k]), 1e-6);
}

TEST(Paths, LightLeavesTheFrontAlone) {
  LitScene scene;
  add_quad(scene, {-2, 0, -2}, {-2, 0, 2}, {2, 0, 2}, {2, 0, -2}, diffuse(0.5f, 1));
  const auto seen_from = [&](float y) {
    Film film(1, 1);
    trace(scene, {}, film, 2, 1, [=](std::size_t, float, float) {
      return geometry::Rayf{{0.1f, y, 0}, {0, y > 0 ? -1.0f : 1.0f, 0}};
    });
    return film.mean(0)[0];
  };
  EXPECT_EQ(seen_from(1), 1);
  EXPECT_EQ(seen_from(-1), 0);
}

TEST(Paths, FilmsDoNotDependOnThreadsOrOnWhenSamplesAreAdded) {
  const LitScene room = lamp_room();
  for (const Points points : {Points::random, Points::sobol_owen}) {
    const PathOptions o{.points = points, .set = 4, .seed = 5};
    const Film whole = traced(room, o, 24, 1);
    for (const int threads : {2, 7}) {
      Film parts = traced(room, o, 5, threads);
      trace(room, o, parts, 0, threads), trace(room, o, parts, 19, threads);
      for (std::size_t i = 0; i < whole.size(); ++i) {
        ASSERT_EQ(parts.mean(i), whole.mean(i));
        ASSERT_EQ(parts.standard_error(i), whole.standard_error(i));
      }
    }
    const Film other = traced(room, {.points = points, .set = 4, .seed = 6}, 24, 1);
    EXPECT_NE(other.mean(0), whole.mean(0));
  }
}

// Waves hold some thousand paths: fewer and more samples of a pixel than that.
TEST(Paths, ManySamplesOfAPixelAreDoneInSeveralWaves) {
  const LitScene room = furnace(0.5f);
  const Source source = [](std::size_t, float, float) { return geometry::Rayf{{0, 0, 0}, {0, -1, 0}}; };
  Film whole(3, 1), parts(3, 1);
  trace(room, {}, whole, 10000, 1, source);
  for (const int n : {1, 4095, 4097, 1807}) trace(room, {}, parts, n, 2, source);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(whole.mean(i), parts.mean(i)) << i;
  EXPECT_NEAR(whole.mean(0)[0], 1, deviations * whole.standard_error(0)[0]);
}

TEST(Paths, RefusesWhatIsNoScene) {
  const LitScene good = furnace(0.5f);
  const auto refuses = [&](auto&& spoil, const std::string& word) {
    LitScene bad = good;
    spoil(bad);
    try {
      traced(bad, {}, 1);
      ADD_FAILURE() << "taken: " << word;
    } catch (const std::invalid_argument& e) {
      EXPECT_NE(std::string(e.what()).find(word), std::string::npos) << e.what();
    }
  };
  refuses([](LitScene& s) { s.face_materials.pop_back(); }, "materials for 11");
  refuses([](LitScene& s) { s.face_materials[3] = 99; }, "face 3");
  refuses([](LitScene& s) { s.materials[0].emission[1] = -1; }, "material 0");
  refuses([](LitScene& s) { s.materials[0].reflectance[2] = NAN; }, "reflectance");
  refuses([](LitScene& s) { s.background[0] = INFINITY; }, "background");
  refuses([](LitScene& s) { s.camera.target = s.camera.position; }, "camera");
  refuses([](LitScene& s) { s.camera.height_angle = 4; }, "camera");
  refuses(
      [](LitScene& s) {
        for (Material& m : s.materials) m.emission = {};
        s.mesh.faces[7][1] = 1000;
      },
      "face 7");
  // Squares of distances leave the range of floats: the message tells how far the scene reaches, 2 of these.
  for (const auto& [unit, told] : {std::pair(1e-20, "2e-20 m"), {1e20, "2e+20 m"}})
    refuses(
        [unit = unit](LitScene& s) {
          for (Vec3f& v : s.mesh.vertices) v = Vec3f(Vec3d(v) * unit);
          s.camera.position = s.camera.position * unit, s.camera.target = s.camera.target * unit;
        },
        told);
}

TEST(Paths, RefusesOptionsOutOfRange) {
  const LitScene room = furnace(0.5f);
  using transport::InvalidOptions;
  EXPECT_THROW(traced(room, {.max_bounces = -1}, 1), InvalidOptions);
  EXPECT_THROW(traced(room, {.set = 0}, 1), InvalidOptions);
  EXPECT_THROW(traced(room, {}, -1), InvalidOptions);
  EXPECT_THROW(traced(room, {}, 1, 0), std::invalid_argument);
  EXPECT_THROW(transport::survive_with(0), InvalidOptions);
  EXPECT_THROW(transport::survive_with(NAN), InvalidOptions);
  EXPECT_THROW(transport::survive_by_throughput(0, 0.5f, 0.4f), InvalidOptions);
  Film wide(17, 12), turned(12, 16), pairs(16, 12, 2);
  for (Film* film : {&wide, &turned, &pairs})
    EXPECT_THROW(trace(room, {}, *film, 1), InvalidOptions) << film->width();
}

}  // namespace
}  // namespace treeline::test
