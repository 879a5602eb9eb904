// bench_knn as a user runs it: the smoke profile, its rows, and an advice on a file that the suite did not
// make.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <nlohmann/json.hpp>
#include <set>

namespace {

namespace fs = std::filesystem;

class KnnProgram : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / (std::string("treeline_knn_program_") +
                                           testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  int run(const std::string& arguments) const {
    const std::string command =
        std::string(KNN_TEST_PROGRAM) + " " + arguments + " > " + (folder_ / "out.txt").string() + " 2>&1";
    const int status = std::system(command.c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  std::string output() const {
    std::ifstream in(folder_ / "out.txt");
    return {std::istreambuf_iterator<char>(in), {}};
  }
  fs::path folder_;
};

TEST_F(KnnProgram, SmokeProfileWritesValidRowsAndNoneOfOursIsWrong) {
  const fs::path rows = folder_ / "rows.jsonl";
  ASSERT_EQ(run("--profile smoke --rows " + rows.string()), 0) << output();
  std::ifstream in(rows);
  std::set<std::string> keys, methods, sets;
  for (std::string line; std::getline(in, line);) {
    const auto row = nlohmann::json::parse(line);
    const std::string cell = row["block"].dump() + row["method"].dump() + row["build_knobs"].dump() +
                             row["query_knobs"].dump() + row["query_set"].dump();
    EXPECT_TRUE(keys.insert(cell).second) << "twice: " << cell;
    methods.insert(row["method"]), sets.insert(row["query_set"]);
    const std::string status = row["status"];
    if (row["source"] == "ours") {
      EXPECT_EQ(status, "ok") << cell << row["reason"];
    }
    if (status != "ok") {
      EXPECT_TRUE(status == "unsupported" || status == "not_built") << cell << row["reason"];
      EXPECT_TRUE(row["reason"].is_string()) << cell;
      continue;
    }
    EXPECT_GT(row["query_ns"].get<double>(), 0) << cell;
    EXPECT_FALSE(row["samples"].empty()) << cell;
    if (row["claim"] == "exact") {
      EXPECT_LE(row["error_max"].get<double>(), row["error_floor"].get<double>()) << cell;
    }
    if (row["source"] == "ours") {
      EXPECT_GT(row["work_primitives"].get<double>(), 0) << cell;
    }
  }
  EXPECT_EQ(methods.size(), 22u);
  EXPECT_EQ(sets, (std::set<std::string>{"box_self", "knn100_self", "knn1_off", "knn1_self", "knn32_off",
                                         "knn32_self", "knn8_far", "knn8_off", "knn8_self", "knn8_sorted",
                                         "radius_self"}));
}

TEST_F(KnnProgram, AdvisesOnAUsersFile) {
  const fs::path file = folder_ / "mine.xyz";
  std::ofstream out(file);
  for (int i = 0; i < 1500; ++i)
    out << std::sin(0.01 * i) << ' ' << std::cos(0.013 * i) << ' ' << 0.001 * i << '\n';
  out.close();
  ASSERT_EQ(run("--profile smoke --input " + file.string() + " --advise 0"), 0) << output();
  EXPECT_NE(output().find("knn8_off"), std::string::npos) << output();
}

// Of a file that float rounds, the advice says by how much, and measures its doubles where that is too much.
TEST_F(KnnProgram, AdviceSaysWhatRoundingAFileToFloatCosts) {
  const auto write = [&](const char* name, double x, double y) {
    std::ofstream out(folder_ / name);
    out << std::setprecision(12);
    for (int i = 0; i < 1500; ++i)
      out << x + std::sin(0.01 * i) * 50 << ' ' << y + std::cos(0.013 * i) * 50 << ' ' << 0.001 * i << '\n';
    return " --profile smoke --advise 0 --input " + (folder_ / name).string();
  };
  ASSERT_EQ(run(write("near.xyz", 0, 0)), 0) << output();
  EXPECT_NE(output().find("rounded to float, which moved them by up to"), std::string::npos) << output();
  EXPECT_NE(output().find("Points<double, 3>"), std::string::npos) << output();
  ASSERT_EQ(run(write("utm.xyz", 512345, 5403210)), 0) << output();
  EXPECT_NE(output().find("float moves coordinates by up to 0.25"), std::string::npos) << output();
  EXPECT_NE(output().find("_double"), std::string::npos) << output();
}

TEST_F(KnnProgram, NamesAFileThatItCannotRead) {
  ASSERT_EQ(run("--profile smoke --input " + (folder_ / "absent.xyz").string()), 2) << output();
  EXPECT_NE(output().find("absent.xyz"), std::string::npos) << output();
}

}  // namespace
