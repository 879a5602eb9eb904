// Reads a user's mesh, point cloud or image; the extension tells the format. A file is read in full or not at
// all.
//
//   .ply .obj .stl .off   meshes, through OpenMesh; a PLY without faces is a cloud
//   .gltf .glb            meshes, through assimp; the scene's transforms are applied
//   .pcd                  clouds, through PCL
//   .xyz .txt .csv        clouds: x y z first on each line, or as a header names them; commas, semicolons or
//   blanks
//   .png .exr .hdr .jpg … images, through OpenImageIO: whatever it reads. Four channels at most, values as
//   the file has them: integers as shares of their largest, no curve undone, alpha not multiplied in
//
// Polygons become fans of triangles. Each format is checked here first, structure and counts against the size
// of the file, because the libraries stop early, guess, or allocate what a header says; then what they read
// is counted again. Coordinates that are not finite are kept where the format can hold them, and noted.
// Coordinates that float rounds by more than 1e-6 of the extent are noted with the largest rounding. Of
// clouds their doubles are kept (Dataset::precise), except where the file declares floats and its text has
// more digits than these hold; meshes are floats here. A finite one beyond the range of float is refused, as
// are images of more than 2^28 values and those with a value that is not finite.
#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>

#include "datasets_gen/dataset.hpp"

namespace treeline::datasets {

/// What is wrong with a file, and where in it.
struct FileError : std::runtime_error {
  FileError(std::filesystem::path file, std::string where, std::string what_is_wrong)
      : std::runtime_error(file.string() + ": " + (where.empty() ? "" : where + ": ") + what_is_wrong),
        path(std::move(file)),
        place(std::move(where)),
        problem(std::move(what_is_wrong)) {}

  std::filesystem::path path;
  std::string place;  // "line 12", "face 7", "byte 1024"; empty for the file as a whole
  std::string problem;
};

/// Throws FileError. The dataset's `closed` is found from the mesh; its name is the file's.
Dataset read(const std::filesystem::path& path);

}  // namespace treeline::datasets
