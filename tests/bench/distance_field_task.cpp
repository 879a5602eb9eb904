// The task distance_field: its truth beside a second witness, every method through its cells, and answers
// that its judge must not let pass.
#include "bench/distance_field/task.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <set>

#include "bench/distance_field/block.hpp"
#include "bench/distance_field/truth.hpp"
#include "geometry/distance.hpp"
#include "geometry/random.hpp"

namespace treeline::bench::distance_field {
namespace {

using geometry::Vec3d;

const DistanceFieldTask& task() {
  static const DistanceFieldTask t;
  return t;
}

RunContext smoke() { return {.profile = Profile::smoke, .seed = 1, .threads = 1, .truth_cache = ""}; }

/// All faces one by one, and the sum of their solid angles (Van Oosterom and Strackee 1983).
double witness(const geometry::Mesh3f& mesh, const Vec3d& p) {
  double d2 = std::numeric_limits<double>::infinity(), angle = 0;
  for (std::size_t i = 0; i < mesh.size(); ++i) {
    const geometry::Triangle3d t(mesh.triangle(i));
    d2 = std::min(d2, closest_point_on_triangle(p, t).distance2);
    const Vec3d a = t.a - p, b = t.b - p, c = t.c - p;
    const double x = length(a), y = length(b), z = length(c);
    angle += 2 * std::atan2(dot(a, cross(b, c)), x * y * z + dot(a, b) * z + dot(b, c) * x + dot(c, a) * y);
  }
  return angle > 2 * std::numbers::pi ? -std::sqrt(d2) : std::sqrt(d2);
}

TEST(DistanceFieldTruth, AgreesWithASecondWitness) {
  for (const char* name :
       {"icosphere", "nested_shells", "torus_knot", "icosphere+nested", "icosphere+inside_out"}) {
    const auto mesh = datasets::generate(name, 2000, 1).mesh;
    const Truth truth(mesh, &mesh);
    geometry::Pcg32 random(5);
    std::vector<Vec3d> points(500);
    for (Vec3d& p : points)
      for (int k = 0; k < 3; ++k) p[k] = random.uniform(-1.2, 1.2);
    const auto found = truth.distances(points, 1);
    const auto inside = std::ranges::count_if(found, [](double d) { return d < 0; });
    EXPECT_EQ(inside > 0, !std::string_view(name).ends_with("inside_out")) << name;
    for (std::size_t i = 0; i < points.size(); ++i)
      ASSERT_NEAR(found[i], witness(mesh, points[i]), 1e-9) << name << " " << i;
  }
}

TEST(DistanceFieldTask, EveryMethodIsBuiltOrNamedAsNotBuilt) {
  std::multiset<std::string> names;
  for (const MethodInfo& m : task().methods()) names.insert(m.name);
  for (const auto& [name, package] : task().not_built()) names.insert(name);
  EXPECT_EQ(names, (std::multiset<std::string>{"bvh", "bricks", "bricks_cubic", "bricks_signs", "dense",
                                               "dense_cubic", "openvdb"}));
}

TEST(DistanceFieldTask, HardCasesOpen) {
  for (const BlockSpec& spec : task().hard_blocks())
    EXPECT_GT(task().open(spec, smoke())->n(), 0u) << spec.dataset;
  EXPECT_THROW(task().open({"no_such_case", 0, true}, smoke()), std::invalid_argument);
  EXPECT_THROW(task().open(datasets::generate("uniform_cube", 1000, 1), smoke()), std::invalid_argument);
}

/// A field that is right but for one fault, and says that it is certain.
enum class Fault {
  none,
  off_by_a_percent,
  other_side,
  no_number,
  misses_silently,
  hits_nothing,
  hits_far_wall,
  tells_far_wall,  // of every tenth ray, which it doubts
  always_doubtful_miss,
  always_doubtful_hit,  // where it is
  always_exhausted,     // gives up on every ray, and doubts none
  batch_only_wrong      // one by one it is right
};
const geometry::Mesh3f* faulty_mesh = nullptr;

template <Fault fault>
class Faulty final : public Field {
 public:
  void distances(std::span<const geometry::Vec3f> points, const Knobs&, int,
                 std::span<float> out) const override {
    const double factor = fault == Fault::batch_only_wrong ? 1.00001 : 1;
    for (std::size_t i = 0; i < points.size(); ++i)
      out[i] = static_cast<float>(factor * at(Vec3d(points[i])));
  }
  void trace(std::span<const geometry::Rayf> rays, const Knobs&, int,
             std::span<TraceAnswer> out) const override {
    const auto hits = truth_.hits(rays, 1);
    auto onward = std::vector<geometry::Rayf>(rays.begin(), rays.end());
    for (std::size_t i = 0; i < rays.size(); ++i) onward[i].t_min = static_cast<float>(hits[i]) + 0.1f;
    const auto second = truth_.hits(onward, 1);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const bool passes = fault == Fault::hits_far_wall || (fault == Fault::tells_far_wall && i % 10 == 0);
      out[i] = {.t = static_cast<float>(passes && std::isfinite(second[i]) ? second[i] : hits[i])};
      out[i].doubtful = (fault == Fault::tells_far_wall && passes) || fault == Fault::always_doubtful_hit ||
                        fault == Fault::always_doubtful_miss;
      out[i].exhausted = fault == Fault::always_exhausted;
      if (fault == Fault::misses_silently || fault == Fault::always_doubtful_miss || out[i].exhausted)
        out[i].t = std::numeric_limits<float>::infinity();
      if (fault == Fault::hits_nothing) out[i].t = 0.01f;
    }
  }
  std::optional<accel::field::FieldSample> certain(const Vec3d& p, const Knobs&) const override {
    return accel::field::FieldSample{at(p), 1e-6, true};
  }

