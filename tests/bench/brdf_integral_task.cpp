// The task brdf_integral: its truths beside closed forms and each other, every method through its cells, and
// answers that its judge must not let pass.
#include "bench/brdf_integral/task.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <set>

#include "bench/brdf_integral/block.hpp"
#include "bench/brdf_integral/bounce_walk.hpp"
#include "bench/brdf_integral/shape_truth.hpp"
#include "bench/brdf_integral/surface_truth.hpp"
#include "datasets_gen/hard/hard_surfaces.hpp"
#include "datasets_gen/surfaces/surface.hpp"
#include "geometry/random.hpp"

namespace treeline::bench::brdf_integral {
namespace {

constexpr double pi = std::numbers::pi;

const BrdfIntegralTask& task() {
  static const BrdfIntegralTask t;
  return t;
}

RunContext smoke() { return {.profile = Profile::smoke, .seed = 1, .threads = 1, .truth_cache = ""}; }

Set seen_from(std::vector<Vec3d> views) {
  Set s;
  s.name = "albedo", s.channels = 3, s.views = std::move(views);
  return s;
}
Vec3d at(double cosine, double turn = 0.7) {
  const double s = std::sqrt((1 - cosine) * (1 + cosine));
  return {s * std::cos(turn), s * std::sin(turn), cosine};
}

TEST(SurfaceTruth, IsTheClosedFormWhereThereIsOne) {
  const auto ggx = surface_truth(datasets::make_surface("ggx_1"), seen_from({{0, 0, 1}}), 1);
  EXPECT_NEAR(ggx.values[0], 1 - std::log(2.0), 1e-9);
  Set cosine = seen_from({at(0.3)});
  cosine.sky.kind = SkyKind::cosine;
  const auto lambert = surface_truth(datasets::make_surface("lambert_0.6"), cosine, 1);
  EXPECT_NEAR(lambert.values[2], double(0.6f) * 2 / 3, 1e-9);
  // A light over a diffuse surface, wholly above it: its cosine times sin² of half its angle.
  Set light = seen_from({at(0.3)});
  light.sky = {SkyKind::cap, at(0.8), std::cos(0.2), 3};
  const auto lit = surface_truth(datasets::make_surface("lambert_0.6"), light, 1);
  EXPECT_NEAR(lit.values[0], double(0.6f) * 3 * 0.8 * std::pow(std::sin(0.2), 2), 1e-9);
}

TEST(SurfaceTruth, BothQuadraturesAgree) {
  for (const char* kind : {"ggx", "separable_ggx", "beckmann", "separable_beckmann"})
    for (const char* alpha : {"0.02", "0.1", "0.5", "1", "0.05_0.4", "1_0.2"}) {
      const Material m = datasets::make_surface(std::string(kind) + "_" + alpha);
      const Truth t = surface_truth(m, seen_from({at(0.05), at(0.5, 2), at(0.95, 4)}), 2);
      EXPECT_LT(t.floor, m.alpha_x < 0.1 ? 5e-6 : 1e-6) << kind << " " << alpha;
      for (const double e : t.values) EXPECT_LE(e, 1 + 1e-6) << kind << " " << alpha;
    }
}

TEST(SurfaceTruth, TailsFall) {
  const auto ggx = tail_shares(datasets::make_surface("ggx_0.1")).values;
  const auto beckmann = tail_shares(datasets::make_surface("beckmann_0.1")).values;
  for (std::size_t k = 1; k < ggx.size(); ++k) {
    EXPECT_LT(ggx[k], ggx[k - 1]);
    EXPECT_LT(beckmann[k], ggx[k]);
  }
  // Facets tilted by half the angle, almost none of whose light is masked: exp(-tan²(10°)/α²).
  EXPECT_NEAR(beckmann[1], std::exp(-std::pow(std::tan(pi / 18) / 0.1, 2)), 2e-3);
}

TEST(BounceWalk, FollowsAllThatFacetsReflect) {
  const auto one = [](double) { return 1.0; };
  EXPECT_DOUBLE_EQ(bounce_walk(0.7, one, 2000, 1, 2).albedo, 1);
  // Facets that reflect next to nothing reflect once.
  for (const double alpha : {0.25, 1.0}) {
    const double little = 1e-4;
    const Walked w = bounce_walk(
        alpha, [&](double) { return little; }, 1 << 15, 1, 2);
    Set average;
    average.channels = 3, average.averages = average.repeats = 1;
    Material m = datasets::make_surface("ggx");
    m.alpha_x = m.alpha_y = alpha;
    EXPECT_NEAR(w.albedo / little, surface_truth(m, average, 2).values[0], 4 * w.standard_error / little);
  }
  const auto half = [](double) { return 0.5; };
  EXPECT_EQ(bounce_walk(0.5, half, 5000, 1, 1).albedo, bounce_walk(0.5, half, 5000, 1, 2).albedo);
}

TEST(ShapeTruth, AgreesWithClosedFormsAndItself) {
  EXPECT_NEAR(solid_angle_truth({ShapeKind::triangle, {1, 0, 0}, {-1, 1, 0}, {-1, 0, 1}}).value, pi / 2,
              1e-9);
  EXPECT_NEAR(solid_angle_truth({ShapeKind::disc, {0, 0, 2}, {1, 0, 0}, {0, 1, 0}}).value,
              2 * pi * (1 - 2 / std::sqrt(5.0)), 1e-9);
  EXPECT_NEAR(solid_angle_truth({ShapeKind::sphere, {0, 0, 2}, {1, 0, 0}, {}}).value,
              2 * pi * (1 - std::sqrt(0.75)), 1e-9);
  EXPECT_NEAR(solid_angle_truth({ShapeKind::box, {0, 0.1, 0}, {1, 1, 1}, {}}).value, 4 * pi, 1e-9);
  EXPECT_NEAR(solid_angle_truth({ShapeKind::box, {0, 0, 2}, {1, 1, 1}, {}}).value, 4 * pi / 6, 1e-9);
  for (const Set& set : make_solid_angle_sets(4, 3))
    for (const Shape& s : set.shapes) EXPECT_LT(solid_angle_truth(s).apart, 1e-9) << set.name;
}

TEST(BrdfIntegralTask, HardCasesOpenAndOthersAreRefused) {
  std::set<std::string> names;
  for (const BlockSpec& spec : task().hard_blocks()) {
    EXPECT_TRUE(names.insert(spec.dataset).second) << spec.dataset;
    EXPECT_EQ(task().open(spec, smoke())->n(), 1u) << spec.dataset;
  }
  EXPECT_THROW(task().open({"no_such_case", 0, true}, smoke()), std::invalid_argument);
  EXPECT_THROW(task().open(datasets::generate("icosphere", 1000, 1), smoke()), std::invalid_argument);
}

/// Right on average, but for one fault.
enum class Fault { none, biased, narrow, no_number, negative };

template <Fault fault>
class Faulty final : public Answerer {
 public:
  explicit Faulty(const Input& input) : albedo_(input.material.reflectance[0]) {}
  void answer(const Set& set, const Knobs&, int, std::span<float> out) override {
    geometry::Pcg32 random(5);
    for (std::size_t i = 0; i < out.size(); ++i)
      out[i] = albedo_ + random.uniform(-0.01f, 0.01f) + (fault == Fault::biased ? 0.005f : 0.0f);
    if (fault == Fault::narrow)  // one viewer in four
      for (std::size_t i = 0; i < set.repeats * 3; ++i) out[i] *= 1.02f;
    if (fault == Fault::no_number) out[7] = NAN;
    if (fault == Fault::negative) out[7] = -0.1f;
  }
  std::vector<Moments> moments(const Set& set, const Knobs&) override {
    std::vector<Moments> all(set.queries() / set.repeats);
    for (Moments& m : all)
      for (int i = 0; i < 1000; ++i) m.add(0.5);
    return all;
  }

