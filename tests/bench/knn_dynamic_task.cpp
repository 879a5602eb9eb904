// The task knn_dynamic: the lives of its clouds, every method through them, and answers that its judge must
// not let pass.
#include "bench/knn_dynamic/task.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "bench/knn_dynamic/block.hpp"
#include "bench/knn_dynamic/life.hpp"

namespace treeline::bench::knn_dynamic {
namespace {

const KnnDynamicTask& task() {
  static const KnnDynamicTask t;
  return t;
}

RunContext smoke() { return {.profile = Profile::smoke, .seed = 1, .threads = 1, .truth_cache = ""}; }

TEST(Life, AllComeInOrderAndAsManyGoAsComeOnceHalfAreThere) {
  for (const Goes goes : {Goes::oldest, Goes::random})
    for (const std::size_t pool : {2u, 3u, 100u, 101u, 1000u})
      for (const std::size_t batch : {1u, 2u, 7u, 50u}) {
        const std::size_t half = pool - pool / 2;
        if (batch > half) continue;
        const Life life = life_of(pool, batch, goes, 5);
        std::set<Id> there;
        Id next = 0;
        for (std::size_t s = 0; s < life.steps.size(); ++s) {
          for (const Id id : life.gone_in(s))
            ASSERT_EQ(there.erase(id), 1u) << id << " goes, but is not there";
          ASSERT_EQ(life.steps[s].first, next);
          for (; next < life.steps[s].last; ++next) there.insert(next);
          ASSERT_EQ(there.size(), std::min<std::size_t>(next, half)) << pool << " in batches of " << batch;
          if (goes == Goes::oldest) {
            ASSERT_EQ(*there.begin(), next - there.size());
          }
          const std::vector<bool> told = life.there(s + 1, pool);
          for (Id id = 0; id < pool; ++id) ASSERT_EQ(told[id], there.contains(id));
        }
        EXPECT_EQ(next, pool);
        EXPECT_EQ(life.changes(), pool + pool - half);
      }
}

TEST(Life, RandomOnesGoTheSameEveryTimeAndNotTheOldest) {
  const Life a = life_of(1000, 50, Goes::random, 5), b = life_of(1000, 50, Goes::random, 5);
  EXPECT_EQ(a.gone, b.gone);
  EXPECT_NE(a.gone, life_of(1000, 50, Goes::random, 6).gone);
  EXPECT_NE(a.gone, life_of(1000, 50, Goes::oldest, 5).gone);
}

TEST(KnnDynamicTask, EveryMethodIsBuiltOrNamedAsNotBuilt) {
  std::multiset<std::string> names;
  for (const MethodInfo& m : task().methods()) names.insert(m.name);
  for (const auto& [method, package] : task().not_built()) names.insert(method);
  EXPECT_EQ(names, (std::multiset<std::string>{"brute", "forest_bvh_wide", "nanoflann_dynamic",
                                               "rebuilt_bvh_wide", "rebuilt_nanoflann"}));
}

TEST(KnnDynamicTask, EveryMethodIsRightThroughEveryLifeTwiceOver) {
  const auto block = task().open({"lidar", 1000}, smoke());
  const auto& sets = block->query_sets();
  ASSERT_EQ(sets.size(), 7u);
  for (std::size_t m = 0; m < task().methods().size(); ++m)
    for (const Knobs& knobs : task().methods()[m].build_knobs) {
      const auto subject = block->build(m, knobs, 1);
      for (int time = 0; time < 2; ++time)  // repetitions start from nothing, whatever was run before
        for (std::size_t q = 0; q < sets.size(); ++q) {
          const std::string what = task().methods()[m].name + " " + sets[q].name;
          try {
            subject->run(q, Knobs::object(), 1 + time);
          } catch (const Unsupported&) {
            EXPECT_TRUE(sets[q].name == "single" || task().methods()[m].family == "brute") << what;
            continue;
          }
          const Errors e = block->check(m, *subject, q, Knobs::object());
          EXPECT_TRUE(e.within_claim) << what << ": " << e.reason;
          EXPECT_LE(e.error.value(), e.floor.value()) << what;
          EXPECT_EQ(e.extra.at("knn_dynamic_recall").get<double>(), 1) << what;
          EXPECT_GE(e.extra.at("knn_dynamic_checked").get<int>(), 100) << what;
          const bool all_loose = knobs.value("block", 0) >= 1000;  // the whole cloud waits in one block
          EXPECT_GE(e.extra.at("knn_dynamic_trees").get<int>(), all_loose ? 0 : 1) << what;
        }
    }
}

TEST(KnnDynamicTask, OperationsAreWhatComesGoesAndIsAsked) {
  const auto block = task().open({"uniform_cube", 1000}, smoke());
  for (const QuerySet& set : block->query_sets()) {
    if (set.name == "knn8_after") continue;
    // In asked16 2000 come, 1000 go, 2000 are asked for.
    EXPECT_EQ(set.size, set.name == "asked16" ? 5000u : 3000u) << set.name;
  }
  EXPECT_EQ(block->n(), 1000u);
}

// An index that is right but for one fault, by brute force over the points that it thinks are there.
enum class Fault { none, keeps_what_goes, forgets_the_last_to_come, mistakes_one };

template <Fault fault>
class Faulty final : public Index {
 public:
  explicit Faulty(std::span<const Vec3f> pool) : pool_(pool) {}

