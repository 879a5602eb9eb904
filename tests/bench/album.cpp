// The index of a task's pictures: which lines stay when some are drawn again.
#include "bench/ray/album.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

namespace treeline::bench::ray {
namespace {

class AlbumTest : public testing::Test {
 protected:
  AlbumTest() { std::filesystem::remove_all(folder_); }
  ~AlbumTest() override { std::filesystem::remove_all(folder_); }

  std::vector<std::string> lines() const {
    std::ifstream in(folder_ / "pictures.jsonl");
    std::vector<std::string> all;
    for (std::string line; std::getline(in, line);) all.push_back(line);
    return all;
  }
  std::filesystem::path folder_ = std::filesystem::temp_directory_path() / "treeline_album_test";
};

TEST_F(AlbumTest, DrawnAgainReplacesOnlyItsOwn) {
  const auto draw = [&](const char* task, const char* dataset, const char* title) {
    Album(task, dataset, folder_.string()).add_file("a.svg", {title, "", "m", "slice"});
  };
  draw("ray", "city", "first"), draw("ray", "city_2", "other"), draw("shadow", "city", "of another task");
  const std::string strange = "{\"task\":\"ray\",\"dataset\":5}", broken = "no line of ours";
  std::ofstream(folder_ / "pictures.jsonl", std::ios::app) << strange << '\n' << broken << '\n';
  draw("ray", "city", "second");
  const auto all = lines();
  ASSERT_EQ(all.size(), 5u);
  std::vector<std::string> titles;
  for (const std::string& line : all)
    if (line != strange && line != broken) titles.push_back(nlohmann::json::parse(line)["title"]);
  EXPECT_EQ(titles, (std::vector<std::string>{"other", "of another task", "second"}));
}

TEST_F(AlbumTest, PanelsAreNamedAndFilesAreNamesOnAnySystem) {
  Album album("shadow", "city, --light disc:0,5,0", folder_.string());
  album.add_file("a.svg", {"t", "c", "m", "strip", 2, {"one", "two"}});
  const auto entry = nlohmann::json::parse(lines().at(0));
  EXPECT_EQ(entry["columns"], 2);
  EXPECT_EQ(entry["panels"], nlohmann::json({"one", "two"}));
  EXPECT_EQ(entry["dataset"], "city, --light disc:0,5,0");
  EXPECT_EQ(entry["file"].get<std::string>().find_first_of(": "), std::string::npos);
}

TEST_F(AlbumTest, NothingIsLostBeforeSomethingIsDrawn) {
  Album("ray", "city", folder_.string()).add_file("a.svg", {"t", "", "m", "slice"});
  const Album again("ray", "city", folder_.string());
  EXPECT_EQ(lines().size(), 1u);
}

TEST(AlbumErrors, FoldersThatCannotBeMadeAreNamed) {
  EXPECT_THROW(Album("ray", "city", "/dev/null/pictures"), std::exception);
}

}  // namespace
}  // namespace treeline::bench::ray
