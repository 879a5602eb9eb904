// The task knn as a whole: its registry, its questions, its pictures, and every method on small clouds.
#include "bench/knn/task.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <set>

#include "bench/core/cells.hpp"
#include "bench/core/registry.hpp"
#include "bench/knn/density_picture.hpp"
#include "bench/knn/method.hpp"
#include "bench/knn/metric.hpp"
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
  EXPECT_EQ(
      names,
      (std::multiset<std::string>{
          "brute",       "brute_double",       "bsp_spill",        "bsp_tree",         "bvh",
          "bvh_wide",    "bvh_wide_double",    "bvh_wide_epsilon", "bvh_wide_leaves",  "bvh_wide_rounded",
          "cgal_kdtree", "cgal_kdtree_double", "flann_forest",     "flann_kmeans",     "flann_single",
          "kd_tree",     "kd_tree_double",     "nanoflann",        "nanoflann_double", "nanoflann_rounded",
          "pcl_kdtree",  "pcl_octree"}));
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
  for (const Profile profile : {Profile::smoke, Profile::quick, Profile::full}) {
    RunContext context = smoke();
    context.profile = profile;
    const auto block = task().open({"uniform_cube", 1000}, context);
    const auto& sets = block->query_sets();
    for (const std::string& name : task().advise_on())
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

// Every method with every knob on every query set of small clouds, of floats and of doubles: none misses its
// claim, and a method of ours has every query.
TEST(KnnTask, EveryMethodKeepsItsClaimOnSmallClouds) {
  std::set<std::string> asked;
  for (const BlockSpec& spec : task().blocks(Profile::smoke)) {
    const auto block = task().open(spec, smoke());
    ASSERT_EQ(block->query_sets().size(), 11u);
    for (std::size_t m = 0; m < task().methods().size(); ++m) {
      const MethodInfo& info = task().methods()[m];
      if (!block->offers(m)) continue;
      asked.insert(info.name);
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
            // In doubles the truth's own rounding is as coarse as the method's.
            const double least = info.claim != Claim::exact ? -1.0
                                 : block->in_double()       ? -double_floor()
                                                            : 0.0;
            EXPECT_GE(*errors.bias, least) << cell;
          }
      }
    }
  }
  EXPECT_EQ(asked.size(), task().methods().size()) << "no small cloud is of the other scalar";
}

// What float does to a georeferenced cloud is an error against the doubles; its middle taken off, a small
// one.
TEST(KnnTask, RoundedCloudsAreJudgedAgainstTheirDoubles) {
  const auto block = task().open({"georeferenced", 2000}, smoke());
  ASSERT_TRUE(block->in_double());
  const auto& sets = block->query_sets();
  const auto set =
      static_cast<std::size_t>(std::ranges::find(sets, "knn8_self", &QuerySet::name) - sets.begin());
  const auto error = [&](const std::string& method, const Knobs& build_knobs) {
    const auto at = std::ranges::find(task().methods(), method, &MethodInfo::name);
    const auto m = static_cast<std::size_t>(at - task().methods().begin());
    const auto subject = block->build(m, build_knobs, 1);
    subject->run(set, Knobs::object(), 1);
    return *block->check(m, *subject, set, Knobs::object()).error;
  };
  const Knobs perimeter{{"split", "perimeter"}};
  Knobs file = perimeter, middle = perimeter;
  file["origin"] = "file", middle["origin"] = "middle";
  const double exact = error("bvh_wide_double", perimeter), near = error("bvh_wide_rounded", middle),
               far = error("bvh_wide_rounded", file);
  EXPECT_LE(exact, double_floor());
  EXPECT_GT(far, 1e-2);  // half a metre is more than these points are apart
  EXPECT_LT(near, 1e-3);
  EXPECT_GE(near, exact);
}