  void change(std::span<const Id> gone, Id first, Id last) override {
    if (fault != Fault::keeps_what_goes)
      for (const Id id : gone) there_.erase(id);
    for (Id id = first; id < last; ++id)
      if (fault != Fault::forgets_the_last_to_come || id + 20 < pool_.size()) there_.insert(id);
  }
  void nearest(std::span<const Vec3f> queries, std::size_t k, int, std::span<Id> ids) const override {
    for (std::size_t q = 0; q < queries.size(); ++q) {
      std::vector<std::pair<double, Id>> all;
      for (const Id id : there_)
        all.emplace_back(geometry::distance(geometry::Vec3d(pool_[id]), geometry::Vec3d(queries[q])), id);
      std::sort(all.begin(), all.end());
      for (std::size_t i = 0; i < std::min(k, all.size()); ++i) ids[q * k + i] = all[i].second;
      if (fault == Fault::mistakes_one) ids[q * k] = all.back().second;
    }
  }

 private:
  std::span<const Vec3f> pool_;
  std::set<Id> there_;
};

template <Fault fault>
Method faulty() {
  return {.info = {.name = "faulty", .family = "brute"},
          .make = [](const Input& input, const Knobs&) -> std::unique_ptr<Index> {
            return std::make_unique<Faulty<fault>>(input.pool);
          }};
}

std::set<std::string> sets_found_wrong(const Method& method) {
  const std::vector<Method> methods{method};
  const auto block = open_block(methods, datasets::generate("uniform_cube", 1000, 3), smoke());
  const auto subject = block->build(0, Knobs::object(), 1);
  std::set<std::string> wrong;
  for (std::size_t q = 0; q < block->query_sets().size(); ++q) {
    subject->run(q, Knobs::object(), 1);
    if (!block->check(0, *subject, q, Knobs::object()).within_claim)
      wrong.insert(block->query_sets()[q].name);
  }
  return wrong;
}

TEST(KnnDynamicTask, FaultsAreFound) {
  const std::set<std::string> all{"single",   "batches128", "batches16", "batches4",
                                  "random16", "asked16",    "knn8_after"};
  EXPECT_EQ(sets_found_wrong(faulty<Fault::none>()), std::set<std::string>{});
  EXPECT_EQ(sets_found_wrong(faulty<Fault::mistakes_one>()), all);
  EXPECT_EQ(sets_found_wrong(faulty<Fault::keeps_what_goes>()), all);
  const auto last = sets_found_wrong(faulty<Fault::forgets_the_last_to_come>());
  EXPECT_TRUE(last.contains("asked16")) << "newcomers are asked for at the last moment, too";
}

TEST(KnnDynamicTask, PoolsThatCannotComeAndGoAreRefused) {
  datasets::Dataset few;
  few.cloud.points.resize(20);
  EXPECT_THROW(task().open(few, smoke()), std::invalid_argument);
  datasets::Dataset odd = datasets::generate("uniform_cube", 1000, 1);
  odd.cloud.points[17][1] = std::nanf("");
  try {
    task().open(odd, smoke());
    FAIL();
  } catch (const std::invalid_argument& e) {
    EXPECT_NE(std::string(e.what()).find("17"), std::string::npos) << e.what();
  }
}

TEST(KnnDynamicTask, AMeshIsTheCloudOfItsVertices) {
  const auto block = task().open(datasets::generate("icosphere", 2000, 1), smoke());
  EXPECT_GT(block->n(), 400u);
}

TEST(KnnDynamicProgram, SmokeProfileEndsWellAndWritesBatches) {
  const auto folder = std::filesystem::temp_directory_path() / "treeline_knn_dynamic_program";
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  const std::string rows = (folder / "rows").string();
  const std::string command =
      std::string(KNN_DYNAMIC_TEST_PROGRAM) + " --profile smoke --rows " + rows + " >/dev/null 2>&1";
  EXPECT_EQ(std::system(command.c_str()), 0);
  std::ifstream in(rows);
  std::set<double> batches;
  for (std::string line; std::getline(in, line);) {
    const auto row = nlohmann::json::parse(line);
    EXPECT_TRUE(row["status"] == "ok" || row["status"] == "unsupported" || row["status"] == "not_built")
        << line;
    if (row["method"] == "forest_bvh_wide" && row["knn_dynamic_batch"].is_number())
      batches.insert(row["knn_dynamic_batch"].get<double>());
  }
  EXPECT_EQ(batches, (std::set<double>{1, 7, 62, 250}));
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace treeline::bench::knn_dynamic
