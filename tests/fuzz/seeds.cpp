// fuzz_seeds FOLDER: writes the seeds of seeds.hpp, a folder for each format.
#include "tests/fuzz/seeds.hpp"

#include <cstdio>
#include <filesystem>
#include <fstream>

int main(int argc, char** argv) {
  if (argc != 2) return std::fputs("usage: fuzz_seeds FOLDER\n", stderr), 2;
  int number = 0;
  for (const auto& [extension, bytes] : treeline::datasets::seed_files()) {
    const auto folder = std::filesystem::path(argv[1]) / extension;
    std::filesystem::create_directories(folder);
    std::ofstream(folder / ("seed_" + std::to_string(number++)), std::ios::binary) << bytes;
  }
}
