// Thousands of spoiled files of each format, the same ones in every run: each is refused by a FileError or
// read as a dataset that holds together. The same promise as under libFuzzer (tests/fuzz), for compilers
// without it.
#include "datasets_gen/portable.hpp"
#include "files_common.hpp"
#include "tests/fuzz/must_be_valid.hpp"
#include "tests/fuzz/seeds.hpp"

namespace treeline::datasets {
namespace {

/// Numbers at which readers break.
constexpr std::string_view odd_numbers[] = {
    "-1",  "0", "4294967295", "4294967296",           "4000000000", "-5",  "1e39",
    "nan", "",  "2147483648", "99999999999999999999", "1e-400",     "0x10"};
constexpr std::uint32_t odd_words[] = {0, 1, 0x7fffffff, 0x80000000, 0xffffffff, 0x7fc00000, 0x00010000};

/// A piece of [0, size), at most so long.
std::pair<std::size_t, std::size_t> piece(Draws& draws, std::size_t size, std::size_t longest) {
  const std::size_t at = draws.below(size), length = 1 + draws.below(std::min(longest, size - at));
  return {at, length};
}

std::string spoiled(const std::vector<SeedFile>& seeds, std::size_t seed, Draws& draws) {
  std::string s = seeds[seed].bytes;
  for (std::uint64_t changes = 1 + draws.below(3); changes > 0 && !s.empty(); --changes) {
    const auto [at, length] = piece(draws, s.size(), 40);
    switch (draws.below(8)) {
      case 0:
        s[at] = static_cast<char>(draws.below(256));
        break;
      case 1:
        s.resize(at);
        break;
      case 2:
        s.erase(at, length);
        break;
      case 3:
        s.insert(at, s.substr(at, length));
        break;
      case 4: {  // four bytes
        const std::string word = bytes_of(odd_words[draws.below(std::size(odd_words))]);
        s.replace(at, std::min<std::size_t>(4, s.size() - at), word);
        break;
      }
      case 5: {  // a number of the text
        const std::size_t digit = s.find_first_of("0123456789", at);
        if (digit == std::string::npos) break;
        const std::size_t end = std::min(s.find_first_not_of("0123456789.e", digit), s.size());
        s.replace(digit, end - digit, odd_numbers[draws.below(std::size(odd_numbers))]);
        break;
      }
      case 6: {  // a piece of another file
        const std::string& other = seeds[draws.below(seeds.size())].bytes;
        const auto [from, much] = piece(draws, other.size(), 200);
        s.insert(at, other.substr(from, much));
        break;
      }
      default:
        for (std::size_t i = 0; i + 1 < length; ++i)
          if (s[at + i] == '\n' || s[at + i] == ' ') s[at + i] = "\r\t \n,;"[draws.below(6)];
    }
  }
  return s;
}

class EverySeed : public FolderTest, public testing::WithParamInterface<std::size_t> {};
INSTANTIATE_TEST_SUITE_P(Mutants, EverySeed, testing::Range(std::size_t{0}, seed_files().size()));

TEST_P(EverySeed, SpoiledIsRefusedOrReadInFull) {
  const std::vector<SeedFile> seeds = seed_files();
  const std::string& extension = seeds[GetParam()].extension;
  if (!reads(extension)) GTEST_SKIP();
  ASSERT_TRUE(read_or_refuse(put("good." + extension, seeds[GetParam()].bytes)));
  std::size_t read = 0;
  constexpr std::size_t mutants = 700;
  for (std::size_t i = 0; i < mutants; ++i) {
    Draws draws(4000 + GetParam(), i);
    read += read_or_refuse(put("spoiled." + extension, spoiled(seeds, GetParam(), draws)));
  }
  // Else the mutants do not come near either kind.
  EXPECT_GT(read, mutants / 100);
  EXPECT_LT(read, mutants);
}

}  // namespace
}  // namespace treeline::datasets
