// What a reader owes for any file: a dataset that holds together, or a FileError that names the file.
#pragma once

#include <cstdio>
#include <cstdlib>

#include "datasets_gen/files/read.hpp"

namespace treeline::datasets {

[[noreturn]] inline void broken_promise(const std::filesystem::path& path, const char* what) {
  std::fprintf(stderr, "%s: %s\n", path.c_str(), what);
  std::abort();
}

/// True if the file was read. Aborts where the reader broke its promise.
inline bool read_or_refuse(const std::filesystem::path& path) {
  try {
    const Dataset d = read(path);
    if (d.size() == 0) broken_promise(path, "an empty dataset was returned");
    for (const auto& face : d.mesh.faces)
      for (const auto corner : face)
        if (corner >= d.mesh.vertices.size()) broken_promise(path, "a face names a vertex that is not there");
    return true;
  } catch (const FileError& e) {
    if (e.path != path || e.problem.empty()) broken_promise(path, "an error without its file or reason");
    return false;
  } catch (const std::exception& e) {
    broken_promise(path, e.what());
  }
}

}  // namespace treeline::datasets
