// Files made by the tests: a folder of their own, and which formats this build reads.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "datasets_gen/files/write.hpp"
#include "tests/datasets_gen/file_bytes.hpp"

namespace treeline::datasets {

/// A folder that goes away with the test.
class FolderTest : public testing::Test {
 protected:
  FolderTest() {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = std::filesystem::temp_directory_path() /
              ("treeline_" + std::to_string(getpid()) + "_" + test->test_suite_name() + "_" + test->name());
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  ~FolderTest() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path put(const std::string& name, std::string_view bytes) const {
    std::filesystem::remove(folder_ / name);  // writing over it makes some file systems wait for the disk
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
    return folder_ / name;
  }
  const std::filesystem::path& folder() const { return folder_; }

 private:
  std::filesystem::path folder_;
};

/// The format's name if this build reads it; tests skip the others.
inline bool reads(const std::string& extension) {
#ifndef TREELINE_HAVE_OPENMESH
  if (extension == "ply" || extension == "obj" || extension == "off" || extension == "stl") return false;
#endif
#ifndef TREELINE_HAVE_ASSIMP
  if (extension == "glb" || extension == "gltf") return false;
#endif
#ifndef TREELINE_HAVE_PCL
  if (extension == "pcd") return false;
#endif
  return !extension.empty();
}

inline const geometry::Mesh3f& small_mesh() {
  static const geometry::Mesh3f mesh = generate("icosphere", 1000, 1).mesh;
  return mesh;
}

inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

}  // namespace treeline::datasets