TEST(KnnTask, DoublesOfAFileAreMeasuredAsSuch) {
  datasets::Dataset cloud = datasets::generate("georeferenced", 1'000, 1);
  EXPECT_GT(cloud.rounding, 0.1);
  EXPECT_TRUE(task().open(cloud, smoke())->in_double());
  cloud.precise.points.clear();  // as from a file whose coordinates float holds well enough
  EXPECT_FALSE(task().open(cloud, smoke())->in_double());
}

// What the chart of bytes rests on: an index that is said to keep a copy answers as before when the caller's
// points have gone; one that is said not to does not.
TEST(KnnTask, KeepsACopyOfThePointsOrSaysThatItDoesNot) {
  for (const Method& m : Registry<Method>::instance().entries()) {
    const auto asked_twice =
        [&]<class T>(std::unique_ptr<IndexOf<T>> (*build)(const InputOf<T>&, const Knobs&)) {
          std::vector<geometry::Vec<T, 3>> points;
          for (const Vec3f& p : datasets::generate("uniform_cube", 1'000, 1).cloud.points)
            points.push_back(geometry::Vec<T, 3>(p));
          const std::vector<geometry::Vec<T, 3>> queries(points.begin(), points.begin() + 50);
          const auto index = build({points, true, 0.05, 1}, m.info.build_knobs.front());
          const auto answers = [&] {
            std::vector<Id> ids(queries.size() * 8, accel::no_id);
            index->nearest(queries, 8, m.info.query_knobs.back(), 1, ids);
            return ids;
          };
          const auto before = answers();
          std::ranges::reverse(points);
          EXPECT_EQ(answers() != before, m.info.keeps_no_copy) << m.info.name;
        };
    if (m.build) asked_twice(m.build);
    if (m.build_double) asked_twice(m.build_double);
  }
}

TEST(KnnTask, QuickProfileMeasuresTheBestBuildsOnly) {
  for (const Profile profile : {Profile::smoke, Profile::quick, Profile::full}) {
    RunContext context = smoke();
    context.profile = profile;
    const BlockSpec spec{"uniform_cube", 1000};
    std::map<std::size_t, std::set<std::size_t>> measured;
    for (const Cell& cell : cells_of(task(), facts_of(task(), spec, *task().open(spec, context)), 1))
      measured[cell.method].insert(cell.build);
    for (std::size_t m = 0; m < task().methods().size(); ++m) {
      const MethodInfo& info = task().methods()[m];
      const std::size_t most = profile == Profile::quick ? info.quick_builds : SIZE_MAX;
      const bool offered = task().open(spec, context)->offers(m);
      EXPECT_EQ(measured[m].size(), offered ? std::min(most, info.build_knobs.size()) : 0) << info.name;
    }
  }
}

TEST(KnnTask, AnswersDoNotDependOnTheNumberOfThreads) {
  RunContext context = smoke();
  context.profile = Profile::quick;  // 500 queries: several chunks of a batch
  const auto block = task().open({"lidar", 1000}, context);
  for (std::size_t m = 0; m < task().methods().size(); ++m) {
    const MethodInfo& info = task().methods()[m];
    if (!block->offers(m)) continue;
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
  for (const Vec3f& p : q.points[Questions::self])
    within += static_cast<double>(scan.within(p, q.radius).must.size());
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
  EXPECT_EQ(a.points, b.points);
  EXPECT_EQ(a.boxes, b.boxes);
  EXPECT_EQ(a.radius, b.radius);
  for (int place = 0; place < Questions::places; ++place) EXPECT_NE(a.points[place], c.points[place]);
}

TEST(KnnQuestions, SelfQueriesAreDistinctPointsOfTheCloud) {
  const auto cloud = datasets::generate("uniform_ball", 1'000, 3).cloud;
  const Questions q = questions_about(DoubleScan(cloud.points), 1'000, 1, 1);
  const auto by_x = [](const Vec3f& a, const Vec3f& b) {
    return std::lexicographical_compare(a.v, a.v + 3, b.v, b.v + 3);
  };
  std::vector<Vec3f> asked = q.points[Questions::self], points = cloud.points;
  std::sort(asked.begin(), asked.end(), by_x);
  std::sort(points.begin(), points.end(), by_x);
  EXPECT_EQ(asked, points);
  EXPECT_NE(q.points[Questions::self], cloud.points) << "not shuffled";
}

double path_length(const std::vector<Vec3f>& points) {
  double sum = 0;
  for (std::size_t i = 1; i < points.size(); ++i) sum += distance(points[i - 1], points[i]);
  return sum;
}

TEST(KnnQuestions, SortedOnesAreThoseOfTheCloudAlongAShortPath) {
  const auto cloud = datasets::generate("uniform_cube", 20'000, 3).cloud;
  const Questions q = questions_about(DoubleScan(cloud.points), 1'000, 1, 1);
  const auto &self = q.points[Questions::self], &sorted = q.points[Questions::sorted];
  std::set<std::uint32_t> numbers(q.order.begin(), q.order.end());
  ASSERT_EQ(numbers.size(), self.size());
  for (std::size_t i = 0; i < self.size(); ++i) EXPECT_EQ(sorted[i], self[q.order[i]]);
  // A random path through the unit cube takes 0.66 a step; along the curve a step is about a spacing of 0.1.
  EXPECT_LT(path_length(sorted), 0.35 * path_length(self));
}

TEST(KnnQuestions, FarOnesLieTwoToFourDiagonalsAwayOnAllSides) {
  const auto cloud = datasets::generate("lidar", 2'000, 3).cloud;
  const DoubleScan scan(cloud.points);
  const geometry::Box3f box = scan.box();
  const double diagonal = distance(box.low, box.high);
  const Questions q = questions_about(scan, 300, 1, 1);
  std::set<int> octants;
  for (const Vec3f& p : q.points[Questions::far]) {
    const Vec3f from = p - box.centre();
    EXPECT_GT(length(from), 1.999 * diagonal);
    EXPECT_LT(length(from), 4.001 * diagonal);
    octants.insert((from[0] > 0) + 2 * (from[1] > 0) + 4 * (from[2] > 0));
  }
  EXPECT_EQ(octants.size(), 8u);
}

// Two sets that ask the same in another order must be judged by the same truth.
TEST(KnnTask, SortedQueriesHaveTheErrorsOfTheUnsorted) {
  const auto block = task().open({"lidar", 1000}, smoke());
  const auto number = [&](const std::string& name) {
    const auto& sets = block->query_sets();
    const auto at = std::ranges::find(sets, name, &QuerySet::name);
    return static_cast<std::size_t>(at - sets.begin());
  };
  for (std::size_t m = 0; m < task().methods().size(); ++m) {
    const MethodInfo& info = task().methods()[m];
    if (!block->offers(m)) continue;
    const auto subject = block->build(m, info.build_knobs.front(), 1);
    const auto errors = [&](const std::string& set) {
      subject->run(number(set), info.query_knobs.front(), 1);
      return block->check(m, *subject, number(set), info.query_knobs.front());
    };
    const Errors self = errors("knn8_self"), sorted = errors("knn8_sorted");
    EXPECT_NEAR(*self.error, *sorted.error, 1e-12) << info.name;
    EXPECT_EQ(self.max, sorted.max) << info.name;
    EXPECT_EQ(self.extra, sorted.extra) << info.name;
  }
}

TEST(KnnTask, LeavesVisitedAreFewerThanNodesAndHoldThePointsTouched) {
  const auto block = task().open({"uniform_cube", 1000}, smoke());
  for (std::size_t m = 0; m < task().methods().size(); ++m) {
    const MethodInfo& info = task().methods()[m];
    if (!block->offers(m)) continue;
    if (info.source != Source::ours) continue;
    const Knobs& knobs = info.build_knobs.front();
    const auto subject = block->build(m, knobs, 1);
    for (std::size_t set = 0; set < block->query_sets().size(); ++set) {
      subject->run(set, {}, 1);
      const double leaves = block->check(m, *subject, set, {}).extra.at("knn_leaves");
      const auto [nodes, primitives] = *subject->work(set, {});
      EXPECT_GE(leaves, 1) << info.name;
      EXPECT_LE(leaves, nodes) << info.name;
      const double most = info.family == "brute"        ? 1000.0
                          : knobs.contains("leaf_size") ? knobs.at("leaf_size").get<double>()
                                                        : 16.0;  // the wide tree's, always
      EXPECT_LE(primitives, most * leaves) << info.name;
    }
  }
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

TEST(KnnTask, DrawsTheDensityAndEachOfOurTreesAndIndexesTheDrawings) {
  const auto folder = std::filesystem::temp_directory_path() / "treeline_knn_pictures_test";
  std::filesystem::remove_all(folder);
  task().pictures({"uniform_cube", 1000}, smoke(), folder.string());
  std::ifstream index(folder / "pictures.jsonl");
  std::set<std::string> drawn;
  for (std::string line; std::getline(index, line);) {
    const auto entry = nlohmann::json::parse(line);
    drawn.insert(entry.at("method"));
    const bool slice = entry.at("kind") == "slice";
    EXPECT_EQ(entry.at("kind"), slice ? "slice" : "density");
    EXPECT_EQ(entry.at("method") == "", !slice);
    EXPECT_EQ(entry.at("dataset"), "uniform_cube:1000");
    std::ifstream file(folder / entry.at("file").get<std::string>());
    const std::string svg((std::istreambuf_iterator<char>(file)), {});
    EXPECT_EQ(svg.rfind("<svg ", 0), 0u);
    EXPECT_NE(svg.find("<path "), std::string::npos);
    EXPECT_EQ(svg.find("<circle ") != std::string::npos, slice);
    EXPECT_EQ(svg.find("nan"), std::string::npos);
  }
  EXPECT_EQ(drawn, (std::set<std::string>{"", "kd_tree", "bsp_tree", "bsp_spill", "bvh", "bvh_wide"}));
  std::filesystem::remove_all(folder);
}

TEST(KnnPictures, DensityIsThatOfTheCloud) {
  const auto cloud = datasets::generate("uniform_cube", 20'000, 1).cloud;
  const DensityPicture inside = density_picture(cloud.points, DoubleScan(cloud.points).box(), 2, 0.5);
  // The estimate from 16 neighbours varies by some 25 %, over 16,384 squares by four times that.
  EXPECT_GT(inside.most, 20'000);
  EXPECT_LT(inside.most, 100'000);
  EXPECT_GT(inside.least, 2'000);
  EXPECT_LT(inside.least, 20'000);
  std::vector<Vec3f> finer = cloud.points;
  for (Vec3f& p : finer) p = p * 0.5f;
  const DensityPicture half = density_picture(finer, DoubleScan(finer).box(), 2, 0.25);
  EXPECT_NEAR(half.most / inside.most, 8, 1e-3);  // the same points in an eighth of the volume
  EXPECT_EQ(half.svg, inside.svg);                // and so the same picture
}

TEST(KnnPictures, PointsThatCoincideOrLieInAPlaneHaveNoNan) {
  const std::vector<Vec3f> equal(50, Vec3f{1, 2, 3});
  EXPECT_EQ(density_picture(equal, DoubleScan(equal).box(), 0, 1).svg, "");
  std::vector<Vec3f> line;
  for (int i = 0; i < 40; ++i) line.push_back({static_cast<float>(i % 2), 0, 0});
  const DensityPicture picture = density_picture(line, DoubleScan(line).box(), 2, 0);
  EXPECT_TRUE(std::isfinite(picture.least) && std::isfinite(picture.most));
  EXPECT_NE(picture.svg.find("<path "), std::string::npos);
}

}  // namespace
}  // namespace treeline::bench::knn
