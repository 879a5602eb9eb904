// The task ray as a whole: its methods are those that CMake lists, ours keep their claims on every hard case
// and the smoke profile, and what it cannot take it refuses by name.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>

#include "bench/core/registry.hpp"
#include "bench/ray/block.hpp"
#include "bench/ray/task.hpp"

namespace treeline::bench::ray {
namespace {

RunContext smoke_context(std::uint64_t seed = 1) {
  RunContext context;
  context.profile = Profile::smoke, context.seed = seed;
  return context;
}

TEST(RayTask, HasTheMethodsThatCMakeLists) {
  const RayTask task;
  std::set<std::string> names, listed;
  for (const auto& info : task.methods()) names.insert(info.name);
  for (const auto& [name, package] : task.not_built()) names.insert(name);
  for (const auto& name : split_names(RAY_TEST_METHODS)) listed.insert(name);
  // What is listed is source files; each of our trees' registers a fast variant, too.
  for (const char* tree : {"brute", "kd_tree", "bsp_tree", "bvh"}) listed.insert(std::string(tree) + "_fast");
  for (const char* other : {"slab_textbook", "slab_padded", "bvh_wide", "bvh_wide_compact", "bvh_wide_exact"})
    listed.insert(other);
  EXPECT_EQ(names, listed);
  EXPECT_EQ(names.size(), task.methods().size() + task.not_built().size());
  for (const char* name :
       {"brute", "brute_fast", "kd_tree", "kd_tree_fast", "bsp_tree", "bsp_tree_fast", "bvh", "bvh_fast",
        "bvh_wide", "bvh_wide_compact", "bvh_wide_exact", "embree_single", "embree_packet8",
        "embree_packet16", "embree_stream", "cgal_aabb", "cgal_aabb_epick", "pcl_octree"})
    EXPECT_TRUE(names.contains(name)) << name;
}

/// Every build of ours on every ray set of a block; of hard cases those builds that the hard cases themselves
/// (known_failures) leave out.
void expect_claims_kept(const RayTask& task, Block& block, bool hard = false) {
  for (std::size_t m = 0; m < task.methods().size(); ++m) {
    const MethodInfo& info = task.methods()[m];
    if (info.source != Source::ours) continue;
    // Millions of tests take brute force a while; the hard cases themselves (known_failures) leave nobody
    // out.
    if (info.family == "brute" && block.n() * block.query_sets().front().size > 50'000'000) continue;
    for (std::size_t b = 0; b < info.build_knobs.size(); ++b) {
      if (hard && std::ranges::count(info.stress_builds, b) > 0) continue;
      const Knobs& knobs = info.build_knobs[b];
      std::unique_ptr<Subject> subject;
      try {
        subject = block.build(m, knobs, 1);
      } catch (const Unsupported&) {
        EXPECT_TRUE(info.hard_cases_only) << info.name;
        continue;
      }
      for (std::size_t set = 0; set < block.query_sets().size(); ++set) {
        try {
          subject->prepare(set, 1);
          subject->run(set, Knobs::object(), 1);
        } catch (const accel::InvalidInput&) {
          continue;  // rays that are not finite are refused
        } catch (const Unsupported&) {
          continue;  // has no refit, or no closest hit
        }
        const Errors errors = block.check(m, *subject, set, Knobs::object());
        EXPECT_TRUE(errors.within_claim) << info.name << " " << knobs.dump() << " "
                                         << block.query_sets()[set].name << ": " << errors.reason;
        if (info.claim != Claim::approximate && !errors.extra.at("ray_leaks_per_million").is_null()) {
          EXPECT_EQ(errors.extra.at("ray_leaks_per_million"), 0) << info.name;
        }
      }
    }
  }
}

TEST(RayTask, OursKeepTheirClaimsOnAllHardCases) {
  const RayTask task;
  for (const BlockSpec& spec : task.hard_blocks()) {
    SCOPED_TRACE(spec.label());
    expect_claims_kept(task, *task.open(spec, smoke_context()), true);
  }
}

TEST(RayTask, OursKeepTheirClaimsOnEveryMesh) {
  const RayTask task;
  for (const auto& recipe : datasets::recipes()) {
    if (recipe.kind != datasets::Kind::mesh) continue;
    SCOPED_TRACE(recipe.name);
    expect_claims_kept(task, *task.open(BlockSpec{recipe.name, 2000}, smoke_context(7)));
  }
}

TEST(RayTask, AsksAllThatItSays) {
  const RayTask task;
  for (const char* name : {"terrain", "forest"}) {
    const auto block = task.open(BlockSpec{name, 1000}, smoke_context());
    std::set<std::string> names;
    for (const auto& set : block->query_sets()) {
      names.insert(set.name);
      EXPECT_GT(set.size, 200u) << "rays that miss are filled up: " << name << " " << set.name;
      EXPECT_LE(set.size, 256u);
    }
    EXPECT_EQ(names, (std::set<std::string>{"camera", "camera_shuffled", "camera_any", "diffuse", "bounce2",
                                            "random", "shadow", "axis", "grazing", "edge"}));
    for (const auto& advised : task.advise_on()) EXPECT_TRUE(names.contains(advised));
  }
}

TEST(RayTask, ThreadsShareMoreOfTheSameRays) {
  const RayTask task;
  ASSERT_FALSE(task.scaling_blocks(Profile::smoke).empty());
  for (BlockSpec spec : task.scaling_blocks(Profile::smoke)) {
    const auto fewer = task.open(spec, smoke_context());
    spec.scaling = true;
    const auto block = task.open(spec, smoke_context());
    std::set<std::string> names;
    for (const auto& set : block->query_sets()) {
      names.insert(set.name);
      const auto of_one =
          std::ranges::find(fewer->query_sets(), set.name.substr(0, set.name.find('_')), &QuerySet::name);
      ASSERT_NE(of_one, fewer->query_sets().end()) << set.name;
      EXPECT_GT(set.size, 4 * of_one->size);
    }
    EXPECT_EQ(names, (std::set<std::string>{"camera_threads", "random_threads", "shadow_threads"}));
    expect_claims_kept(task, *block);  // each set is judged by a truth of its own
  }
}

TEST(RayTask, RefusesRaySetsThatMeasureNothing) {
  std::vector<RaySet> sets{
      {"camera", false, {geometry::Rayf{}}, 0}, {"diffuse", false, {}, 1}, {"edge", false, {}, 2}};
  try {
    refuse_empty(sets);
    FAIL() << "empty sets were taken";
  } catch (const std::invalid_argument& e) {
    EXPECT_NE(std::string(e.what()).find("diffuse, edge"), std::string::npos) << e.what();
  }
  sets.resize(1);
  EXPECT_NO_THROW(refuse_empty(sets));
}

TEST(RayTask, RefusesWhatIsNoMesh) {
  const RayTask task;
  datasets::Dataset cloud;
  cloud.name = "scan.ply";
  cloud.cloud.points = {{0, 0, 0}};
  try {
    (void)task.open(std::move(cloud), {});
    FAIL() << "a cloud was taken for a mesh";
  } catch (const std::invalid_argument& e) {
    EXPECT_NE(std::string(e.what()).find("scan.ply"), std::string::npos) << e.what();
  }
  datasets::Dataset degenerate;
  degenerate.kind = datasets::Kind::mesh;
  degenerate.mesh = {{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 1, 2}}};
  EXPECT_THROW((void)task.open(std::move(degenerate), {}), std::invalid_argument);
}

TEST(RayTask, SmokeProfileGivesValidRows) {
  const auto rows =
      std::filesystem::temp_directory_path() / ("ray_smoke_" + std::to_string(::getpid()) + ".jsonl");
  const std::string command = std::string(RAY_TEST_PROGRAM) + " --profile smoke --cache '' --rows " +
                              rows.string() + " > /dev/null 2>&1";
  const int status = std::system(command.c_str());
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 0);
  std::ifstream in(rows);
  std::size_t count = 0;
  for (std::string line; std::getline(in, line); ++count) {
    const auto json = nlohmann::ordered_json::parse(line);
    const Row row = Row::from_json(json);
    EXPECT_EQ(row.task, "ray");
    if (row.status == Status::unsupported || row.status == Status::not_built) continue;
    EXPECT_TRUE(row.source == Source::peer || row.status == Status::ok) << row.method << ": " << row.reason;
    if (row.status != Status::ok) continue;
    EXPECT_GT(row.query_ns.value_or(0), 0) << line;
    ASSERT_TRUE(row.errors.error.has_value()) << line;
    EXPECT_LE(row.errors.error.value(), row.errors.max.value()) << line;
    EXPECT_TRUE(json.contains("ray_false_hits") && json.contains("ray_leaks_per_million")) << line;
  }
  EXPECT_GT(count, 100u);
  std::filesystem::remove(rows);
}

}  // namespace
}  // namespace treeline::bench::ray
