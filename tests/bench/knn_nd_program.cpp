// bench_knn_nd as a user runs it: the smoke profile, its rows, and an advice on a file of points.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

namespace {

namespace fs = std::filesystem;

class KnnNdProgram : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / (std::string("treeline_knn_nd_") +
                                           testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  int run(const std::string& arguments) const {
    const std::string command =
        std::string(KNN_ND_TEST_PROGRAM) + " " + arguments + " > " + (folder_ / "out.txt").string() + " 2>&1";
    const int status = std::system(command.c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  std::string output() const {
    std::ifstream in(folder_ / "out.txt");
    return {std::istreambuf_iterator<char>(in), {}};
  }
  fs::path folder_;
};

TEST_F(KnnNdProgram, SmokeProfileWritesValidRowsAndNoneOfOursIsWrong) {
  const fs::path rows = folder_ / "rows.jsonl";
  ASSERT_EQ(run("--profile smoke --rows " + rows.string()), 0) << output();
  std::ifstream in(rows);
  std::set<std::string> keys, sets;
  for (std::string line; std::getline(in, line);) {
    const auto row = nlohmann::json::parse(line);
    const std::string cell = row["block"].dump() + row["method"].dump() + row["build_knobs"].dump() +
                             row["query_knobs"].dump() + row["query_set"].dump();
    EXPECT_TRUE(keys.insert(cell).second) << "twice: " << cell;
    sets.insert(row["query_set"]);
    if (row["status"] == "not_built") continue;
    EXPECT_EQ(row["status"], "ok") << cell << row["reason"];
    EXPECT_GT(row["query_ns"].get<double>(), 0) << cell;
    const double error = row["error"].get<double>();
    EXPECT_TRUE(error >= 0 && error <= 1) << cell;
    EXPECT_DOUBLE_EQ(row["knn_nd_recall"].get<double>(), 1 - error) << cell;
    if (row["claim"] == "exact") {
      EXPECT_EQ(error, 0) << cell;
    }
  }
  EXPECT_EQ(sets, (std::set<std::string>{"knn1", "knn10", "knn100"}));
}

TEST_F(KnnNdProgram, AdvisesOnAUsersFile) {
  const fs::path file = folder_ / "mine.xyz";
  std::ofstream out(file);
  for (int i = 0; i < 1500; ++i)
    out << std::sin(0.01 * i) << ' ' << std::cos(0.013 * i) << ' ' << 0.001 * i << '\n';
  out.close();
  ASSERT_EQ(run("--profile smoke --input " + file.string() + " --advise 0.05"), 0) << output();
  EXPECT_NE(output().find("Advice for a tolerance of 0.05"), std::string::npos) << output();
}

}  // namespace
