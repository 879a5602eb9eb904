// The task knn as a whole: its registry, its questions, its pictures, and every method on small clouds.
#include "bench/knn/task.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <set>

#include "bench/knn/questions.hpp"

namespace treeline::bench::knn {
namespace {

using geometry::Vec3f;

const KnnTask& task() {
  static const KnnTask t;
  return t;
}

RunContext smoke() { return {.profile = Profile::smoke, .seed = 1, .threads = 1, .truth_cache = ""}; }

TEST(KnnTask, EveryMethodIsBuiltOrNamedAsNotBuilt) {
  std::multiset<std::string> names;
  for (const MethodInfo& m : task().methods()) names.insert(m.name);
  for (const auto& [method, package] : task().not_built()) {
    names.insert(method);
    EXPECT_FALSE(package.empty()) << method;
  }
  EXPECT_EQ(names, (std::multiset<std::string>{"brute", "bsp_spill", "bsp_tree", "bvh", "bvh_wide",
                                               "cgal_kdtree", "flann_forest", "flann_single", "kd_tree",
                                               "nanoflann", "pcl_kdtree", "pcl_octree"}));
}

TEST(KnnTask, KnobsAreFlatObjectsAndPeersNameTheirVersion) {
  for (const MethodInfo& m : task().methods()) {
    EXPECT_EQ(m.source == Source::peer, !m.peer_version.empty()) << m.name;
    for (const auto* sweep : {&m.build_knobs, &m.query_knobs}) {
      ASSERT_FALSE(sweep->empty()) << m.name;
      for (const Knobs& k : *sweep) {
        ASSERT_TRUE(k.is_object()) << m.name << ": " << k.dump();
        for (const auto& [key, value] : k.items()) EXPECT_TRUE(value.is_primitive()) << m.name << ", " << key;
      }
    }
  }
}

TEST(KnnTask, AdviceIsMeasuredOnSetsThatExist) {
  const auto block = task().open({"uniform_cube", 1000}, smoke());
  for (const std::string& name : task().advise_on()) {
    const auto& sets = block->query_sets();
    EXPECT_TRUE(std::any_of(sets.begin(), sets.end(), [&](const QuerySet& s) { return s.name == name; }))
        << name;
  }
}

TEST(KnnTask, ProfilesNameRecipesThatExist) {
  for (const Profile profile : {Profile::smoke, Profile::quick, Profile::full}) {
    std::set<std::string> labels;
    for (const BlockSpec& spec : task().blocks(profile)) {
      EXPECT_TRUE(labels.insert(spec.label()).second) << spec.label() << " twice";
      const auto recipes = datasets::recipes();
      EXPECT_TRUE(std::any_of(recipes.begin(), recipes.end(), [&](const datasets::Recipe& r) {
        return r.name == spec.dataset && r.kind == datasets::Kind::cloud;
      })) << spec.dataset;
    }
    EXPECT_FALSE(labels.empty());
  }
}

// Every method with every knob on every query set of two clouds: none misses its claim, and a method of ours
// has every query.
TEST(KnnTask, EveryMethodKeepsItsClaimOnSmallClouds) {
  for (const BlockSpec& spec : task().blocks(Profile::smoke)) {
    const auto block = task().open(spec, smoke());
    ASSERT_EQ(block->query_sets().size(), 7u);
    for (std::size_t m = 0; m < task().methods().size(); ++m) {
      const MethodInfo& info = task().methods()[m];
      for (const Knobs& build_knobs : info.build_knobs) {
        const auto subject = block->build(m, build_knobs, 1);
        for (std::size_t q = 0; q < block->query_sets().size(); ++q)
          for (const Knobs& query_knobs : info.query_knobs) {
            const std::string cell = spec.label() + " " + info.name + " " + build_knobs.dump() + " " +
                                     query_knobs.dump() + " " + block->query_sets()[q].name;
            try {
              subject->run(q, query_knobs, 1);
            } catch (const Unsupported& e) {
              EXPECT_EQ(info.source, Source::peer) << cell << ": " << e.what();
              continue;
            }
            const Errors errors = block->check(m, *subject, q, query_knobs);
            EXPECT_TRUE(errors.within_claim) << cell << ": " << errors.reason;
            ASSERT_TRUE(errors.error.has_value()) << cell;
            EXPECT_GE(*errors.bias, info.claim == Claim::exact ? 0.0 : -1.0) << cell;
          }
      }
    }
  }
}

TEST(KnnTask, AnswersDoNotDependOnTheNumberOfThreads) {
  RunContext context = smoke();
  context.profile = Profile::quick;  // 500 queries: several chunks of a batch
  const auto block = task().open({"lidar", 1000}, context);
  for (std::size_t m = 0; m < task().methods().size(); ++m) {
    const MethodInfo& info = task().methods()[m];
    const auto subject = block->build(m, info.build_knobs.front(), 1);
    for (std::size_t q = 0; q < block->query_sets().size(); ++q) try {
        subject->run(q, info.query_knobs.front(), 1);
        const Errors one = block->check(m, *subject, q, info.query_knobs.front());
        subject->run(q, info.query_knobs.front(), 2);
        const Errors two = block->check(m, *subject, q, info.query_knobs.front());
        EXPECT_EQ(one.error, two.error) << info.name << " " << block->query_sets()[q].name;
        EXPECT_EQ(one.bias, two.bias) << info.name << " " << block->query_sets()[q].name;
      } catch (const Unsupported&) {
        EXPECT_EQ(info.source, Source::peer);
      }
  }
}

TEST(KnnQuestions, RadiusAndBoxHoldThirtyOnAverage) {
  const auto cloud = datasets::generate("uniform_cube", 20'000, 3).cloud;
  const DoubleScan scan(cloud.points);
  const Questions q = questions_about(scan, 500, 1, 2);
  double within = 0, inside = 0;
  for (const Vec3f& p : q.self) within += static_cast<double>(scan.within(p, q.radius).must.size());
  for (const geometry::Box3f& b : q.boxes) inside += static_cast<double>(scan.inside(b).must.size());
  // A Poisson count of mean 30: the radius is set on 64 queries, read on 500; five standard errors.
  const double slack = 5 * std::sqrt(30.0 / 64 + 30.0 / 500);
  EXPECT_NEAR(within / 500, 30, slack);
  EXPECT_NEAR(inside / 500, 30, slack);
}

TEST(KnnQuestions, SameForAnyNumberOfThreadsAndOtherForAnotherSeed) {
  const auto cloud = datasets::generate("lidar", 2'000, 3).cloud;
  const DoubleScan scan(cloud.points);
  const Questions a = questions_about(scan, 100, 1, 1), b = questions_about(scan, 100, 1, 2),
                  c = questions_about(scan, 100, 2, 1);
  EXPECT_EQ(a.self, b.self);
  EXPECT_EQ(a.off, b.off);
  EXPECT_EQ(a.boxes, b.boxes);
  EXPECT_EQ(a.radius, b.radius);
  EXPECT_NE(a.self, c.self);
  EXPECT_NE(a.off, c.off);
}

TEST(KnnQuestions, SelfQueriesAreDistinctPointsOfTheCloud) {
  const auto cloud = datasets::generate("uniform_ball", 1'000, 3).cloud;
  const Questions q = questions_about(DoubleScan(cloud.points), 1'000, 1, 1);
  const auto by_x = [](const Vec3f& a, const Vec3f& b) {
    return std::lexicographical_compare(a.v, a.v + 3, b.v, b.v + 3);
  };
  std::vector<Vec3f> asked = q.self, points = cloud.points;
  std::sort(asked.begin(), asked.end(), by_x);
  std::sort(points.begin(), points.end(), by_x);
  EXPECT_EQ(asked, points);
  EXPECT_NE(q.self, cloud.points) << "not shuffled";
}

TEST(KnnTask, OpensTheVerticesOfAMesh) {
  datasets::Dataset mesh = datasets::generate("icosphere", 1'000, 1);
  const std::size_t vertices = mesh.mesh.vertices.size();
  EXPECT_EQ(task().open(std::move(mesh), smoke())->n(), vertices);
}

TEST(KnnTask, RefusesACloudWithoutAnyFinitePoint) {
  datasets::Dataset empty;
  EXPECT_THROW(task().open(empty, smoke()), std::invalid_argument);
}

TEST(KnnTask, DrawsEachOfOurTreesAndIndexesTheDrawings) {
  const auto folder = std::filesystem::temp_directory_path() / "treeline_knn_pictures_test";
  std::filesystem::remove_all(folder);
  task().pictures({"uniform_cube", 1000}, smoke(), folder.string());
  std::ifstream index(folder / "pictures.jsonl");
  std::set<std::string> drawn;
  for (std::string line; std::getline(index, line);) {
    const auto entry = nlohmann::json::parse(line);
    drawn.insert(entry.at("method"));
    EXPECT_EQ(entry.at("kind"), "slice");
    EXPECT_EQ(entry.at("dataset"), "uniform_cube:1000");
    std::ifstream file(folder / entry.at("file").get<std::string>());
    const std::string svg((std::istreambuf_iterator<char>(file)), {});
    EXPECT_EQ(svg.rfind("<svg ", 0), 0u);
    EXPECT_NE(svg.find("<path "), std::string::npos);
    EXPECT_NE(svg.find("<circle "), std::string::npos);
    EXPECT_EQ(svg.find("nan"), std::string::npos);
  }
  EXPECT_EQ(drawn, (std::set<std::string>{"kd_tree", "bsp_tree", "bsp_spill", "bvh", "bvh_wide"}));
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace treeline::bench::knn
