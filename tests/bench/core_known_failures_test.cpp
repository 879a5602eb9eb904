// The list of known failures is compared in both directions.
#include "core_known_failures.hpp"

#include <gtest/gtest.h>

#include "core_helper.hpp"

namespace treeline::bench {
namespace {

Row row_of(const std::string& method, const std::string& hard_case, Status status,
           Source source = Source::peer) {
  Row row;
  row.task = "knn", row.method = method, row.dataset = hard_case, row.status = status, row.source = source;
  row.query_set = "a";
  return row;
}

const KnownFailures known{{{"knn", "flann", "empty"}, {"crashed", "wrong"}}};

bool has(const std::vector<std::string>& problems, const std::string& start) {
  return problems.size() == 1 && problems[0].starts_with(start);
}

TEST(KnownFailures, AsListedIsNoProblem) {
  EXPECT_TRUE(compare(known, {row_of("flann", "empty", Status::crashed)}, {}).empty());
  EXPECT_TRUE(
      compare(known, {row_of("flann", "empty", Status::wrong), row_of("flann", "empty", Status::ok)}, {})
          .empty());
}

TEST(KnownFailures, NewFailureComesWithItsLine) {
  const std::vector<Row> rows{row_of("flann", "empty", Status::crashed),
                              row_of("pcl", "empty", Status::timeout)};
  EXPECT_TRUE(has(compare(known, rows, {}), "new failure: knn,pcl,empty,timeout,"));
  EXPECT_TRUE(has(compare(known, {row_of("flann", "empty", Status::timeout)}, {}),
                  "new failure: knn,flann,empty,timeout"));
}

TEST(KnownFailures, UnexpectedPass) {
  EXPECT_TRUE(
      has(compare(known, {row_of("flann", "empty", Status::ok)}, {}), "no longer fails: knn,flann,empty"));
  auto flaky = known;
  flaky.begin()->second.insert("ok");
  EXPECT_TRUE(compare(flaky, {row_of("flann", "empty", Status::ok)}, {}).empty());
}

TEST(KnownFailures, AbsentPackagesNeitherPassNorFail) {
  EXPECT_TRUE(compare(known, {row_of("flann", "empty", Status::not_built)}, {}).empty());
}

TEST(KnownFailures, OursCannotBeListed) {
  for (Status status :
       {Status::wrong, Status::crashed, Status::timeout, Status::out_of_memory, Status::refused})
    EXPECT_TRUE(
        has(compare({{{"knn", "kd", "empty"}, {"wrong", "crashed", "timeout", "out_of_memory", "refused"}}},
                    {row_of("kd", "empty", status, Source::ours)}, {}),
            "ours must not fail"));
}

TEST(KnownFailures, RefusingWhereAllowedIsNoFailure) {
  const std::vector<Row> rows{row_of("kd", "nan", Status::refused, Source::ours),
                              row_of("pcl", "nan", Status::refused)};
  EXPECT_TRUE(compare({}, rows, {"nan"}).empty());
  EXPECT_EQ(compare({}, rows, {}).size(), 2u);
}

TEST(KnownFailures, LinesOfNothingAreFound) {
  EXPECT_TRUE(
      has(compare({{{"knn", "flann", "gone"}, {"wrong"}}}, {row_of("flann", "empty", Status::ok)}, {}),
          "no such method or case"));
  EXPECT_TRUE(
      compare({{{"ray", "embree", "x"}, {"wrong"}}}, {row_of("flann", "empty", Status::ok)}, {}).empty());
}

TEST(KnownFailures, FileMustSayWhy) {
  const TemporaryFolder folder;
  const std::string head = "task,method,case,status,why\n";
  const auto with = [&](const std::string& text) {
    std::ofstream(folder / "f.csv") << text;
    return read_known_failures(folder / "f.csv");
  };
  const auto good = with(head + "knn,flann,empty,crashed|ok,\"reads points[0], \"\"always\"\"\"\n");
  EXPECT_EQ(good.begin()->second, (std::set<std::string>{"crashed", "ok"}));
  EXPECT_THROW(with(head + "knn,flann,empty,crashed,\n"), std::invalid_argument);
  EXPECT_THROW(with(head + "knn,flann,empty,broken,why\n"), std::invalid_argument);
  EXPECT_THROW(with(head + "knn,flann,empty,crashed\n"), std::invalid_argument);
  EXPECT_THROW(with(head + "knn,f,e,wrong,x\nknn,f,e,wrong,y\n"), std::invalid_argument);
  EXPECT_THROW(with("knn,f,e,wrong,x\n"), std::invalid_argument);
  EXPECT_EQ(split_csv(quoted_csv("a \"b\", c")), std::vector<std::string>{"a \"b\", c"});
}

}  // namespace
}  // namespace treeline::bench