 private:
  double at(const Vec3d& p) const {
    const double d = truth_.distances(std::span(&p, 1), 1)[0];
    if (fault == Fault::off_by_a_percent) return 1.01 * d;
    if (fault == Fault::other_side) return -d;
    return fault == Fault::no_number ? std::nan("") : d;
  }
  Truth truth_{*faulty_mesh, faulty_mesh};
};

/// The sets in which the judge finds the answers wrong.
template <Fault fault>
std::set<std::string> sets_found_wrong() {
  static const datasets::Dataset sphere = datasets::generate("icosphere", 1000, 1);
  faulty_mesh = &sphere.mesh;
  std::vector<Method> methods(1);
  methods[0].info.name = "faulty", methods[0].info.claim = Claim::bounded;
  methods[0].build = [](const Input&, const Knobs&) -> std::unique_ptr<Field> {
    return std::make_unique<Faulty<fault>>();
  };
  BlockInput input;
  input.dataset = sphere, input.points = input.rays = 200;
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

TEST(DistanceFieldTask, FaultsAreFound) {
  const std::set<std::string> points{"near", "uniform"}, rays{"trace"};
  EXPECT_EQ(sets_found_wrong<Fault::none>(), std::set<std::string>{});
  EXPECT_EQ(sets_found_wrong<Fault::off_by_a_percent>(), points);
  EXPECT_EQ(sets_found_wrong<Fault::other_side>(), points);
  EXPECT_EQ(sets_found_wrong<Fault::no_number>(), points);
  EXPECT_EQ(sets_found_wrong<Fault::misses_silently>(), rays);
  EXPECT_EQ(sets_found_wrong<Fault::hits_nothing>(), rays);
  EXPECT_EQ(sets_found_wrong<Fault::hits_far_wall>(), rays);
  EXPECT_EQ(sets_found_wrong<Fault::tells_far_wall>(), std::set<std::string>{});
  EXPECT_EQ(sets_found_wrong<Fault::always_doubtful_miss>(), rays);
  EXPECT_EQ(sets_found_wrong<Fault::always_doubtful_hit>(), rays);
  EXPECT_EQ(sets_found_wrong<Fault::always_exhausted>(), rays);
  EXPECT_EQ(sets_found_wrong<Fault::batch_only_wrong>(), points);
}

// What a mesh lacks stands in its rows, not on the terminal alone.
TEST(DistanceFieldTask, OpenAndInsideOutMeshesAreNoted) {
  const auto note = [](const char* name) {
    const auto block = task().open(datasets::generate(name, 1'000, 1), smoke());
    const auto subject = block->build(0, task().methods()[0].build_knobs[0], 1);
    subject->run(0, Knobs::object(), 1);
    return block->check(0, *subject, 0, Knobs::object()).extra.value("distance_field_note", "");
  };
  EXPECT_EQ(note("icosphere"), "");
  EXPECT_NE(note("icosphere+hole_2").find("not closed"), std::string::npos);
  EXPECT_NE(note("icosphere+inside_out").find("inside out"), std::string::npos);
}

// What is bounded says by how much, or its answers could not be judged.
TEST(DistanceFieldTask, BoundedMethodsAreHeldToABound) {
  const auto block = task().open({"icosphere", 1'000}, smoke());
  for (std::size_t m = 0; m < task().methods().size(); ++m) {
    const MethodInfo& info = task().methods()[m];
    if (info.claim != Claim::bounded) continue;
    const Knobs& knobs = info.build_knobs.front();
    const auto subject = block->build(m, knobs, 1);
    for (std::size_t q = 0; q < block->query_sets().size(); ++q) {
      subject->run(q, Knobs::object(), 1);
      const Errors errors = block->check(m, *subject, q, Knobs::object());
      EXPECT_TRUE(errors.within_claim) << info.name << ": " << errors.reason;
      if (errors.extra.contains("distance_field_bounded_points")) {
        EXPECT_EQ(errors.extra.at("distance_field_bounded_points"), block->query_sets()[q].size) << info.name;
      }
    }
  }
}

TEST(DistanceFieldProgram, SmokeProfileEndsWellAndErrorsFallWithResolution) {
  const auto folder = std::filesystem::temp_directory_path() / "treeline_distance_field_program";
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  const std::string rows = (folder / "rows").string();
  const std::string command =
      std::string(DISTANCE_FIELD_TEST_PROGRAM) + " --profile smoke --rows " + rows + " >/dev/null 2>&1";
  EXPECT_EQ(std::system(command.c_str()), 0);
  std::ifstream in(rows);
  std::map<int, double> of_bricks, samples_of_bricks, samples_of_openvdb;
  for (std::string line; std::getline(in, line);) {
    const auto row = nlohmann::json::parse(line);
    EXPECT_TRUE(row["status"] == "ok" || row["status"] == "unsupported" || row["status"] == "not_built")
        << line;
    if (row["status"] == "ok" && (row["query_set"] == "near" || row["query_set"] == "uniform"))
      EXPECT_EQ(row["error_max"].is_null(), row["query_set"] == "uniform")
          << "a side is right or wrong: " << line;
    if (row["method"] == "openvdb" && row["query_set"] == "near" && row["status"] == "ok") {
      double& least = samples_of_openvdb.try_emplace(row["build_knobs"]["resolution"], 1.0).first->second;
      least = std::min(least, row["distance_field_sample_error_mean"].get<double>());
    }
    if (row["method"] == "bricks" && row["query_set"] == "near") {
      samples_of_bricks[row["build_knobs"]["resolution"]] = row["distance_field_sample_error_mean"];
      of_bricks[row["build_knobs"]["resolution"].get<int>()] = row["error"].get<double>();
      EXPECT_LT(row["distance_field_sample_error_max"].get<double>(), 1e-5);
      EXPECT_EQ(row["distance_field_sample_signs_wrong"].get<double>(), 0);
      EXPECT_TRUE(row["distance_field_told_closed"].get<bool>());
    }
  }
  ASSERT_EQ(of_bricks.size(), 3u);
  EXPECT_GT(of_bricks[32], 2 * of_bricks[64]);
  EXPECT_GT(of_bricks[64], 2 * of_bricks[128]);
  for (const auto& [resolution, error] : samples_of_openvdb) EXPECT_LT(samples_of_bricks[resolution], error);
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace treeline::bench::distance_field
