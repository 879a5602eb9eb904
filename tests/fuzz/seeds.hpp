// What fuzzing starts from: tiny files that are right, several of each format, so that every branch of a
// reader is near one of them.
#pragma once

#include <string>
#include <vector>

#include "tests/datasets_gen/file_bytes.hpp"

namespace treeline::datasets {

struct SeedFile {
  std::string extension, bytes;
};

inline geometry::Mesh3f tetrahedron() {
  return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
}

inline std::vector<SeedFile> seed_files() {
  const geometry::Mesh3f mesh = tetrahedron();
  const std::string points = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n";
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty double x\nproperty float y\n"
      "property float32 z\n";
  const std::string pcd =
      "# .PCD v0.7\nVERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 2\n"
      "HEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 2\nDATA ";
  const std::string wide =
      "VERSION .7\nFIELDS rgb x y z n\nSIZE 4 8 8 8 2\nTYPE U F F F I\nCOUNT 1 1 1 1 2\n"
      "WIDTH 1\nHEIGHT 2\nPOINTS 2\nDATA ";
  // LZF: a run of seven bytes as they are, then copies of what stands one byte before.
  const std::string packed("\x06\0\0\x80\x3f\0\0\0\xe0\x08\0", 11);
  return {
      {"ply", ply_text(mesh)},
      {"ply", ply_big_endian(mesh)},
      {"ply", ply + "end_header\n" + points},
      {"ply", ply +
                  "element face 1\nproperty uchar flags\nproperty list uchar float texcoord\nproperty list "
                  "ushort int vertex_indices\nelement edge 1\nproperty int a\nend_header\n" +
                  points + "7 2 0.5 0.25 4 0 1 2 3\n5\n"},
      {"off", off_text(mesh)},
      {"off", "COFF 4 1 0\n0 0 0 1 1 1\n1 0 0 1 1 1\n0 1 0 1 1 1\n0 0 1 1 1 1\n4 0 1 2 3\n"},
      {"stl", stl_binary(mesh)},
      {"stl", stl_text(mesh)},
      {"obj", "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0 1\nvn 0 0 1\nvt 0 0\nf 1 2 3\nf 3/1/1 2//1 -3\n"},
      {"obj", "# points\nv 0 0 0\nv 1 0 -1e-5\nv 1 \\\n2 3\ng a\nusemtl b\nf 1 1 2\nf 1 2 3 # fan\n"},
      {"glb", glb(mesh)},
      {"gltf", gltf_text(mesh)},
      {"pcd", pcd + "ascii\n1 2 3\n4 5 nan\n"},
      {"pcd", pcd + "binary\n" + std::string(24, 'a')},
      {"pcd",
       pcd + "binary_compressed\n" + bytes_of(std::uint32_t{11}) + bytes_of(std::uint32_t{24}) + packed},
      {"pcd", wide + "ascii\n1 2 3 4 5 6\n7 8 9 10 11 12\n"},
      {"xyz", "# points\n1 2 3\n4 5 6\n"},
      {"csv", "id;x;\"y\";z\n1;1.5;2;3e5\n2;0;-0;nan\n"},
      {"csv", "1,2,3,,5\n1,2,3,4,\n"},
  };
}

}  // namespace treeline::datasets
