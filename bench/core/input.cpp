#include "bench/core/selection.hpp"

#ifdef TREELINE_HAS_FILES
#include "datasets_gen/files/read.hpp"
#include "datasets_gen/rooms/room.hpp"
#include "datasets_gen/scenes/scene.hpp"
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
  if (kind == datasets::Kind::surface)
    throw UsageError("--input " + file + ": surfaces are recipes; see --dataset");
  if (data.kind == datasets::Kind::image)
    throw UsageError("--input " + file + ": an image; this task has no use for one");
  if (kind == datasets::Kind::image) throw UsageError("--input " + file + ": no image; this task needs one");
  if (kind == datasets::Kind::vectors) return data;  // points are vectors of three
  if (data.kind == datasets::Kind::cloud && kind != datasets::Kind::cloud)
    throw UsageError("--input " + file + ": a cloud; this task needs a mesh");
  if (kind == datasets::Kind::scene) {
    try {
      data.scene = datasets::scene_of_mesh(std::move(data.mesh), data.name);
    } catch (const std::exception& e) {
      throw UsageError("--input " + file + ": " + e.what());
    }
    data.mesh = {}, data.kind = kind;
    data.notes.push_back("a mesh: a floor, a sun and a camera were added; y is taken as up");
    return data;
  }
  if (kind == datasets::Kind::room) {
    try {
      data.room = datasets::room_of_mesh(std::move(data.mesh), data.name);
    } catch (const std::exception& e) {
      throw UsageError("--input " + file + ": " + e.what());
    }
    data.mesh = {}, data.kind = kind;
    data.notes.push_back("a mesh: a floor, a lamp, an even sky and a camera were added; y is taken as up");
    return data;
  }
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
