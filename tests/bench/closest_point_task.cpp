// The task closest_point as a whole: its methods are those that CMake lists, ours keep their claims on every
// hard case and mesh, and what it cannot take it refuses by name.
#include <gtest/gtest.h>

#include <sys/wait.h>
#include <algorithm>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>

#include "bench/closest_point/block.hpp"
#include "bench/closest_point/task.hpp"
#include "bench/core/registry.hpp"

namespace treeline::bench::closest_point {
namespace {

RunContext smoke_context(std::uint64_t seed = 1) {
  RunContext context;
  context.profile = Profile::smoke, context.seed = seed;
  return context;
}

TEST(ClosestPointTask, HasTheMethodsThatCMakeLists) {
  const ClosestPointTask task;
  std::set<std::string> names, listed;
  for (const auto& info : task.methods()) names.insert(info.name);
  for (const auto& [name, package] : task.not_built()) names.insert(name);
  for (const auto& name : split_names(CLOSEST_POINT_TEST_METHODS)) listed.insert(name);
  // What is listed is source files; each of our binary trees' registers one in double, too.
  for (const char* tree : {"brute", "kd_tree", "bsp_tree", "bvh"})
    listed.insert(std::string(tree) + "_double");
  listed.insert("bvh_wide_exact");
  EXPECT_EQ(names, listed);
}

/// Every build and query knob of ours on every query set of a block; of hard cases those builds that the hard
/// cases themselves (known_failures) leave out.
void expect_claims_kept(const ClosestPointTask& task, Block& block, bool hard, double largest_error = 1) {
  for (std::size_t m = 0; m < task.methods().size(); ++m) {
    const MethodInfo& info = task.methods()[m];
    if (info.source != Source::ours) continue;
    for (std::size_t b = 0; b < info.build_knobs.size(); ++b) {
      if (hard && std::ranges::count(info.stress_builds, b) > 0) continue;
      const Knobs& build = info.build_knobs[b];
      std::unique_ptr<Subject> subject;
      try {
        subject = block.build(m, build, 1);
      } catch (const Unsupported&) {
        continue;  // a soup cannot be decimated
      } catch (const std::invalid_argument&) {
        EXPECT_EQ(info.name, "bvh_decimated");  // takes no vertex that is not finite
        continue;
      }
      for (std::size_t set = 0; set < block.query_sets().size(); ++set)
        for (const Knobs& query : info.query_knobs) {
          try {
            subject->run(set, query, 1);
          } catch (const accel::InvalidInput&) {
            continue;  // queries that are not finite are refused
          }
          const Errors errors = block.check(m, *subject, set, query);
          const std::string where =
              info.name + " " + build.dump() + query.dump() + " " + block.query_sets()[set].name;
          EXPECT_TRUE(errors.within_claim) << where << ": " << errors.reason;
          if (info.claim != Claim::approximate && errors.max) {
            EXPECT_LE(*errors.max, largest_error) << where;
          }
        }
    }
  }
}

TEST(ClosestPointTask, OursKeepTheirClaimsOnAllHardCases) {
  const ClosestPointTask task;
  for (const BlockSpec& spec : task.hard_blocks()) {
    SCOPED_TRACE(spec.label());
    expect_claims_kept(task, *task.open(spec, smoke_context()), true);
  }
}

TEST(ClosestPointTask, OursKeepTheirClaimsOnEveryMesh) {
  const ClosestPointTask task;
  for (const char* name :
       {"icosphere", "terrain", "architecture", "forest", "nested_shells", "torus_knot", "needles", "caps",
        "icosphere+duplicated_5", "icosphere+degenerate_5", "icosphere+unwelded"}) {
    SCOPED_TRACE(name);
    expect_claims_kept(task, *task.open(BlockSpec{name, 2000}, smoke_context(7)), false, 1e-6);
  }
}

TEST(ClosestPointTask, AsksAllThatItSays) {
  const ClosestPointTask task;
  const auto block = task.open(BlockSpec{"terrain", 1000}, smoke_context());
  std::set<std::string> names;
  for (const auto& set : block->query_sets()) {
    names.insert(set.name);
    EXPECT_EQ(set.size, 256u);
  }
  EXPECT_EQ(names, (std::set<std::string>{"near", "near_sorted", "uniform", "uniform_sorted", "far", "centre",
                                          "on_vertex"}));
  for (const auto& advised : task.advise_on()) EXPECT_TRUE(names.contains(advised));
}

TEST(ClosestPointQueries, AreWhereTheySay) {
  const auto mesh = datasets::generate("icosphere", 2000, 1).mesh;
  const auto sets = make_point_sets(mesh, {300, 300, 300}, 3);
  const geometry::Box3d box = box_of(mesh);
  const double diagonal = geometry::length(box.extent());
  const auto distances = [&](std::size_t set) {
    std::vector<double> out;
    for (const auto& t : true_closest(mesh, sets[set].points.floats, 1))
      out.push_back(std::sqrt(t.distance2));
    return out;
  };
  for (const double d : distances(0)) EXPECT_LE(d, 1.001e-3 * diagonal);
  for (const auto& p : sets[2].points.doubles) EXPECT_TRUE(box.contains(p));
  for (const double d : distances(4)) EXPECT_GT(d, diagonal);
  for (const auto& p : sets[5].points.doubles)
    EXPECT_LE(geometry::length(p - box.centre()), 1.001e-2 * diagonal);
  std::set<std::array<float, 3>> vertices;
  for (const auto& v : mesh.vertices) vertices.insert({v[0], v[1], v[2]});
  for (std::size_t i = 0; i < 300; ++i) {
    const auto& p = sets[6].points.floats[i];
    EXPECT_EQ(vertices.contains({p[0], p[1], p[2]}), i % 3 == 0) << i;
  }
}

TEST(ClosestPointQueries, SortedSetsHoldTheSameQueries) {
  const auto mesh = datasets::generate("icosphere", 2000, 1).mesh;
  const auto sets = make_point_sets(mesh, {300, 200, 1}, 3);
  for (const std::size_t s : {1u, 3u}) {
    const PointSet &sorted = sets[s], &given = sets[sorted.truth];
    ASSERT_EQ(sorted.place.size(), given.points.size());
    double way = 0, given_way = 0;
    for (std::size_t i = 0; i < given.points.size(); ++i) {
      EXPECT_EQ(sorted.points.floats[sorted.place[i]], given.points.floats[i]);
      if (i == 0) continue;
      way += geometry::distance(sorted.points.doubles[i], sorted.points.doubles[i - 1]);
      given_way += geometry::distance(given.points.doubles[i], given.points.doubles[i - 1]);
    }
    EXPECT_LT(way, 0.5 * given_way) << "neighbours follow each other";
  }
}

TEST(ClosestPointTask, DecimationTradesErrorForMesh) {
  const ClosestPointTask task;
  const auto block = task.open(BlockSpec{"icosphere", 5000}, smoke_context());
  for (std::size_t m = 0; m < task.methods().size(); ++m) {
    const MethodInfo& info = task.methods()[m];
    if (info.name != "bvh_decimated") continue;
    std::vector<double> errors;
    for (const Knobs& knobs : info.build_knobs) {
      std::unique_ptr<Subject> subject;
      try {
        subject = block->build(m, knobs, 1);
      } catch (const Unsupported&) {
        GTEST_SKIP() << "built without OpenMesh";
      }
      subject->run(0, Knobs::object(), 1);
      errors.push_back(block->check(m, *subject, 0, Knobs::object()).error.value());
    }
    ASSERT_EQ(errors.size(), 5u);
    EXPECT_LE(errors[0], 1e-7) << "all of the mesh";
    for (std::size_t i = 1; i < errors.size(); ++i) EXPECT_GT(errors[i], errors[i - 1]);
    EXPECT_LT(errors.back(), 1e-2);
  }
}

TEST(ClosestPointTask, RefusesWhatIsNoMesh) {
  const ClosestPointTask task;
  datasets::Dataset cloud;
  cloud.name = "scan.ply";
  cloud.cloud.points = {{0, 0, 0}};
  try {
    (void)task.open(std::move(cloud), {});
    FAIL() << "a cloud was taken for a mesh";
  } catch (const std::invalid_argument& e) {
    EXPECT_NE(std::string(e.what()).find("scan.ply"), std::string::npos) << e.what();
  }
  datasets::Dataset broken;
  broken.kind = datasets::Kind::mesh;
  broken.mesh = {{{std::numeric_limits<float>::quiet_NaN(), 0, 0}}, {{0, 0, 0}}};
  EXPECT_THROW((void)task.open(std::move(broken), {}), std::invalid_argument);
}

TEST(ClosestPointTask, SmokeProfileGivesValidRows) {
  const auto rows =
      std::filesystem::temp_directory_path() / ("closest_smoke_" + std::to_string(::getpid()) + ".jsonl");
  const std::string command = std::string(CLOSEST_POINT_TEST_PROGRAM) +
                              " --profile smoke --cache '' --rows " + rows.string() + " > /dev/null 2>&1";
  const int status = std::system(command.c_str());
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 0);
  std::ifstream in(rows);
  std::size_t count = 0;
  for (std::string line; std::getline(in, line); ++count) {
    const auto json = nlohmann::ordered_json::parse(line);
    const Row row = Row::from_json(json);
    EXPECT_EQ(row.task, "closest_point");
    if (row.status == Status::unsupported || row.status == Status::not_built) continue;
    EXPECT_TRUE(row.source == Source::peer || row.status == Status::ok) << row.method << ": " << row.reason;
    if (row.status != Status::ok) continue;
    EXPECT_GT(row.query_ns.value_or(0), 0) << line;
    ASSERT_TRUE(row.errors.error.has_value()) << line;
    EXPECT_LE(row.errors.error.value(), row.errors.max.value()) << line;
    EXPECT_TRUE(json.contains("closest_point_far_off")) << line;
  }
  EXPECT_GT(count, 100u);
  std::filesystem::remove(rows);
}

}  // namespace
}  // namespace treeline::bench::closest_point
