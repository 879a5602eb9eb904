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
  RowFile file(folder / "rows", false);
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
    RowFile file(folder / "rows", true);
    EXPECT_NE(file.finished(row_named("a").key()), nullptr);
    EXPECT_EQ(file.finished(row_named("b").key()), nullptr);
    file.add(row_named("c"));
  }
  const auto rows = read_rows(folder / "rows");
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0]["method"], "a");
  EXPECT_EQ(rows[1]["method"], "c");
}

TEST(RowFile, WholeRowWithoutItsLineEndIsTornToo) {
  const TemporaryFolder folder;
  std::ofstream(folder / "rows") << row_named("a").to_line();
  { RowFile(folder / "rows", true).add(row_named("c")); }
  EXPECT_EQ(read_rows(folder / "rows").size(), 1u);
}

TEST(RowFile, ForeignFilesAreRefusedAndLeftAlone) {
  const TemporaryFolder folder;
  const std::string text = row_named("a").to_line() + "\nmy shopping list\n{\"x\":";
  std::ofstream(folder / "rows") << text;
  try {
    RowFile file(folder / "rows", true);
    FAIL() << "was taken";
  } catch (const UsageError& e) {
    EXPECT_NE(std::string(e.what()).find("line 2"), std::string::npos) << e.what();
  }
  EXPECT_EQ(read_text(folder / "rows"), text);
}

TEST(RowFile, OnlyResumeContinuesAFile) {
  const TemporaryFolder folder;
  std::ofstream(folder / "rows") << row_named("a").to_line() << "\n";
  EXPECT_THROW(RowFile(folder / "rows", false), UsageError);
  EXPECT_NO_THROW(RowFile(folder / "rows", true));
  std::ofstream(folder / "empty");
  EXPECT_NO_THROW(RowFile(folder / "empty", false));
}

TEST(RowFile, TwoWritersAtOnceAreOneTooMany) {
  const TemporaryFolder folder;
  RowFile first(folder / "rows", true);
  EXPECT_THROW(RowFile(folder / "rows", true), UsageError);
}

}  // namespace
}  // namespace treeline::bench
