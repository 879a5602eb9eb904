// The task region_average: its truth beside samples and closed forms, every method through its cells, and
// answers that its judge must not let pass.
#include "bench/region_average/task.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <set>

#include "bench/region_average/block.hpp"
#include "bench/region_average/truth.hpp"
#include "datasets_gen/hard/hard_textures.hpp"
#include "geometry/random.hpp"

namespace treeline::bench::region_average {
namespace {

namespace texture = shading::texture;

const RegionAverageTask& task() {
  static const RegionAverageTask t;
  return t;
}

RunContext smoke() { return {.profile = Profile::smoke, .seed = 1, .threads = 1, .truth_cache = ""}; }

TEST(RegionAverageTruth, AgreesWithSamplesInTheFootprintsOwnAxes) {
  const Image image = datasets::generate("marble", 4096, 1).image;
  geometry::Pcg32 random(3);
  std::vector<Footprint> asked;
  for (int k = 0; k < 40; ++k) {
    const double x = random.uniform(-5.0, 69.0), y = random.uniform(-5.0, 69.0), a = random.uniform(0.5, 8.0);
    asked.push_back(texture::box_footprint({x - a, y - 2, x + a, y + 2}));
    asked.push_back(texture::rotated_box(x, y, a, 2, random.uniform(0.0, 7.0)));
    asked.push_back(texture::disc_footprint(x, y, a));
    asked.push_back(texture::gaussian_footprint(x, y, 0.4 * a, 1));
  }
  const auto truth = true_means(image, asked, 2);
  for (std::size_t i = 0; i < asked.size(); ++i) {
    const Footprint& f = asked[i];
    const int n = 300;
    const double reach = f.shape == texture::Shape::gaussian ? texture::gaussian_reach : 1;
    double sums[4] = {}, weights = 0;
    for (int k = 0; k < n * n; ++k) {
      const double a = reach * ((2 * (k % n) + 1.0) / n - 1), b = reach * ((2 * (k / n) + 1.0) / n - 1);
      if (f.shape == texture::Shape::disc && a * a + b * b > 1) continue;
      const double w = f.shape == texture::Shape::gaussian ? std::exp(-0.5 * (a * a + b * b)) : 1;
      const double u = f.x + a * f.ux + b * f.vx, v = f.y + a * f.uy + b * f.vy;
      const int px = std::clamp(int(std::floor(u)), 0, 63), py = std::clamp(int(std::floor(v)), 0, 63);
      for (int c = 0; c < 4; ++c) sums[c] += w * double(image(px, py, c));
      weights += w;
    }
    for (std::size_t c = 0; c < 4; ++c)
      EXPECT_NEAR(truth[4 * i + c], sums[c] / weights, 2e-3) << i << " " << c;
  }
}

TEST(RegionAverageTruth, IsTheClosedFormOnAStep) {
  // Black left of column 50, white from there on: the mean is the share of the footprint to the right.
  Image step(100, 100, 1);
  for (int y = 0; y < 100; ++y)
    for (int x = 50; x < 100; ++x) step(x, y) = 1;
  const double pi = std::numbers::pi;
  for (const double x : {45.25, 49.0, 50.0, 52.7}) {
    const double right = x - 50;  // of the edge, how far the centre is
    const std::vector<Footprint> asked{
        texture::box_footprint({x - 8, 20, x + 8, 30.5}), texture::disc_footprint(x, 40.3, 8),
        texture::gaussian_footprint(x, 40, 4, 3), texture::rotated_box(x, 50, 8, 8, pi / 4)};
    const auto found = true_means(step, asked, 1);
    EXPECT_NEAR(found[0], 0.5 + right / 16, 1e-12);
    const double t = right / 8;
    EXPECT_NEAR(found[1], 0.5 + (t * std::sqrt(1 - t * t) + std::asin(t)) / pi, 1e-12);
    EXPECT_NEAR(found[2], 0.5 + 0.5 * std::erf(right / (4 * std::sqrt(2.0))) / std::erf(3 / std::sqrt(2.0)),
                1e-12);
    const double h = 8 * std::sqrt(2.0), left = (h - std::abs(right)) / h;  // a square on its corner
    EXPECT_NEAR(found[3], right < 0 ? 0.5 * left * left : 1 - 0.5 * left * left, 1e-12);
  }
}

TEST(RegionAverageTruth, OutsideTheBorderTexelsGoOn) {
  Image image(3, 1, 1);
  image.values = {0.25f, 0.5f, 1.0f};
  const std::vector<Footprint> asked{
      texture::box_footprint({-10, -5, -2, 7}), texture::box_footprint({5, 0, 9, 1}),
      texture::box_footprint({-1, 0, 4, 1}), texture::box_footprint({1.5, 0.5, 1.5, 0.5})};
  const auto found = true_means(image, asked, 1);
  EXPECT_NEAR(found[0], 0.25, 1e-12);
  EXPECT_NEAR(found[1], 1, 1e-12);
  EXPECT_NEAR(found[2], (2 * 0.25 + 0.5 + 2 * 1) / 5, 1e-12);
  EXPECT_NEAR(found[3], 0.5, 1e-12);  // a point
}

TEST(RegionAverageTask, EveryMethodIsBuiltOrNamedAsNotBuilt) {
  std::multiset<std::string> names;
  for (const MethodInfo& m : task().methods()) names.insert(m.name);
  for (const auto& [name, package] : task().not_built()) names.insert(name);
  EXPECT_EQ(names, (std::multiset<std::string>{"brute", "mip_anisotropic", "mip_probes", "mip_square",
                                               "nearest", "opencv_integral", "openimageio", "sat_centred",
                                               "sat_double", "sat_float", "sat_int64", "sat_uint32"}));
}

TEST(RegionAverageTask, HardCasesOpen) {
  std::set<std::string> names;
  for (const BlockSpec& spec : task().hard_blocks()) {
    EXPECT_TRUE(names.insert(spec.dataset).second) << spec.dataset;
    if (spec.dataset.starts_with("texture_1x") || spec.dataset == "texture_nan") {
      EXPECT_GT(task().open(spec, smoke())->n(), 0u) << spec.dataset;
    }
  }
  EXPECT_THROW(task().open({"no_such_case", 0, true}, smoke()), std::invalid_argument);
  EXPECT_THROW(task().open(datasets::generate("uniform_cube", 1000, 1), smoke()), std::invalid_argument);
}

TEST(RegionAverageTask, SortedSetsAreTheSameFootprints) {
  const auto sets = make_sets(200, 150, 500, 1);
  std::map<std::string, std::multiset<std::pair<double, double>>> found;
  for (const FootprintSet& s : sets)
    for (const Footprint& f : s.footprints) {
      found[s.name].insert({f.x, f.y});
      const texture::Box b = texture::bounding_box(f);
      EXPECT_GE(b.x0, -1e-9) << s.name;
      EXPECT_LE(b.x1, 200 + 1e-9) << s.name;
      EXPECT_GE(b.y0, -1e-9) << s.name;
      EXPECT_LE(b.y1, 150 + 1e-9) << s.name;
    }
  for (const char* name : {"square24", "oblong", "rotated", "disc", "gaussian"})
    EXPECT_EQ(found[name], found[name + std::string("_sorted")]);
}

/// Right, but for one fault.
enum class Fault { none, an_ulp, two_ulps_of_a_half, no_number, one_channel, stale };
const Image* faulty_image = nullptr;

template <Fault fault>
class Faulty final : public Averager {
 public:
  void means(std::span<const Footprint> asked, const Knobs&, int, std::span<float> out) const override {
    const auto truth = true_means(*faulty_image, asked, 1);
    for (std::size_t i = 0; i < out.size(); ++i) {
      out[i] = static_cast<float>(truth[i]);
      if (fault == Fault::an_ulp)  // the float on the other side
        out[i] = std::nextafter(out[i], double(out[i]) > truth[i] ? 0.0f : 2.0f);
      if (fault == Fault::two_ulps_of_a_half) out[i] += 3e-7f;
      if (fault == Fault::no_number) out[i] = NAN;
      if (fault == Fault::one_channel && i % 4 == 2) out[i] += 0.1f;
      if (fault == Fault::stale && rebuilt_) out[i] = 0;
    }
  }
  void rebuild(const Image&, int) override { rebuilt_ = true; }

