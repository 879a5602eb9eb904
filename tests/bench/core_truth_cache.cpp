// A cache may forget, but never lie.
#include "bench/core/truth_cache.hpp"

#include <gtest/gtest.h>

#include "core_helper.hpp"

namespace treeline::bench {
namespace {

const TruthKey key{"fake", 1, 0xabc, 0xdef};
const std::vector<double> truth{1.0, -2.5, 1e300};

std::string only_file(const std::string& folder) {
  std::string out;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) out = entry.path().string();
  return out;
}

TEST(TruthCache, GivesBackWhatWasStoredUnderTheSameKeyOnly) {
  const TemporaryFolder folder;
  const std::string cache = folder / "deep/down";
  EXPECT_FALSE(load_truth_as<double>(cache, key));
  ASSERT_TRUE(store_truth(cache, key, truth));
  EXPECT_EQ(load_truth_as<double>(cache, key), truth);
  for (const TruthKey& other : {TruthKey{"fake", 2, 0xabc, 0xdef}, TruthKey{"fake", 1, 0xabd, 0xdef},
                                TruthKey{"fake", 1, 0xabc, 0xdee}, TruthKey{"other", 1, 0xabc, 0xdef}})
    EXPECT_FALSE(load_truth_as<double>(cache, other));
}

TEST(TruthCache, EmptyTruthIsATruth) {
  const TemporaryFolder folder;
  ASSERT_TRUE(store_truth(folder / "", key, std::vector<double>{}));
  EXPECT_EQ(load_truth_as<double>(folder / "", key), std::vector<double>{});
}

TEST(TruthCache, AnyDamageCountsAsAbsent) {
  const TemporaryFolder folder;
  const std::string cache = folder / "c";
  ASSERT_TRUE(store_truth(cache, key, truth));
  const std::string path = only_file(cache), whole = read_text(path);
  for (std::size_t i = 0; i < whole.size(); ++i) {  // one byte changed
    std::string damaged = whole;
    damaged[i] = static_cast<char>(damaged[i] ^ 0x20);
    std::ofstream(path, std::ios::binary) << damaged;
    EXPECT_FALSE(load_truth(cache, key)) << "byte " << i;
  }
  for (std::size_t size = 0; size < whole.size(); ++size) {  // cut short
    std::ofstream(path, std::ios::binary) << whole.substr(0, size);
    EXPECT_FALSE(load_truth(cache, key)) << size << " bytes";
  }
  std::ofstream(path, std::ios::binary) << whole << "x";
  EXPECT_FALSE(load_truth(cache, key));
  std::ofstream(path, std::ios::binary) << whole;
  EXPECT_EQ(load_truth_as<double>(cache, key), truth);
}

TEST(TruthCache, UnwritableFolderIsNoError) {
  EXPECT_FALSE(store_truth("/proc/nowhere", key, truth));
  EXPECT_FALSE(store_truth("", key, truth));
  EXPECT_FALSE(load_truth("", key));
}

TEST(TruthCache, LeavesNothingBeside) {
  const TemporaryFolder folder;
  ASSERT_TRUE(store_truth(folder / "c", key, truth));
  ASSERT_TRUE(store_truth(folder / "c", key, truth));
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder / "c")) (void)entry, ++files;
  EXPECT_EQ(files, 1);
}

}  // namespace
}  // namespace treeline::bench
