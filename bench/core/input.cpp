#include "bench/core/selection.hpp"

#ifdef TREELINE_HAS_FILES
#include "datasets_gen/files/read.hpp"
#endif

namespace treeline::bench {

#ifdef TREELINE_HAS_FILES

datasets::Dataset read_input(const std::string& file, datasets::Kind kind) {
  datasets::Dataset data;
  try {
    data = datasets::read(file);
  } catch (const std::exception& e) {
    throw UsageError(std::string("--input ") + e.what());
  }
  if (data.kind == kind) return data;
  if (data.kind == datasets::Kind::image)
    throw UsageError("--input " + file + ": an image; this task has no use for one");
  if (kind == datasets::Kind::image) throw UsageError("--input " + file + ": no image; this task needs one");
  if (kind == datasets::Kind::vectors) return data;  // points are vectors of three
  if (kind == datasets::Kind::mesh) throw UsageError("--input " + file + ": a cloud; this task needs a mesh");
  data.kind = kind;
  data.cloud.points = std::move(data.mesh.vertices);  // float: meshes have no doubles here
  data.mesh = {};
  data.notes.push_back("a mesh: its vertices are taken as the cloud");
  return data;
}

#else

datasets::Dataset read_input(const std::string& file, datasets::Kind) {
  throw UsageError("--input " + file + ": this build has no readers of files");
}

#endif

}  // namespace treeline::bench
