// The task light_transport: its witnesses against each other, what its judge says of known errors, every
// method against light that is known without a ray, and its programs.
#include "bench/light_transport/task.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "bench/light_transport/judge.hpp"
#include "datasets_gen/rooms/room.hpp"
#include "geometry/random.hpp"

namespace treeline::bench::light_transport {
namespace {

using geometry::Vec3d;
using Json = nlohmann::json;

const LightTransportTask& task() {
  static const LightTransportTask t;
  return t;
}
RunContext smoke() { return {.profile = Profile::smoke, .seed = 1, .threads = 1, .truth_cache = ""}; }

std::size_t number_of(const std::string& method) {
  for (std::size_t m = 0; m < task().methods().size(); ++m)
    if (task().methods()[m].name == method) return m;
  throw std::out_of_range(method);
}

// ---- witnesses
// ---------------------------------------------------------------------------------------------

TEST(BoxRadiosity, FormFactorsOfACube) {
  const Patch floor{1, 0, {-1, 0, -1}, {1, 0, 1}}, ceiling{1, 2, {-1, 0, -1}, {1, 0, 1}},
      wall{0, -1, {0, 0, -1}, {0, 2, 1}};
  // Howell's catalogue, C-11 and C-14.
  EXPECT_NEAR(form_factor(floor, ceiling), 0.1998249, 1e-7);
  EXPECT_NEAR(form_factor(floor, wall), 0.2000438, 1e-7);
  EXPECT_NEAR(form_factor(floor, ceiling) + 4 * form_factor(floor, wall), 1, 1e-12);
  // A part of a wall: reciprocity, and what a sum over points says.
  const Patch part{0, -1, {0, 0.3, -0.2}, {0, 0.9, 0.7}}, tile{1, 0, {-0.7, 0, 0.1}, {0.4, 0, 0.6}};
  EXPECT_NEAR(form_factor(part, tile) * part.area(), form_factor(tile, part) * tile.area(), 1e-14);
  constexpr int n = 24;
  double sum = 0;
  for (int a = 0; a < n; ++a)
    for (int b = 0; b < n; ++b)
      for (int c = 0; c < n; ++c)
        for (int d = 0; d < n; ++d) {
          const auto at = [](double low, double high, int k) { return low + (high - low) * (k + 0.5) / n; };
          const Vec3d way =
              Vec3d{at(-0.7, 0.4, a), 0, at(0.1, 0.6, b)} - Vec3d{-1, at(0.3, 0.9, c), at(-0.2, 0.7, d)};
          const double r2 = dot(way, way);
          sum += way[0] * -way[1] / (std::numbers::pi * r2 * r2);
        }
  EXPECT_NEAR(form_factor(part, tile), sum * tile.area() / (n * n * n * double(n)), 1e-4);
}

TEST(BoxRadiosity, LightIsKeptAndDirectLightIsTheFormFactorsIntegral) {
  for (const auto& [albedo, side] : {std::pair{0.75, 0.6}, {0.3, 0.1}, {0.0, 1.5}}) {
    const double emission = (1 - albedo) * 24 / (side * side);
    const BoxLight light = box_radiosity(albedo, side, emission, 2);
    EXPECT_LT(light.error, 2e-3);
    const auto all = light.sum(1000), direct = light.sum(1);
    const double area[] = {4, 4, 4, 4, 4, 4 - side * side, side * side};
    double mean = 0;
    for (std::size_t w = 0; w < box_walls; ++w) mean += all[w] * area[w] / 24;
    EXPECT_NEAR(mean, 1, 1e-9);
    EXPECT_NEAR(all[1], all[4], 1e-9) << "the walls are alike";
    constexpr int n = 64;
    double floor = 0;
    for (int i = 0; i < n; ++i)
      for (int k = 0; k < n; ++k) {
        const double x = -1 + 2 * (i + 0.5) / n, z = -1 + 2 * (k + 0.5) / n, h = side / 2;
        floor += rectangle_form_factor(-h - x, h - x, -h - z, h - z, 2) / (n * n);
      }
    EXPECT_NEAR(direct[0], albedo * emission * floor, 2e-4 * std::max(1e-3, direct[0]));
  }
  EXPECT_THROW(box_radiosity(1, 0.5, 1), std::invalid_argument);
  EXPECT_THROW(box_radiosity(0.5, 2, 1), std::invalid_argument);
}

TEST(KnownLight, RectangleOverAPlane) {
  EXPECT_NEAR(rectangle_form_factor(-1e4, 1e4, -1e4, 1e4, 1), 1, 1e-7) << "all of the sky";
  EXPECT_NEAR(rectangle_form_factor(-0.01, 0.01, -0.01, 0.01, 1), 4e-4 / std::numbers::pi, 1e-7)
      << "far away";
  double sum = 0;
  constexpr int n = 400;
  for (int i = 0; i < n; ++i)
    for (int k = 0; k < n; ++k) {
      const double x = 0.2 + 0.7 * (i + 0.5) / n, y = -0.4 + 1.1 * (k + 0.5) / n, r2 = x * x + y * y + 0.09;
      sum += 0.09 / (std::numbers::pi * r2 * r2) * (0.7 / n) * (1.1 / n);
    }
  EXPECT_NEAR(rectangle_form_factor(0.2, 0.9, -0.4, 0.7, 0.3), sum, 1e-6);
}

TEST(KnownLight, RaysAtWallsCoverThemEvenly) {
  constexpr double side = 0.6;
  const RaySource source = rays_at_walls(side);
  const double area[] = {4, 4, 4, 4, 4, 4 - side * side, side * side};
  geometry::Pcg32 random(7);
  for (std::size_t wall = 0; wall < box_walls; ++wall) {
    Vec3d mean{}, square{};
    constexpr int n = 40'000;
    for (int i = 0; i < n; ++i) {
      const geometry::Rayf ray = source(wall + 7 * 5, random.uniform<float>(), random.uniform<float>());
      const Vec3d p = Vec3d(ray.origin) + 1e-2 * Vec3d(ray.direction);
      const double out = std::max({std::abs(p[0]), std::abs(p[1] - 1), std::abs(p[2])});
      ASSERT_NEAR(out, 1, 1e-5);
      if (p[1] > 1.99999) {
        const bool lamp = std::max(std::abs(p[0]), std::abs(p[2])) < 0.5 * side;
        ASSERT_EQ(lamp, wall == std::size_t(BoxWall::lamp)) << p[0] << " " << p[2];
      }
      const Vec3d q{p[0], p[1] - 1, p[2]};
      for (int k = 0; k < 3; ++k) mean[k] += q[k] / n, square[k] += q[k] * q[k] / n;
    }
    // Second moments of a square of side 2, of one of side `side`, and of the frame between them.
    const double small = side * side / 12, big = 4.0 / 12;
    const double level = wall == std::size_t(BoxWall::lamp)      ? small
                         : wall == std::size_t(BoxWall::ceiling) ? (4 * big - side * side * small) / area[5]
                                                                 : big;
    const bool upright = wall >= 1 && wall <= 4;
    for (int k = 0; k < 3; ++k) {
      const bool across = upright ? k == (wall <= 2 ? 0 : 2) : k == 1;
      if (across) continue;
      EXPECT_NEAR(mean[k], 0, 5 * std::sqrt(level / n)) << wall;
      EXPECT_NEAR(square[k], level, 0.02 * level) << wall;
    }
  }
}

// ---- the judge
// ---------------------------------------------------------------------------------------------

TEST(LightJudge, RelativeErrors) {
  const std::vector<Vec3d> truth{{1, 1, 1}, {3, 3, 3}}, off{{0.1, 0.1, 0.1}, {0, 0, 0}};
  EXPECT_NEAR(relative_rms(off, truth), std::sqrt(0.5 * 0.01 / (1 + 0.01 * 4)), 1e-12);
  const std::vector<Vec3d> dark(2);
  EXPECT_EQ(relative_rms(dark, dark), 0) << "black, and answered so";
}

TEST(LightJudge, ChanceIsToldFromBias) {
  geometry::Pcg32 random(3);
  std::vector<double> off;
  for (int i = 0; i < 1000; ++i) off.push_back(random.uniform() - 0.5);
  const ZTest fair = z_test(off);
  EXPECT_TRUE(fair.applies);
  EXPECT_LT(std::abs(fair.z), 4);
  for (double& x : off) x += 0.1;  // 0.1 over 0.2887 / sqrt(1000)
  EXPECT_NEAR(z_test(off).z, fair.z + 0.1 / (std::sqrt(1.0 / 12 / 1000)), 0.6);
  EXPECT_LT(z_test(off, 0.1).z, 1.5) << "what the truth itself may be off by counts too";
  std::vector<double> rare(1000, -0.001);
  rare[17] = 1;
  EXPECT_FALSE(z_test(rare).applies) << "one sample is all of it";
  EXPECT_EQ(z_test(std::vector<double>(100, 0.0)).z, 0);
  EXPECT_GT(z_test(std::vector<double>(100, 0.5)).z, 1e6);
  EXPECT_FALSE(z_test(std::vector<double>(10, 0.5)).applies) << "too few";
}

TEST(LightJudge, FilmsOfKnownError) {
  Truth truth;
  truth.radiance.assign(100, Vec3d{1, 1, 1});
  const auto film_of = [](float bias, float noise) {
    geometry::Pcg32 random(5);
    Film film(10, 10);
    for (std::size_t p = 0; p < 100; ++p)
      for (int s = 0; s < 16; ++s)
        film.add(p, Rgb::filled(1 + bias + noise * (random.uniform<float>() - 0.5f)));
    return film;
  };
  const Errors fair = judged(film_of(0, 1), truth, true);
  EXPECT_TRUE(fair.within_claim) << fair.reason;
  EXPECT_TRUE(fair.extra["light_transport_z_tested"]);
  EXPECT_NEAR(*fair.error, 0.2887 / 4 / std::sqrt(1.01), 0.02);
  const Errors biased = judged(film_of(0.1f, 1), truth, true);
  EXPECT_FALSE(biased.within_claim);
  EXPECT_NEAR(*biased.bias, 0.1, 0.02);
  EXPECT_TRUE(judged(film_of(0.1f, 1), truth, false).within_claim) << "it never claimed to be unbiased";
  Film broken = film_of(0, 1);
  broken.add(37, Rgb{1, std::nanf(""), 1});
  const Errors e = judged(broken, truth, false);
  EXPECT_FALSE(e.within_claim);
  EXPECT_NE(e.reason.find("pixel 37"), std::string::npos);
}

// ---- methods
// -----------------------------------------------------------------------------------------------

std::unique_ptr<Block> open(const std::string& room, std::size_t n = 200) {
  return task().open(BlockSpec{room, n}, smoke());
}
/// Its truth is found once for all tests.
Block& closed_box() {
  static const auto block = open("closed_box");
  return *block;
}
Errors answer(Block& block, const std::string& method, const Knobs& knobs, std::size_t set) {
  const std::size_t m = number_of(method);
  const auto subject = block.build(m, task().methods()[m].build_knobs.front(), 1);
  subject->run(set, knobs, 1);
  return block.check(m, *subject, set, knobs);
}

/// Those of the closed box that claim to be unbiased; mis with knobs of its own, too.
struct Unbiased {
  const char* method;
  Knobs knobs = Knobs::object();
  /// A path's weight has four moments, so that few paths make their mean normal. That of directions drawn
  /// evenly, 1.5 times the cosine a bounce, lacks the fourth (1.5⁴ / 5 is above 0.95³), with the textbook's
  /// survival the third (1.5³ / 4 is above 0.8²); with survival 0.5 there is not even a second (0.75²).
  bool light_tails = true;
};
const std::vector<Unbiased>& unbiased() {
  static const std::vector<Unbiased> all{{"path_uniform", Knobs::object(), false},
                                         {"path_cosine"},
                                         {"next_event_uniform", Knobs::object(), false},
                                         {"next_event_cosine"},
                                         {"textbook_corrected", Knobs::object(), false},
                                         {"mis"},
                                         {"mis", {{"points", "sobol"}}},
                                         {"mis", {{"survival", 0.9}}},
                                         {"mis", {{"survival", 0.5}}, false},
                                         {"mis_embree"}};
  return all;
}
bool built(const std::string& method) {
  return std::ranges::none_of(task().not_built(), [&](const auto& m) { return m.first == method; });
}

/// Each wall's mean, by every way to draw directions and to reach lamps, against radiosity.
TEST(LightMethods, UnbiasedOnesFindTheLightOfAClosedBox) {
  Block& block = closed_box();
  ASSERT_EQ(block.query_sets().at(1).name, "walls");
  std::set<std::string> named, offered;
  for (const Unbiased& u : unbiased()) {
    named.insert(u.method);
    if (!built(u.method)) continue;
    // All of the light, and what five bounces leave: by so many no weight grows out of bounds.
    for (const bool ends : {false, true}) {
      Knobs knobs = u.knobs;
      knobs["samples"] = ends ? 64 : 32;
      if (ends) knobs["bounces"] = 5;
      Errors e = answer(block, u.method, knobs, 1);
      EXPECT_TRUE(e.within_claim) << u.method << " " << knobs << ": " << e.reason;
      EXPECT_TRUE(e.extra["light_transport_z_tested"] || !(u.light_tails || ends))
          << u.method << " " << knobs << ": skew " << e.extra["light_transport_z_skew"];
    }
  }
  for (const MethodInfo& info : task().methods())
    if (info.claim == Claim::stochastic && block.offers(number_of(info.name))) offered.insert(info.name);
  for (const auto& [method, package] : task().not_built()) offered.insert(method);
  EXPECT_EQ(named, offered);
}

TEST(LightMethods, AnotherSeedDrawsOtherPaths) {
  const auto seen = [](const std::string& method, std::uint64_t seed) {
    RunContext context = smoke();
    context.seed = seed;
    const auto block = task().open(BlockSpec{"closed_box", 200}, context);
    const std::size_t m = number_of(method);
    const auto subject = block->build(m, task().methods()[m].build_knobs.front(), 1);
    subject->run(0, {{"samples", 4}}, 1);
    const Film& film = LightBlock::film(*subject);
    std::vector<double> brightness{double(block->dataset_hash())};
    for (std::size_t p = 0; p < film.size(); ++p) brightness.push_back(film.mean(p)[1]);
    return brightness;
  };
  for (const MethodInfo& info : task().methods()) {
    const auto one = seen(info.name, 1), two = seen(info.name, 2);
    EXPECT_EQ(one[0], two[0]) << "this room is the same for any seed";
    EXPECT_EQ(one, seen(info.name, 1)) << info.name;
    EXPECT_NE(one, two) << info.name;
  }
  TruthOptions first, second;
  second.seed = 2;
  EXPECT_NE(truth_hash(first), truth_hash(second)) << "or one truth would be taken for the other's";
}

TEST(LightMethods, FewerBouncesAreDarkerAsRadiositySays) {
  Block& block = closed_box();
  for (const int bounces : {1, 2, 5}) {
    const Errors e = answer(block, "mis", {{"samples", 64}, {"bounces", bounces}}, 1);
    const double told = e.extra["light_transport_floor_bias"], exact = e.extra["light_transport_floor_exact"],
                 error = e.extra["light_transport_floor_error"];
    EXPECT_NEAR(told, exact, 5 * error + 1e-4) << bounces;
    EXPECT_LT(exact, -0.05);
  }
}

TEST(LightMethods, ThePseudoCodeIsBiasedAsItsFaultsSay) {
  Block& block = closed_box();
  const auto bias = [&](const char* slip) {
    const Errors e = answer(block, "textbook_literal", {{"samples", 64}, {"slip", slip}}, 1);
    EXPECT_GT(std::abs(e.extra["light_transport_z"].get<double>()), rejected_z) << slip;
    EXPECT_TRUE(e.within_claim) << slip << " claims nothing";
    return *e.bias;
  };
  EXPECT_LT(bias("emitters"), -0.05);
  // The die first, the direct light not divided: all of the image times the probability to survive, 0.8.
  EXPECT_NEAR((1 + bias("roulette_first")) / (1 + bias("emitters")), 0.8, 0.02);
  const Errors right = answer(block, "textbook_corrected", {{"samples", 64}}, 1);
  EXPECT_TRUE(right.within_claim) << right.reason;
}

TEST(LightMethods, FurnacesAreOfOneRadiance) {
  const auto block = open("furnace_spheres", 600);
  for (const MethodInfo& info : task().methods()) {
    if (info.claim != Claim::stochastic || !block->offers(number_of(info.name))) continue;
    const Errors e = answer(*block, info.name, {{"samples", 16}}, 0);
    EXPECT_TRUE(e.within_claim) << info.name << ": " << e.reason;
    EXPECT_EQ(*e.floor, 0);
  }
}

TEST(LightMethods, EmbreesRaysTellTheSame) {
  for (const auto& [name, package] : task().not_built())
    if (name == "mis_embree") GTEST_SKIP() << package << " is absent";
  const auto block = open("glass_and_mirror", 600);
  const auto image = [&](const std::string& method) {
    const std::size_t m = number_of(method);
    const auto subject = block->build(m, task().methods()[m].build_knobs.front(), 1);
    subject->run(0, {{"samples", 16}}, 1);
    return LightBlock::film(*subject);
  };
  const Film a = image("mis"), b = image("mis_embree");
  std::vector<Vec3d> off, is;
  for (std::size_t p = 0; p < a.size(); ++p) off.push_back(a.mean(p) - b.mean(p)), is.push_back(a.mean(p));
  double alike = 0;
  for (const Vec3d& d : off) alike += length(d) < 1e-3;
  EXPECT_GT(alike / double(off.size()), 0.9) << "the same paths, but where rays meet edges";
}

TEST(LightMethods, RaysMultiplyNoFasterThanTheyMay) {
  for (const char* room : {"glass_panes", "glass_and_mirror", "mirror_hall"}) {
    const auto block = open(room, 600);
    const Errors e = answer(*block, "whitted", {{"samples", 4}, {"bounces", 5}, {"shadow_rays", 4}}, 0);
    for (int k = 1; k <= 5; ++k) {
      const double rays = e.extra["light_transport_bounce_" + std::to_string(k)];
      EXPECT_LE(rays, std::pow(2, k)) << room;
      if (std::string(room) == "mirror_hall") EXPECT_LE(rays, 1) << "mirrors split no ray";
    }
    if (std::string(room) == "glass_panes")
      EXPECT_GT(e.extra["light_transport_bounce_2"].get<double>(), 1.2) << "glass does";
  }
}

TEST(LightMethods, TextbooksDoNotOfferMirrors) {
  const auto block = open("mirror_hall", 600);
  EXPECT_FALSE(block->offers(number_of("textbook_corrected")));
  EXPECT_TRUE(block->offers(number_of("mis")));
}

// ---- programs
// ----------------------------------------------------------------------------------------------

int run(const std::string& command, const std::string& errors = "/dev/null") {
  const int status = std::system(("{ " + command + "; } >/dev/null 2>" + errors).c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}
std::string bytes(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}
std::filesystem::path folder() {
  const auto path = std::filesystem::temp_directory_path() / ("treeline_light_" + std::to_string(getpid()));
  std::filesystem::create_directories(path);
  return path;
}
std::vector<Json> rows_of(const std::string& arguments) {
  const auto file = folder() / "rows.jsonl";
  std::filesystem::remove(file);
  EXPECT_EQ(run(LIGHT_TRANSPORT_TEST_PROGRAM " --rows " + file.string() + " " + arguments), 0) << arguments;
  std::vector<Json> rows;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) rows.push_back(Json::parse(line));
  return rows;
}

TEST(LightProgram, SmokeAnswersEverything) {
  std::set<std::string> methods;
  for (const Json& row : rows_of("--profile smoke")) {
    methods.insert(row["method"]);
    EXPECT_TRUE(row["status"] == "ok" || row["status"] == "not_built") << row;
  }
  EXPECT_EQ(methods.size(), task().methods().size() + task().not_built().size());
}

TEST(LightProgram, HardCasesThatMustBeRefused) {
  const auto rows = rows_of(
      "--stress --dataset light_nan_emission --dataset light_face_without_material --dataset light_none "
      "--benchmark_filter='/(mis|whitted)/'");
  EXPECT_EQ(rows.size(), 18u);
  for (const Json& row : rows)
    EXPECT_EQ(row["status"], row["dataset"] == "light_none" ? "ok" : "refused") << row;
}

TEST(LightProgram, RoomsTakeKnobsAndUsersMeshes) {
  const std::string one = " --profile smoke --benchmark_filter='/mis/.*samples=4,*[^,]*$'";
  EXPECT_EQ(run(LIGHT_TRANSPORT_TEST_PROGRAM " --dataset closed_box_0.5_1:100" + one), 0);
  for (const char* bad : {"closed_box_2", "icosphere"})
    EXPECT_EQ(run(LIGHT_TRANSPORT_TEST_PROGRAM " --dataset " + std::string(bad) + one), 2) << bad;
  const auto tent = folder() / "tent.obj";
  std::ofstream(tent) << "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 3 4\nf 1 4 2\nf 2 4 3\n";
  EXPECT_EQ(run(LIGHT_TRANSPORT_TEST_PROGRAM " --input " + tent.string() + one), 0);
}

#ifdef LIGHT_TRANSPORT_TEST_RENDER
TEST(LightProgram, Renders) {
  const auto at = folder();
  const std::string render = LIGHT_TRANSPORT_TEST_RENDER " ";
  const std::string exr = (at / "room.exr").string(), png = (at / "room.png").string();
  std::filesystem::remove(exr), std::filesystem::remove(png);
  const std::string small = " --samples 16 --width 24 --height 24 --n 100";
  EXPECT_EQ(run(render + "cornell_box " + exr + " " + png + small), 0);
  EXPECT_GT(std::filesystem::file_size(exr), 300u);
  EXPECT_GT(std::filesystem::file_size(png), 300u);
  EXPECT_EQ(run(render + "cornell_box " + exr + small), 2) << "files are not replaced unasked";
  const std::string image = bytes(exr), shown = bytes(png);
  EXPECT_EQ(run(render + "cornell_box " + exr + " " + png + " --force --threads 3" + small), 0);
  EXPECT_TRUE(bytes(exr) == image && bytes(png) == shown) << "threads make no difference";
  EXPECT_EQ(run(render + "cornell_box " + exr + " --force --seed 2" + small), 0);
  EXPECT_FALSE(bytes(exr) == image) << "a seed does";
  const auto tent = at / "tent.obj";
  std::ofstream(tent) << "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 3 4\nf 1 4 2\nf 2 4 3\n";
  EXPECT_EQ(run(render + tent.string() + " " + exr + " --force" + small), 0);
  const auto told = at / "told";
  const auto aims = [&](const std::string& error) {
    EXPECT_EQ(run(render + "cornell_box " + exr + " --force --error " + error + small, told), 0);
    return bytes(told).find("--error " + error + " was not reached by 16 samples") != std::string::npos;
  };
  EXPECT_TRUE(aims("1e-06"));
  EXPECT_FALSE(aims("1000"));
  for (const char* bad : {"nowhere.obj a.exr", "cornell_box a.jpg", "cornell_box a.exr a.exr",
                          "cornell_box a.exr --seed -1", "cornell_box a.exr --seed 18446744073709551616"})
    EXPECT_EQ(run(render + bad), 2) << bad;
  std::filesystem::remove_all(at);
}

TEST(LightProgram, SaysHowMuchMemoryAnImageTakes) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "the sanitizer needs more addresses than any limit leaves";
#endif
  const auto at = folder();
  const std::string errors = (at / "errors").string();
  EXPECT_EQ(run("ulimit -v 4000000; " LIGHT_TRANSPORT_TEST_RENDER " closed_box " + (at / "a.exr").string() +
                    " --width 16384 --height 16384 --samples 1 --threads 1",
                errors),
            2);
  const std::string said = bytes(errors);
  EXPECT_NE(said.find("16384 x 16384 pixels"), std::string::npos) << said;
  EXPECT_NE(said.find("39.00 GiB"), std::string::npos) << said;  // 120 and 36 bytes a pixel
  EXPECT_FALSE(std::filesystem::exists(at / "a.exr"));
  std::filesystem::remove_all(at);
}
#endif

}  // namespace
}  // namespace treeline::bench::light_transport