 private:
  bool rebuilt_ = false;
};

/// The sets in which the judge finds the answers wrong.
template <Fault fault>
std::set<std::string> sets_found_wrong(bool boxes_only) {
  static const datasets::Dataset marble = datasets::generate("marble", 4096, 1);
  faulty_image = &marble.image;
  std::vector<Method> methods(1);
  methods[0].info.name = "faulty", methods[0].info.claim = Claim::exact;
  methods[0].boxes_only = boxes_only;
  methods[0].build = [](const Input&, const Knobs&) -> std::unique_ptr<Averager> {
    return std::make_unique<Faulty<fault>>();
  };
  BlockInput input;
  input.dataset = marble;
  input.sets = make_sets(marble.image.width, marble.image.height, 50, 1);
  std::erase_if(input.sets, [](const FootprintSet& s) { return s.name.ends_with("_sorted"); });
  const auto block = open_block(methods, std::move(input));
  const auto subject = block->build(0, Knobs::object(), 1);
  std::set<std::string> wrong;
  for (std::size_t q = 0; q < block->query_sets().size(); ++q) {
    subject->run(q, Knobs::object(), 1);
    if (!block->check(0, *subject, q, Knobs::object()).within_claim)
      wrong.insert(block->query_sets()[q].name);
  }
  return wrong;
}

TEST(RegionAverageTask, FaultsAreFound) {
  const std::set<std::string> none,
      all{"aligned16", "build", "disc", "gaussian", "oblong", "rotated", "square24", "square4", "texel"};
  const std::set<std::string> boxes{"aligned16", "build", "oblong", "square24", "square4", "texel"};
  EXPECT_EQ(sets_found_wrong<Fault::none>(false), none);
  EXPECT_EQ(sets_found_wrong<Fault::an_ulp>(false), none);
  EXPECT_EQ(sets_found_wrong<Fault::two_ulps_of_a_half>(false), all);
  EXPECT_EQ(sets_found_wrong<Fault::two_ulps_of_a_half>(true), boxes);
  EXPECT_EQ(sets_found_wrong<Fault::one_channel>(true), boxes);
  EXPECT_EQ(sets_found_wrong<Fault::no_number>(true), all);  // that is no mean of anything
  EXPECT_EQ(sets_found_wrong<Fault::stale>(false), (std::set<std::string>{"build"}));
}

/// What the program exits with, and its rows.
std::pair<int, std::vector<nlohmann::json>> run_program(const std::string& arguments) {
  const auto rows = std::filesystem::temp_directory_path() / "treeline_region_average_rows";
  std::filesystem::remove(rows);
  const std::string command = std::string(REGION_AVERAGE_TEST_PROGRAM) + " " + arguments + " --rows " +
                              rows.string() + " >/dev/null 2>&1";
  const int status = std::system(command.c_str());
  std::vector<nlohmann::json> out;
  std::ifstream in(rows);
  for (std::string line; std::getline(in, line);) out.push_back(nlohmann::json::parse(line));
  std::filesystem::remove(rows);
  return {status, out};
}

TEST(RegionAverageProgram, FloatSumsLoseWhatTheoryTells) {
  const std::string filter = " --benchmark_filter='/(texel|aligned16)/sat_float'";
  std::map<std::pair<std::string, std::size_t>, double> errors;  // by set and texels
  for (const char* arguments :
       {"--stress --dataset texture_cancellation", "--profile quick --dataset noise:1048576"})
    for (const auto& row : run_program(arguments + filter).second) {
      const double is = row["error"], should = row["region_average_figure_value"],
                   slack = row["region_average_figure_slack"];
      EXPECT_EQ(row["region_average_figure"], "error");
      EXPECT_NEAR(is, should, slack) << row;
      EXPECT_LT(slack, 0.15 * should);
      errors[{row["query_set"], row["n"]}] = is;
    }
  ASSERT_EQ(errors.size(), 4u);
  // Twice the sides, four times the error. A mean of 16² texels loses √16/16² of what a texel does.
  for (const char* set : {"texel", "aligned16"})
    EXPECT_NEAR(errors.at({set, 2048 * 2048}) / errors.at({set, 1024 * 1024}), 4, 0.4) << set;
  EXPECT_NEAR(errors.at({"texel", 2048 * 2048}) / errors.at({"aligned16", 2048 * 2048}), 64, 6.4);
}

TEST(RegionAverageTask, ATextureIsKnownToBeNoiseByItsRecipeAndNotByItsName) {
  const auto figure_of = [&](std::unique_ptr<Block> block) {
    std::size_t m = 0;
    while (task().methods()[m].name != "sat_float") ++m;
    const auto subject = block->build(m, Knobs::object(), 1);
    subject->run(0, Knobs::object(), 1);
    EXPECT_EQ(block->query_sets()[0].name, "texel");
    return block->check(m, *subject, 0, Knobs::object()).extra.contains("region_average_figure");
  };
  EXPECT_TRUE(figure_of(task().open(BlockSpec{"noise", 10'000}, smoke())));
  EXPECT_FALSE(figure_of(task().open(BlockSpec{"mask", 10'000}, smoke())));
  datasets::Dataset file = datasets::generate("ramp", 10'000, 1);
  file.name = "noise";
  EXPECT_FALSE(figure_of(task().open(std::move(file), smoke())));
}

// A mean is told to an ulp: below ½ of z², below 1 of z. So its variance is off by at most 2⁻²⁵ + 2 z 2⁻²⁴, z
// being at most .675. One texel's sums of z² in float are off by .4/64 (figures.hpp), which is 6e-3.
TEST(RegionAverageProgram, VariancesOfAPlaneAreLostInFloatSumsAlone) {
  const double told = 0x1p-25 + 2 * 0.675 * 0x1p-24;
  std::map<std::string, double> off;
  for (const auto& row : run_program("--stress --dataset texture_plane_moments "
                                     "--benchmark_filter='/boxes/(sat_float|sat_double|brute)/'")
                             .second)
    off[row["method"]] = row["region_average_variance_error"];
  EXPECT_LE(off.at("brute"), told);
  EXPECT_LE(off.at("sat_double"), told);
  EXPECT_GT(off.at("sat_float"), 1e-3);
}

TEST(RegionAverageProgram, SmokeProfileEndsWellAndTheLadderClimbs) {
  const auto folder = std::filesystem::temp_directory_path() / "treeline_region_average_program";
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  const std::string rows = (folder / "rows").string();
  const std::string command = std::string(REGION_AVERAGE_TEST_PROGRAM) + " --profile smoke --rows " + rows +
                              " --pictures " + (folder / "pictures").string() + " >/dev/null 2>&1";
  EXPECT_EQ(std::system(command.c_str()), 0);
  std::ifstream in(rows);
  std::map<std::string, double> errors;  // of squares of a mask
  for (std::string line; std::getline(in, line);) {
    const auto row = nlohmann::json::parse(line);
    EXPECT_TRUE(row["status"] == "ok" || row["status"] == "unsupported" || row["status"] == "not_built")
        << line;
    // Look-ups read a pyramid of floats, wherever it is kept; under sanitizers bytes are not counted.
    if (row["method"] == "openimageio" && row["status"] == "ok" && !row["bytes"].is_null()) {
      const std::size_t channels = row["dataset"] == "marble" ? 4 : 1;
      EXPECT_GE(row["bytes"].get<double>(),
                4.0 / 3 * row["n"].get<double>() * double(channels * sizeof(float)))
          << line;
    }
    if (row["dataset"] != "mask" || row["query_set"] != "square24" || row["error"].is_null()) continue;
    std::string name = row["method"].get<std::string>();
    for (const auto& [key, value] : row["query_knobs"].items()) name += " " + value.dump();
    errors[name] = row["error"].get<double>();
  }
  EXPECT_GT(errors.at("nearest"), errors.at("mip_square 0"));
  EXPECT_GT(errors.at("mip_square 0"), errors.at("mip_square -0.79"));
  EXPECT_GT(errors.at("mip_square -0.79"), errors.at("mip_probes 2"));
  EXPECT_GT(errors.at("mip_probes 2"), errors.at("mip_probes 4"));
  EXPECT_GT(errors.at("mip_probes 4"), errors.at("sat_float"));
  for (const char* name : {"sat_uint32", "sat_int64", "sat_double", "brute"})
    EXPECT_LT(errors.at(name), 1e-7) << name;
  if (std::filesystem::exists(folder / "pictures" / "pictures.jsonl")) {
    std::ifstream index(folder / "pictures" / "pictures.jsonl");
    std::map<std::string, int> filtered, strips;  // by texture
    for (std::string line; std::getline(index, line);) {
      const auto picture = nlohmann::json::parse(line);
      EXPECT_TRUE(std::filesystem::exists(folder / "pictures" / picture["file"].get<std::string>())) << line;
      ++(picture["kind"] == "strip" ? strips : filtered)[picture["dataset"]];
      const std::string panels = picture["panels"].dump();
      if (picture["kind"] == "filtered")
        for (const char* method : {"truth", "nearest", "mip_square", "mip_anisotropic", "sat_float", "brute"})
          EXPECT_NE(panels.find(method), std::string::npos) << method << ": " << line;
    }
    for (const char* texture : {"noise", "ramp", "checkers", "mask", "star", "marble"}) {
      EXPECT_EQ(filtered[texture], 3) << texture;
      EXPECT_GE(strips[texture], texture == std::string("ramp") ? 0 : 1) << texture;
    }
  }
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace treeline::bench::region_average
