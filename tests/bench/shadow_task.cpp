// The task shadow: what its judge says of methods whose faults are known, every method through its cells, and
// the figures that theory gives.
#include "bench/shadow/task.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "bench/shadow/closed_form.hpp"
#include "bench/shadow/judge.hpp"
#include "datasets_gen/scenes/scene.hpp"

namespace treeline::bench::shadow {
namespace {

using Json = nlohmann::json;

const ShadowTask& task() {
  static const ShadowTask t;
  return t;
}
RunContext smoke() { return {.profile = Profile::smoke, .seed = 1, .threads = 1, .truth_cache = ""}; }

// ---- the judge
// ---------------------------------------------------------------------------------------------

TEST(ShadowJudge, KnownErrors) {
  const std::vector<double> truth{0, 0, 0.5, 1};
  const std::vector<float> all_lit{1, 1, 1, 1};
  const Errors e = judged(all_lit, truth, 0.01);
  EXPECT_NEAR(*e.error, std::sqrt(2.25 / 4), 1e-12);
  EXPECT_NEAR(*e.mean, 2.5 / 4, 1e-12);
  EXPECT_NEAR(*e.bias, 2.5 / 4, 1e-12);
  EXPECT_EQ(*e.floor, 0.01);
  EXPECT_EQ(e.extra["shadow_false_lit"], 0.75);
  EXPECT_EQ(e.extra["shadow_false_dark"], 0);
  EXPECT_EQ(e.extra["shadow_max"], 1);
  EXPECT_EQ(e.extra["shadow_penumbra"], 0.5);  // of the one receiver between
  EXPECT_EQ(e.extra["shadow_penumbra_share"], 0.25);
  EXPECT_TRUE(e.within_claim);
  EXPECT_FALSE(e.max || e.p99);  // no limits of the advice
}

TEST(ShadowJudge, WhatIsNoShareIsWrong) {
  const std::vector<double> truth{0, 1};
  for (const float bad : {std::nanf(""), -0.01f, 1.01f, INFINITY}) {
    const std::vector<float> answers{bad, 1};
    const Errors e = judged(answers, truth, 0);
    EXPECT_FALSE(e.within_claim) << bad;
    EXPECT_NE(e.reason.find("receiver 0"), std::string::npos);
    EXPECT_NEAR(*e.error, std::sqrt(0.5), 1e-12);  // as bad as can be
  }
  EXPECT_TRUE(judged(std::vector<float>{-1e-6f, 1 + 1e-6f}, truth, 0).within_claim);
}

TEST(ShadowJudge, CrossingsAreBetweenReceivers) {
  const std::vector<float> a{0, 0, 0.2f, 0.6f, 1};
  EXPECT_NEAR(*crossing(a, 0.1), 1.5 / 4, 1e-6);
  EXPECT_NEAR(*crossing(a, 0.9), 3.75 / 4, 1e-6);
  EXPECT_EQ(crossing(std::vector<float>{0, 0.5f}, 0.9), std::nullopt);
  EXPECT_EQ(*crossing(std::vector<float>{1, 1}, 0.5), 0);
}

// ---- blocks and faulty methods
// -----------------------------------------------------------------------------

enum class Fault { none, lit, one_wrong, near_border, late };
const shading::Scene* first_scene = nullptr;  // the light that a late method goes on seeing

double true_share(const shading::Light& light, const Receiver& r) {
  static const auto known = datasets::known_shadows("half_plane_edge");
  return visible_past(known.blockers, light, r.position);
}

template <Fault fault>
class Faulty final : public ShadowSubject {
 public:
  explicit Faulty(const Input& input)
      : light_(fault == Fault::late ? first_scene->light : input.scene.light) {}

  void visibility(std::span<const Receiver> receivers, const Knobs&, int, std::span<float> out) override {
    for (std::size_t i = 0; i < receivers.size(); ++i) {
      Receiver r = receivers[i];
      if (fault == Fault::near_border) r.position[0] += 2e-5;  // of a diagonal of some 11
      out[i] = fault == Fault::lit ? 1 : static_cast<float>(true_share(light_, r));
    }
    if (fault == Fault::one_wrong) out[out.size() / 3] = 1 - out[out.size() / 3];
  }

