// The file of rows: nothing lost, nothing overwritten, nothing half read.
#include <gtest/gtest.h>

#include "bench/core/options.hpp"
#include "bench/core/row_file.hpp"
#include "core_helper.hpp"

namespace treeline::bench {
namespace {

Row row_named(const std::string& method) {
  Row row;
  row.task = "fake", row.method = method;
  return row;
}

TEST(RowFile, RowsAreOnDiskWhenAddReturns) {
  const TemporaryFolder folder;
  RowFile file(folder / "rows", false, "fake");
  file.add(row_named("a"));
  file.add(row_named("b"));
  const auto rows = read_rows(folder / "rows");
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[1]["method"], "b");
}

TEST(RowFile, TornLastLineIsCutOffAndTheRestIsFinished) {
  const TemporaryFolder folder;
  std::ofstream(folder / "rows") << row_named("a").to_line() << "\n"
                                 << row_named("b").to_line().substr(0, 40);
  {
    RowFile file(folder / "rows", true, "fake");
    EXPECT_NE(file.finished(row_named("a")), nullptr);
    EXPECT_EQ(file.finished(row_named("b")), nullptr);
    file.add(row_named("c"));
  }
  const auto rows = read_rows(folder / "rows");
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0]["method"], "a");
  EXPECT_EQ(rows[1]["method"], "c");
}

TEST(RowFile, WholeRowWithoutItsLineEndIsKept) {
  const TemporaryFolder folder;
  std::ofstream(folder / "rows") << row_named("a").to_line();
  {
    RowFile file(folder / "rows", true, "fake");
    EXPECT_NE(file.finished(row_named("a")), nullptr);
    file.add(row_named("c"));
  }
  const auto rows = read_rows(folder / "rows");
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0]["method"], "a");
  EXPECT_EQ(rows[1]["method"], "c");
}

std::string line_of(const std::string& method, const std::string& field, const std::string& value) {
  Json row = Json::parse(row_named(method).to_line());
  row[field] = value;
  return row.dump() + "\n";
}

TEST(RowFile, RowsOfAnotherMachineAreRefusedAndLeftAlone) {
  for (const std::string field : {"host", "cpu", "isa"}) {
    const TemporaryFolder folder;
    const std::string before = line_of("a", "time", "earlier") + line_of("b", field, "of yesteryear");
    std::ofstream(folder / "rows") << before;
    try {
      RowFile file(folder / "rows", true, "fake");
      FAIL() << field;
    } catch (const UsageError& e) {
      for (const std::string& word : {std::string("line 2"), field, std::string("of yesteryear")})
        EXPECT_NE(std::string(e.what()).find(word), std::string::npos) << e.what();
    }
    EXPECT_EQ(read_text(folder / "rows"), before);
  }
}

TEST(RowFile, RowsOfAnotherBuildAreContinuedButTold) {
  for (const std::string field : {"commit", "compiler", "flags"}) {
    const TemporaryFolder folder;
    std::ofstream(folder / "rows") << line_of("a", field, "of yesteryear");
    const RowFile file(folder / "rows", true, "fake");
    EXPECT_NE(file.finished(row_named("a")), nullptr);
    EXPECT_NE(file.other_build().find(field + " 'of yesteryear'"), std::string::npos) << file.other_build();
  }
  const TemporaryFolder folder;
  std::ofstream(folder / "rows") << row_named("a").to_line() << "\n";
  EXPECT_EQ(RowFile(folder / "rows", true, "fake").other_build(), "");
}

TEST(RowFile, ForeignTextWithoutALineEndIsRefusedAndLeftAlone) {
  const TemporaryFolder folder;
  for (const std::string text :
       {"{\"a\":1}", "{\"a\":", "precious", "7", "{\"schema\":1}", "{\"schema\":\"https://", " "}) {
    std::ofstream(folder / "rows") << text;
    EXPECT_THROW(RowFile(folder / "rows", true, "fake"), UsageError) << text;
    EXPECT_EQ(read_text(folder / "rows"), text);
  }
  for (const std::string torn : {"{", "{\"schema\"", "{\"schema\":1,\"task\":\"fake\",\"blo"}) {
    std::ofstream(folder / "rows") << torn;
    EXPECT_NO_THROW(RowFile(folder / "rows", true, "fake")) << torn;
    EXPECT_EQ(read_text(folder / "rows"), "") << torn;
  }
}

TEST(RowFile, RowsOfAnotherTaskAreRefused) {
  const TemporaryFolder folder;
  Row other = row_named("b");
  other.task = "other";
  for (const std::string end : {"\n", ""}) {
    const std::string text = row_named("a").to_line() + "\n" + other.to_line() + end;
    std::ofstream(folder / "rows") << text;
    try {
      RowFile file(folder / "rows", true, "fake");
      FAIL() << "was taken";
    } catch (const UsageError& e) {
      EXPECT_NE(std::string(e.what()).find("line 2"), std::string::npos) << e.what();
    }
    EXPECT_EQ(read_text(folder / "rows"), text);
  }
  EXPECT_EQ(run_fake("--resume --rows " + (folder / "rows")).status, 2);
}

TEST(RowFile, WhatWasNotBuiltIsNotFinishedOnceItIs) {
  const TemporaryFolder folder;
  Row row = row_named("a");
  row.status = Status::not_built;
  std::ofstream(folder / "rows") << row.to_line() << "\n";
  RowFile file(folder / "rows", true, "fake");
  EXPECT_NE(file.finished(row), nullptr);
  EXPECT_EQ(file.finished(row_named("a")), nullptr);
}

TEST(RowFile, ForeignFilesAreRefusedAndLeftAlone) {
  const TemporaryFolder folder;
  const std::string text = row_named("a").to_line() + "\nmy shopping list\n{\"x\":";
  std::ofstream(folder / "rows") << text;
  try {
    RowFile file(folder / "rows", true, "fake");
    FAIL() << "was taken";
  } catch (const UsageError& e) {
    EXPECT_NE(std::string(e.what()).find("line 2"), std::string::npos) << e.what();
  }
  EXPECT_EQ(read_text(folder / "rows"), text);
}

TEST(RowFile, OnlyResumeContinuesAFile) {
  const TemporaryFolder folder;
  std::ofstream(folder / "rows") << row_named("a").to_line() << "\n";
  EXPECT_THROW(RowFile(folder / "rows", false, "fake"), UsageError);
  EXPECT_NO_THROW(RowFile(folder / "rows", true, "fake"));
  std::ofstream(folder / "empty");
  EXPECT_NO_THROW(RowFile(folder / "empty", false, "fake"));
}

TEST(RowFile, TwoWritersAtOnceAreOneTooMany) {
  const TemporaryFolder folder;
  RowFile first(folder / "rows", true, "fake");
  EXPECT_THROW(RowFile(folder / "rows", true, "fake"), UsageError);
}

}  // namespace
}  // namespace treeline::bench
