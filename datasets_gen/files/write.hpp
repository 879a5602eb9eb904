// Writes a dataset; the extension tells the format.
//   .ply  meshes and clouds, binary, bit for bit
//   .obj  meshes and clouds, text; shortest decimals that read back as the same floats
//   .pcd  clouds, binary, bit for bit
//   .xyz  clouds, text, as .obj
//   .csv  clouds, text, the same behind a line that names the columns: x,y,z
//   .png  images of 8 or 16 bits, bit for bit; others are refused
//   .exr  images, floats bit for bit
// Clouds that float cannot hold are written as doubles in each of these.
#pragma once

#include "datasets_gen/files/read.hpp"

namespace treeline::datasets {

/// Throws FileError; then nothing is left behind. An existing file is replaced only if `overwrite`.
void write(const Dataset& dataset, const std::filesystem::path& path, bool overwrite = false);

}  // namespace treeline::datasets