 private:
  shading::Light light_;
};

template <Fault fault>
std::vector<Method> faulty(Claim claim) {
  std::vector<Method> methods(1);
  methods[0].info.name = "faulty", methods[0].info.claim = claim;
  methods[0].build = [](const Input& input, const Knobs&) -> std::unique_ptr<ShadowSubject> {
    return std::make_unique<Faulty<fault>>(input);
  };
  return methods;
}

/// Half a plane under a rectangle or, if hard, under a point.
BlockInput half_plane(bool hard) {
  BlockInput input;
  input.scene = datasets::make_scene("half_plane_edge", 200, 1);
  input.scene.camera.width = 48, input.scene.camera.height = 36;
  if (hard) input.scene.light.kind = LightKind::point;
  input.closed_form = true_share;
  input.lines = datasets::known_shadows("half_plane_edge").lines;
  input.frames = 4;
  return input;
}

template <Fault fault>
std::map<std::string, Errors> errors_of(bool hard, Claim claim) {
  const auto methods = faulty<fault>(claim);
  ShadowBlock block(methods, half_plane(hard));
  first_scene = &block.scene();
  const auto subject = block.build(0, Knobs::object(), 1);
  std::map<std::string, Errors> out;
  for (std::size_t q = 0; q < block.query_sets().size(); ++q) {
    subject->prepare(q, 1);
    subject->run(q, Knobs::object(), 1);
    out[block.query_sets()[q].name] = block.check(0, *subject, q, Knobs::object());
  }
  return out;
}

TEST(ShadowBlock, TheTruthItselfHasNoError) {
  for (const bool hard : {false, true}) {
    const auto errors = errors_of<Fault::none>(hard, Claim::bounded);
    ASSERT_EQ(errors.size(), 3u);
    for (const auto& [set, e] : errors) {
      EXPECT_LT(*e.error, 1e-7) << set;
      EXPECT_TRUE(e.within_claim) << set << e.reason;
    }
    if (hard) continue;
    // w = width height / (4 - height), of which 80 % lie between.
    EXPECT_NEAR(errors.at("edge").extra["shadow_width_true"].get<double>(), 0.8 * 0.5 / 3, 0.02);
    EXPECT_NEAR(errors.at("edge").extra["shadow_width_error"].get<double>(), 0, 1e-4);
  }
}

TEST(ShadowBlock, NoShadowAtAllIsAsFarOffAsTheShadowIs) {
  const auto errors = errors_of<Fault::lit>(false, Claim::approximate);
  const Errors& e = errors.at("image");
  EXPECT_TRUE(e.within_claim);
  EXPECT_GT(*e.error, 0.3);
  EXPECT_NEAR(*e.bias, *e.mean, 1e-12);
  EXPECT_EQ(e.extra["shadow_false_dark"], 0);
  EXPECT_EQ(errors.at("edge").extra["shadow_width"], 0);
}

TEST(ShadowBlock, AWrongHardShadowIsWrongOnlyAwayFromItsBorder) {
  EXPECT_FALSE(errors_of<Fault::one_wrong>(true, Claim::bounded).at("image").within_claim);
  EXPECT_FALSE(errors_of<Fault::one_wrong>(true, Claim::exact).at("edge").within_claim);
  EXPECT_TRUE(errors_of<Fault::one_wrong>(true, Claim::approximate).at("image").within_claim);
  for (const auto& [set, e] : errors_of<Fault::near_border>(true, Claim::bounded))
    EXPECT_TRUE(e.within_claim) << set << ": " << e.reason;
}

TEST(ShadowBlock, AShadowThatStaysWhileTheLightMovesCrawls) {
  EXPECT_GT(*errors_of<Fault::late>(false, Claim::approximate).at("motion").error, 1e-5);
  EXPECT_LT(*errors_of<Fault::none>(false, Claim::approximate).at("motion").error, 1e-7);
}

TEST(ShadowBlock, AFrameMovesTheLightByATenthOfATexel) {
  shading::Scene scene = datasets::make_scene("half_plane_edge", 200, 1);
  const auto box = scene.mesh.box();
  const auto view = shading::shadow::fit_view(scene.light, {Vec3d(box.low), Vec3d(box.high)});
  const double texel = view.texel_width(1024, 0.5 * (view.near + view.far));
  EXPECT_NEAR(distance(moved(scene, 1).position, scene.light.position), 0.1 * texel, 1e-9);
  scene.light.kind = LightKind::directional;
  const double turn = distance(moved(scene, 1).direction, scene.light.direction);
  EXPECT_GT(turn, 0);
  EXPECT_LT(turn, 1e-3);
}

// ---- the task
// ----------------------------------------------------------------------------------------------

TEST(ShadowTask, HardCasesOpenAndTheirClosedFormsAgreeWithRays) {
  for (const datasets::HardShadow& c : datasets::hard_shadows()) {
    SCOPED_TRACE(c.name);
    EXPECT_FALSE(c.source.empty() || c.law.empty());
    const auto block = task().open({c.name, 0, true}, smoke());
    auto& mine = dynamic_cast<ShadowBlock&>(*block);
    EXPECT_GT(mine.image().list.size(), 100u);
    if (!mine.truth(0).closed_form) continue;
    const Tree tree(c.scene.mesh);
    TruthOptions options;
    options.most = 128;
    const Receivers& seen = mine.image();
    const Truth traced = traced_truth(c.scene, tree, seen.list, seen.pixel, seen.width, options, 1);
    double sum = 0;
    for (std::size_t i = 0; i < seen.list.size(); ++i) {
      const double off = traced.visibility[i] - mine.truth(0).visibility[i];
      sum += off * off;
    }
    EXPECT_LT(std::sqrt(sum / double(seen.list.size())), 1.5 * traced.halves + 1e-6);
  }
  EXPECT_THROW(task().open({"no_such_case", 0, true}, smoke()), std::invalid_argument);
}

TEST(ShadowTask, LinesLieWhereTheySay) {
  for (const datasets::HardShadow& c : datasets::hard_shadows()) {
    if (c.known.lines.empty()) continue;
    SCOPED_TRACE(c.name);
    const auto block = task().open({c.name, 0, true}, smoke());
    auto& mine = dynamic_cast<ShadowBlock&>(*block);
    for (std::size_t q = 1; q < mine.query_sets().size(); ++q) {
      const std::string& set = mine.query_sets()[q].name;
      const auto& v = mine.truth(q).visibility;
      if (set == "edge") {
        EXPECT_LT(v.front(), 0.01);
        EXPECT_GT(v.back(), 0.99);
        EXPECT_TRUE(std::ranges::is_sorted(v));
      } else if (set == "top") {
        EXPECT_EQ(*std::ranges::min_element(v), 1);
      } else if (set != "motion") {
        EXPECT_EQ(*std::ranges::max_element(v), 0) << set;  // contact and leak: all in full shadow
      }
    }
  }
}

/// Rows of the program; each must be JSON.
std::vector<Json> rows_of(const std::string& arguments, int expected = 0) {
  const auto folder = std::filesystem::temp_directory_path() / "treeline_shadow_program";
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  const std::string rows = (folder / "rows").string();
  const std::string command =
      std::string(SHADOW_TEST_PROGRAM) + " " + arguments + " --cache '' --rows " + rows + " >/dev/null 2>&1";
  // An empty --cache is no cache.
  const int status = std::system(command.c_str());
  EXPECT_EQ(WEXITSTATUS(status), expected) << arguments;
  std::vector<Json> out;
  std::ifstream in(rows);
  for (std::string line; std::getline(in, line);) out.push_back(Json::parse(line));
  std::filesystem::remove_all(folder);
  return out;
}
int status_of(const std::string& arguments) {
  return WEXITSTATUS(
      std::system((std::string(SHADOW_TEST_PROGRAM) + " " + arguments + " >/dev/null 2>&1").c_str()));
}

TEST(ShadowProgram, SmokeProfileEndsWell) {
  const auto rows = rows_of("--profile smoke");
  std::set<std::string> methods, sets;
  std::map<std::string, double> maps;  // drawn by rays, by method and packet: the error over the image
  for (const Json& row : rows) {
    methods.insert(row["method"]), sets.insert(row["query_set"]);
    if (row["status"] == "ok" && row["query_set"] == "image" &&
        row["method"].get<std::string>().ends_with("redrawn_map"))
      maps[row["method"].get<std::string>() + row["build_knobs"].dump()] = row["error"];
    if (row["status"] == "ok" && row["query_set"] == "image") {
      for (const char* field : {"", "_ggx_0.5", "_ggx_0.2", "_ggx_0.1", "_ggx_0.05"})
        EXPECT_GT(row.value("shadow_split" + std::string(field), 0.0), 0) << field;
    }
    EXPECT_TRUE(row["status"] == "ok" || row["status"] == "unsupported" || row["status"] == "not_built")
        << row;
  }
  const auto everywhere =
      std::ranges::count_if(task().methods(), [](const MethodInfo& m) { return !m.hard_cases_only; });
  EXPECT_EQ(methods.size(), static_cast<std::size_t>(everywhere) + task().not_built().size());
  EXPECT_EQ(sets, (std::set<std::string>{"image", "edge", "motion"}));
  // However maps are drawn, a few texels at edges apart: each pixel of 1728 that sees one adds less than .01.
  const double drawn = maps.at(R"(redrawn_map{"drawn":"raster"})");
  for (const auto& [how, error] : maps) EXPECT_NEAR(error, drawn, 0.01) << how;
  const auto of_embree = [](const auto& map) { return map.first.starts_with("embree"); };
  const auto absent = [](const auto& peer) { return peer.first == "embree_redrawn_map"; };
  if (__builtin_cpu_supports("avx2")) {
    EXPECT_NE(std::ranges::any_of(maps, of_embree), std::ranges::any_of(task().not_built(), absent));
  }
}

TEST(ShadowProgram, FiguresOfTheory) {
  std::map<std::string, std::size_t> found;  // rows by field
  auto rows = rows_of(
      "--stress --dataset shadow_tilted_plane_60_0 --dataset shadow_tilted_plane_85_0 "
      "--dataset shadow_tilted_plane_60_45 --dataset shadow_wall_on_floor_0.01 "
      "--dataset shadow_slab_and_sheet_0.0001 "
      "--dataset shadow_two_stacked_1 --dataset shadow_two_stacked_0.5 --dataset shadow_two_stacked_0.1 "
      "--dataset shadow_three_layers_1 --dataset shadow_three_layers_0.25 --dataset shadow_three_layers_0.1 "
      "--dataset shadow_eye_inside_volume_0 --dataset shadow_eye_inside_volume_1.45 "
      "--benchmark_filter='(top/(midpoint|dual_depth|second_depth)|/"
      "(shadow_map|vsm|msm|shadow_volumes_z_pass))/'");
  for (Json& row :
       rows_of("--profile quick --dataset half_plane_edge:200 --dataset tilted_plane_85_0:200 "
               "--dataset slab_and_sheet_0.002:200 --benchmark_filter='/(edge/(pcf|pcf_disc|pcss)|"
               "image/shadow_map|top/(midpoint|dual_depth|second_depth))/'"))
    rows.push_back(std::move(row));
  std::map<std::string, std::size_t> told;     // whose slack would not let pass that there were none
  std::map<std::string, std::size_t> partial;  // false shadow of a share that is neither none nor half
  for (const Json& row : rows) {
    if (!row.contains("shadow_figure")) continue;
    const std::string field = row["shadow_figure"];
    if (row[field].is_null()) continue;  // a penumbra wider than the line
    ++found[field];
    const double is = row[field].get<double>(), should = row["shadow_figure_value"].get<double>();
    const double may = row["shadow_figure_slack"];
    EXPECT_NEAR(is, should, may) << row;
    told[field] += should > 2 * may;
    if (field != "shadow_false_dark") continue;
    EXPECT_LT(may, 0.01) << row;
    if (should > may && should < 0.5 - may) ++partial[row["method"]];
  }
  EXPECT_GE(found["shadow_false_dark"], 9u);
  for (const char* method : {"shadow_map", "midpoint", "dual_depth", "second_depth"})
    EXPECT_GE(partial[method], 1u) << method;
  EXPECT_GE(found["shadow_gap"], 3u);
  EXPECT_GE(told["shadow_gap"], 1u);
  EXPECT_GE(found["shadow_max"], 12u);
  EXPECT_GE(told["shadow_max"], 8u);
  EXPECT_GE(found["shadow_width"], 8u);
  EXPECT_EQ(told["shadow_width"], found["shadow_width"]);
  EXPECT_GE(found["shadow_levels"], 4u);
  EXPECT_GE(found["shadow_wrong"], 2u);
}

TEST(ShadowProgram, LightsThatAreNoneAreRefused) {
  RunContext context = smoke();
  for (const char* light :
       {"sun", "", "directional", "directional:0,0,0", "directional:0,-1", "directional:0,-1,nan",
        "point:1,2", "disc:0,5,0:0,-1,0:-1", "spot:0,5,0:0,-1,0:400", "point:1,2,3:4"}) {
    context.own["--light"] = light;
    EXPECT_THROW(task().check_flags(context), std::invalid_argument) << light;
  }
  EXPECT_EQ(status_of("--profile smoke --light sun"), 2);
  EXPECT_EQ(status_of("--stress --light point:0,5,0"), 2);  // hard cases have lights of their own
  // A light that no map can hold is the scene's refusal, by name.
  EXPECT_EQ(status_of("--profile smoke --light point:0,-50,0"), 2);  // nothing that the camera sees is lit
  // So far away that doubles lose the scene, or too small for them: once, and not by each method.
  for (const char* light : {"point:0,1e20,0", "spot:0,1e12,0:0,-1,0:1", "rectangle:0,1e200,0:0,-1,0:1,1",
                            "disc:0,5,0:0,-1,0:1e-170", "rectangle:0,5,0:0,-1,0:1e-200,1e-200"}) {
    context.own["--light"] = light;
    EXPECT_THROW(task().open(BlockSpec{"half_plane_edge", 100}, context), shading::InvalidScene) << light;
  }
  EXPECT_EQ(status_of("--profile smoke --light point:0,1e20,0"), 2);
  EXPECT_EQ(status_of("--profile smoke --light point:0,1e8,0 --benchmark_filter=/shadow_map/"), 0);
}

TEST(ShadowProgram, RowsOfALightAreOfADatasetOfItsOwn) {
  std::set<std::string> datasets, blocks;
  for (const char* light : {"", " --light directional:0.2,-1,0.1:1", " --light directional:0.2,-1,0.1:2"})
    for (const Json& row : rows_of("--profile smoke --benchmark_filter=/unshadowed/" + std::string(light)))
      datasets.insert(row["dataset"]), blocks.insert(row["block"]);
  EXPECT_EQ(datasets,
            (std::set<std::string>{"half_plane_edge", "half_plane_edge --light directional:0.2,-1,0.1:1",
                                   "half_plane_edge --light directional:0.2,-1,0.1:2"}));
  EXPECT_EQ(blocks.size(), 3u);
  EXPECT_TRUE(blocks.contains("half_plane_edge --light directional:0.2,-1,0.1:1:100"));  // its size last
}

TEST(ShadowProgram, ScenesTakeKnobs) {
  const std::string one = " --benchmark_filter=/unshadowed/";
  EXPECT_EQ(status_of("--profile smoke --dataset two_stacked_0.1:200" + one), 0);
  EXPECT_EQ(status_of("--profile smoke --dataset two_stacked_99" + one), 2);
  for (const char* bad : {"two_stacked_99", "two_stacked_0.1_5", "two_stacked_x", "icosphere", "two_stack"})
    EXPECT_THROW(task().open({bad, 1000}, smoke()), std::invalid_argument) << bad;
}

TEST(ShadowProgram, InputIsAMeshOfAnyKind) {
  const auto folder = std::filesystem::temp_directory_path() / "treeline_shadow_input";
  std::filesystem::create_directories(folder);
  const auto write = [&](const char* name, const std::string& text) {
    std::ofstream(folder / name) << text;
    return (folder / name).string();
  };
  const std::string tent = write("half_plane_edge.obj",
                                 "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 3 4\nf 1 4 2\nf 2 4 3\n");
  const auto rows =
      rows_of("--profile smoke --input " + tent + " --benchmark_filter='/(unshadowed|centre_ray)/'");
  EXPECT_EQ(rows.size(), 2u);  // a file's name says nothing of what is known of its shadows
  EXPECT_EQ(status_of("--profile smoke --input " + write("empty.obj", "v 0 0 0\n")), 2);
  EXPECT_EQ(
      status_of("--profile smoke --input " + write("none.obj", "v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")), 2);
  EXPECT_EQ(status_of("--profile smoke --input " + write("cloud.xyz", "0 0 0\n1 1 1\n")), 2);
  EXPECT_EQ(status_of("--profile smoke --input /nowhere.ply"), 2);
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace treeline::bench::shadow