 private:
  float albedo_;
};

template <Fault fault>
bool within_claim() {
  std::vector<Method> methods(1);
  methods[0].info.name = "faulty", methods[0].info.claim = Claim::stochastic;
  methods[0].build = [](const Input& input, const Knobs&) -> std::unique_ptr<Answerer> {
    return std::make_unique<Faulty<fault>>(input);
  };
  BlockInput input;
  input.dataset = datasets::generate("lambert_0.5", 1, 1);
  input.sets = {make_integral_sets({4, 32, 8}, 1)[0]};
  const auto block = open_block(methods, std::move(input));
  const Knobs knobs{{"samples", 1024}};
  const auto subject = block->build(0, Knobs::object(), 1);
  subject->run(0, knobs, 1);
  return block->check(0, *subject, 0, knobs).within_claim;
}

TEST(BrdfIntegralTask, FaultsAreFound) {
  EXPECT_TRUE(within_claim<Fault::none>());
  EXPECT_FALSE(within_claim<Fault::biased>());
  EXPECT_FALSE(within_claim<Fault::narrow>());
  EXPECT_FALSE(within_claim<Fault::no_number>());
  EXPECT_FALSE(within_claim<Fault::negative>());
}

TEST(BrdfIntegralTask, AnotherSeedDrawsOtherSamples) {
  const auto answers = [](const Method& method, std::uint64_t seed) {
    const Material m = datasets::make_surface("ggx_0.3");
    const Set set = make_hard_integral_sets(std::vector{0.5}, 1)[1];
    std::vector<float> out(3 * set.queries());
    const Input input{m, 1, seed};
    method.build(input, Knobs::object())->answer(set, method.info.query_knobs.front(), 1, out);
    return out;
  };
  std::size_t tried = 0;
  for (const Method& method : task().registered()) {
    if (method.info.claim != Claim::stochastic) continue;
    ++tried;
    EXPECT_EQ(answers(method, 1), answers(method, 1)) << method.info.name;
    EXPECT_NE(answers(method, 1), answers(method, 2)) << method.info.name;
  }
  EXPECT_GE(tried, 8u);
}

TEST(BrdfIntegralProgram, SmokeProfileEndsWellAndTheLadderClimbs) {
  const auto folder = std::filesystem::temp_directory_path() / "treeline_brdf_integral_program";
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  const std::string rows = (folder / "rows").string();
  const std::string command =
      std::string(BRDF_INTEGRAL_TEST_PROGRAM) + " --profile smoke --rows " + rows + " >/dev/null 2>&1";
  EXPECT_EQ(std::system(command.c_str()), 0);
  std::ifstream in(rows);
  std::map<std::string, double> errors;
  for (std::string line; std::getline(in, line);) {
    const auto row = nlohmann::json::parse(line);
    EXPECT_TRUE(row["status"] == "ok" || row["status"] == "unsupported" || row["status"] == "not_built")
        << line;
    if (row["error"].is_null()) continue;
    std::string name = row["dataset"].get<std::string>() + " " + row["query_set"].get<std::string>() + " " +
                       row["method"].get<std::string>();
    for (const char* knobs : {"build_knobs", "query_knobs"})
      for (const auto& [key, value] : row[knobs].items())
        name += " " + (value.is_string() ? value.get<std::string>() : value.dump());
    errors[name] = row["error"].get<double>();
  }
  const auto error = [&](const std::string& name) { return errors.at(name); };
  EXPECT_GT(error("ggx_0.3 albedo uniform random 1024"), error("ggx_0.3 albedo facets random 1024"));
  EXPECT_GT(error("ggx_0.3 albedo facets random 1024"), error("ggx_0.3 albedo own random 1024"));
  EXPECT_GT(error("ggx_0.3 albedo own random 1024"), error("ggx_0.3 albedo own sobol_owen 1024"));
  EXPECT_GT(error("ggx_0.3 albedo own sobol_owen 16"), error("ggx_0.3 albedo own sobol_owen 128"));
  EXPECT_GT(error("ggx_0.3 small_light own random 1024"), error("ggx_0.3 small_light mis random 1024"));
  EXPECT_GT(error("ggx_0.3 albedo table 8"), error("ggx_0.3 albedo table 64"));
  EXPECT_GT(error("ggx_0.3 albedo quadrature 8"), error("ggx_0.3 albedo quadrature_facets 8"));
  EXPECT_GT(error("ggx_0.3 albedo unmasked 16"), error("ggx_0.3 albedo quadrature_facets 16"));
  EXPECT_LT(error("ggx_0.3 albedo quadrature_facets 32"), 1e-5);
  EXPECT_GT(error("fresnel index_1.5 schlick"), 1e3 * error("fresnel index_1.5 fresnel"));
  EXPECT_GT(error("furnace white_0.5 compensated none"),
            10 * error("furnace white_0.5 compensated kulla_conty"));
  EXPECT_GT(error("furnace colour_0.5_0.5 compensated textbook"),
            4 * error("furnace colour_0.5_0.5 compensated kulla_conty"));
  EXPECT_GT(error("solid_angles disc_1 area_over_r2"), error("solid_angles disc_10 area_over_r2"));
  EXPECT_LT(error("solid_angles disc_1 solid_angle"), 1e-6);
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace treeline::bench::brdf_integral
