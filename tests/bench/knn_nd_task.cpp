// The task knn_nd as a whole: its registry, its blocks, and every method on small ones.
#include "bench/knn_nd/task.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "bench/knn_nd/truth.hpp"
#include "datasets_gen/hard/hard_rows.hpp"

namespace treeline::bench::knn_nd {
namespace {

const KnnNdTask& task() {
  static const KnnNdTask t;
  return t;
}

RunContext smoke() { return {.profile = Profile::smoke, .seed = 1, .threads = 1, .truth_cache = ""}; }

TEST(KnnNdTask, EveryMethodIsBuiltOrNamedAsNotBuilt) {
  std::multiset<std::string> names;
  for (const MethodInfo& m : task().methods()) names.insert(m.name);
  for (const auto& [method, package] : task().not_built()) {
    names.insert(method);
    EXPECT_FALSE(package.empty()) << method;
  }
  EXPECT_EQ(names, (std::multiset<std::string>{"brute", "bsp_tree", "bsp_tree_eps", "bsp_tree_visits",
                                               "flann_forest", "flann_kmeans", "flann_linear", "flann_single",
                                               "kd_forest", "kd_tree", "kd_tree_eps", "kd_tree_visits",
                                               "rp_forest", "spill_tree"}));
}

TEST(KnnNdTask, KnobsAreFlatObjectsAndPeersNameTheirVersion) {
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

TEST(KnnNdTask, ProfilesNameRecipesOfVectorsAndAdviceNamesSetsThatExist) {
  for (const Profile profile : {Profile::smoke, Profile::quick, Profile::full}) {
    std::set<std::string> labels;
    for (const BlockSpec& spec : task().blocks(profile)) {
      EXPECT_TRUE(labels.insert(spec.label()).second) << spec.label() << " twice";
      const auto recipes = datasets::recipes();
      EXPECT_TRUE(std::any_of(recipes.begin(), recipes.end(), [&](const datasets::Recipe& r) {
        return r.name == spec.dataset && r.kind == datasets::Kind::vectors;
      })) << spec.dataset;
    }
    EXPECT_FALSE(labels.empty());
    RunContext context = smoke();
    context.profile = profile;
    const auto block = task().open({"uniform_8", 1000}, context);
    EXPECT_EQ(block->n(), 1000u);
    for (const std::string& name : task().advise_on())
      EXPECT_TRUE(std::ranges::any_of(block->query_sets(), [&](const QuerySet& s) { return s.name == name; }))
          << name;
  }
}

// Every method with every knob on every query set: none misses its claim; exact ones find everything.
TEST(KnnNdTask, EveryMethodKeepsItsClaimOnSmallBlocks) {
  for (const BlockSpec& spec : task().blocks(Profile::smoke)) {
    const auto block = task().open(spec, smoke());
    ASSERT_EQ(block->query_sets().size(), 3u);
    for (std::size_t m = 0; m < task().methods().size(); ++m) {
      const MethodInfo& info = task().methods()[m];
      for (const Knobs& build_knobs : info.build_knobs) {
        const auto subject = block->build(m, build_knobs, 1);
        for (std::size_t q = 0; q < block->query_sets().size(); ++q)
          for (const Knobs& query_knobs : info.query_knobs) {
            const std::string cell = spec.label() + " " + info.name + " " + build_knobs.dump() + " " +
                                     query_knobs.dump() + " " + block->query_sets()[q].name;
            subject->run(q, query_knobs, 1);
            const Errors errors = block->check(m, *subject, q, query_knobs);
            EXPECT_TRUE(errors.within_claim) << cell << ": " << errors.reason;
            ASSERT_TRUE(errors.error.has_value()) << cell;
            if (info.claim == Claim::exact) {
              EXPECT_EQ(*errors.error, 0) << cell;
            }
            if (info.claim == Claim::bounded) {
              EXPECT_LE(errors.extra["knn_nd_excess_max"].get<double>(),
                        query_knobs["epsilon"].get<double>() + 1e-4)
                  << cell;
            }
            EXPECT_EQ(info.source == Source::ours, subject->work(q, query_knobs).has_value()) << cell;
          }
      }
    }
  }
}

TEST(KnnNdTask, AnswersDoNotDependOnTheNumberOfThreads) {
  RunContext context = smoke();
  context.profile = Profile::full;  // 1000 queries: several chunks of a batch
  const auto block = task().open({"descriptors_8", 1000}, context);
  for (std::size_t m = 0; m < task().methods().size(); ++m) {
    const MethodInfo& info = task().methods()[m];
    const auto subject = block->build(m, info.build_knobs.front(), 1);
    subject->run(1, info.query_knobs.front(), 1);
    const Errors one = block->check(m, *subject, 1, info.query_knobs.front());
    subject->run(1, info.query_knobs.front(), 2);
    const Errors two = block->check(m, *subject, 1, info.query_knobs.front());
    EXPECT_EQ(one.error, two.error) << info.name;
    EXPECT_EQ(one.bias, two.bias) << info.name;
  }
}

// Queries are held out, so that no distance is 0.
TEST(KnnNdTask, QueriesAreNotInTheIndex) {
  for (const bool file : {false, true}) {
    const auto block = file ? task().open(datasets::generate("uniform_cube", 1000, 1), smoke())
                            : task().open({"uniform_8", 1000}, smoke());
    EXPECT_EQ(block->n(), file ? 950u : 1000u);
    const auto subject = block->build(0, Knobs::object(), 1);
    subject->run(0, Knobs::object(), 1);
    EXPECT_EQ(block->check(0, *subject, 0, Knobs::object()).error, 0);
    EXPECT_EQ(block->query_sets()[0].size, 50u);
  }
}

TEST(KnnNdTask, TakesTheFinitePointsOfACloudAndTheVerticesOfAMesh) {
  datasets::Dataset cloud = datasets::generate("uniform_cube", 1000, 1);
  for (std::size_t i = 0; i < 990; ++i) cloud.cloud.points[i][1] = NAN;
  EXPECT_EQ(task().open(cloud, smoke())->query_sets()[0].size, 1u);
  for (auto& p : cloud.cloud.points) p[1] = NAN;
  EXPECT_THROW(task().open(cloud, smoke()), std::invalid_argument);
  const datasets::Dataset mesh = datasets::generate("icosphere", 1000, 1);
  const std::size_t vertices = mesh.mesh.vertices.size();
  EXPECT_EQ(task().open(mesh, smoke())->n(), vertices - std::min<std::size_t>(50, vertices / 10));
  EXPECT_THROW(task().open(BlockSpec{"icosphere", 1000}, smoke()), std::invalid_argument);
}

// Two independent truths: in double, and in whole numbers, on rows of multiples of 1/1024.
TEST(KnnNdTruth, AgreesWithWholeNumbers) {
  for (const std::size_t d : {1, 7, 32, 50}) {
    datasets::Vectors rows, queries;
    rows.columns = queries.columns = d;
    std::uint64_t state = d;
    const auto fill = [&](datasets::Vectors& v, std::size_t n) {
      for (std::size_t i = 0; i < n * d; ++i) {
        state = state * 6364136223846793005ull + 1442695040888963407ull;
        v.scalars.push_back(static_cast<float>(static_cast<std::int64_t>(state >> 50) - 8192) / 1024);
      }
    };
    fill(rows, 400), fill(queries, 20);
    rows.scalars[17 * d] = std::numeric_limits<float>::infinity();
    const RowsView p(rows.scalars.data(), 400, d), q(queries.scalars.data(), 20, d);
    for (const int threads : {1, 2}) {
      const Truth truth = truth_of(p, q, 500, threads);
      ASSERT_EQ(truth.k, 399u);
      for (std::size_t i = 0; i < q.rows; ++i) {
        std::vector<std::int64_t> whole;
        for (std::size_t j = 0; j < p.rows; ++j) {
          if (j == 17) continue;
          std::int64_t sum = 0;
          for (std::size_t a = 0; a < d; ++a) {
            const auto e = static_cast<std::int64_t>(1024 * (p[j][a] - q[i][a]));  // floats hold it exactly
            sum += e * e;
          }
          whole.push_back(sum);
        }
        std::sort(whole.begin(), whole.end());
        for (std::size_t j = 0; j < truth.k; ++j)
          ASSERT_DOUBLE_EQ(truth.row(i)[j], std::sqrt(static_cast<double>(whole[j])) / 1024);
      }
      const Truth again = truth_from_bytes(to_bytes(truth), 20);
      EXPECT_EQ(again.distances, truth.distances);
      EXPECT_EQ(again.answerable, truth.answerable);
      EXPECT_THROW(truth_from_bytes(to_bytes(truth), 21), std::invalid_argument);
      EXPECT_THROW(truth_from_bytes(to_bytes(truth).substr(0, 7), 20), std::invalid_argument);
    }
  }
}

}  // namespace
}  // namespace treeline::bench::knn_nd
