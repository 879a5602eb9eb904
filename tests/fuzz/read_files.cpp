// libFuzzer target of one format's reader, which it has from its program's name, fuzz_<extension>: whatever
// the bytes, a valid dataset or a FileError; the sanitizers see to the rest.
#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>

#include "tests/fuzz/must_be_valid.hpp"

namespace {

std::string extension;

}  // namespace

extern "C" int LLVMFuzzerInitialize(int*, char*** argv) {
  const std::string name = (*argv)[0];
  extension = name.substr(name.rfind('_') + 1);
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  static const std::filesystem::path path = std::filesystem::temp_directory_path() /
                                            ("treeline_fuzz_" + std::to_string(getpid()) + "." + extension);
  std::filesystem::remove(path);  // writing over it makes some file systems wait for the disk
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes), static_cast<std::streamsize>(size));
  treeline::datasets::read_or_refuse(path);
  return 0;
}
