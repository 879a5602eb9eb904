// The files on which OpenMesh, PCL, assimp and CGAL's soup reader stop early, guess, hang or allocate what a
// header says, each in every format that can hold it: one typed error with the place, or, where the file is
// right after all, all of it.
#include <sys/stat.h>

#include "files_common.hpp"
#include "tests/fuzz/seeds.hpp"

namespace treeline::datasets {
namespace {

class BadFiles : public FolderTest {
 protected:
  /// What reading complains about, or "read".
  std::string answer(const std::string& name, const std::string& bytes) {
    return answer_of(put(name, bytes));
  }
  std::string answer_of(const std::filesystem::path& path) {
    try {
      const Dataset d = read(path);
      return "read";
    } catch (const FileError& e) {
      EXPECT_EQ(e.path, path);
      return e.place + ": " + e.problem;
    }
  }
};

void expect_says(const std::string& answer, const std::string& words) {
  EXPECT_NE(answer.find(words), std::string::npos) << "wanted: " << words << "\nsaid:   " << answer;
}

const std::string ply_start = "ply\nformat ascii 1.0\nelement vertex 4\n";
const std::string ply_xyz = "property float x\nproperty float y\nproperty float z\n";
const std::string ply_faces = "element face 2\nproperty list uchar int vertex_indices\n";
const std::string ply_text_file =
    ply_start + ply_xyz + ply_faces + "end_header\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 1 2\n3 0 1 3\n";

TEST_F(BadFiles, CutInTheMiddle) {
  if (!reads("ply")) GTEST_SKIP();
  expect_says(answer("a.ply", ply_text_file.substr(0, ply_text_file.size() - 8)),
              "face 1, line 14: the file ends");
  expect_says(answer("v.ply", ply_text_file.substr(0, ply_text_file.find("0 1 0"))),
              "vertex 2, line 11: the file ends");
  const std::string big = ply_big_endian(tetrahedron());
  expect_says(answer("b.ply", big.substr(0, big.size() - 5)), "face 3, byte");
  std::string stl = stl_binary(tetrahedron());
  stl[0] = 'S';
  expect_says(answer("c.stl", stl.substr(0, stl.size() - 50)), "byte 80: promises 4 triangles");
  const std::string text = stl_text(tetrahedron());
  expect_says(answer("d.stl", text.substr(0, text.rfind("endfacet"))), "the file ends within a solid");
  const std::string off = off_text(tetrahedron());
  expect_says(answer("e.off", off.substr(0, off.rfind("3 1 2 3"))), "still to come: face 3 of 4");
}

TEST_F(BadFiles, IndicesOutOfRange) {
  if (!reads("ply")) GTEST_SKIP();
  expect_says(answer("a.ply", replaced(ply_text_file, "3 0 1 3", "3 0 1 4")),
              "face 1, line 15: names vertex 4 of 4");
  expect_says(answer("b.ply", replaced(ply_text_file, "3 0 1 3", "3 0 1 -1")),
              "face 1, line 15: names vertex -1");
  expect_says(answer("c.ply", replaced(ply_text_file, "3 0 1 3", "3 0 1 99999999999")), "face 1, line 15");
  expect_says(answer("d.ply", replaced(ply_text_file, "3 0 1 3", "3 0 1 1.5")), "not an integer");
  const std::string obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  expect_says(answer("a.obj", obj + "f 1 2 4294967299\n"), "line 4: names vertex 4294967299 of 3");
  expect_says(answer("b.obj", obj + "f 1 2 -4\n"), "line 4: names vertex -4");
  expect_says(answer("c.obj", obj + "f -9223372036854775808 2 3\n"),
              "line 4: names vertex -9223372036854775808");
  expect_says(answer("d.obj", obj + "f 1/9/9 2/8 3//7\n"),
              "read");  // textures and normals are no geometry of ours
  // Relative to the vertices so far: those that come later do not count.
  expect_says(answer("e.obj", "v 0 0 0\nv 1 0 0\nf -1 -2 -3\nv 0 1 0\n"), "line 3: names vertex -3");
}

TEST_F(BadFiles, RelativeIndicesOfObjCountBackFromTheLine) {
  if (!reads("obj")) GTEST_SKIP();
  const Dataset d =
      read(put("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 0 0 1\nf -4 -1 -2\nf 1 4 2\n"));
  const std::vector<geometry::Mesh3f::Face> expected{{0, 1, 2}, {0, 3, 2}, {0, 3, 1}};
  EXPECT_EQ(d.mesh.faces, expected);
}

TEST_F(BadFiles, CoordinatesThatAreNotFinite) {
  if (!reads("ply")) GTEST_SKIP();
  for (const char* odd : {"nan", "inf", "-inf", "NaN", "1e39"})
    expect_says(answer("a.ply", replaced(ply_text_file, "0 1 0", std::string("0 ") + odd + " 0")),
                "vertex 2, line 12");
  // Binary can hold them: all vertices and faces are kept, and the user is told.
  geometry::Mesh3f m = tetrahedron();
  m.vertices[2][1] = std::numeric_limits<float>::quiet_NaN();
  const Dataset d = read(put("b.ply", ply_big_endian(m)));
  EXPECT_EQ(d.mesh.faces, m.faces);
  EXPECT_EQ(d.mesh.vertices.size(), 4u);
  ASSERT_EQ(d.notes.size(), 1u);
  expect_says(d.notes[0], "1 point has a coordinate that is not finite: number 2 (counted from 0)");
  expect_says(d.notes[0], "3 triangles have a corner there");  // all but the one across from it
  m.faces.resize(1);
  m.faces[0] = {0, 1, 3};
  expect_says(read(put("b.ply", ply_big_endian(m))).notes[0], "no face has a corner there");
  m.faces[0] = {0, 1, 2};
  expect_says(read(put("b.ply", ply_big_endian(m))).notes[0], "1 triangle has a corner there");
  expect_says(answer("c.stl", stl_text(m)), "not a finite number");
  expect_says(answer("d.stl", stl_binary(m)), "not finite");
  expect_says(answer("e.off", off_text(m)), "is not a finite number");
}

// A finite number that float cannot hold is refused with its line, and not made infinite.
TEST_F(BadFiles, NumbersBeyondTheRangeOfFloat) {
  for (const std::string huge : {"1e300", "-4e38", "1e400"}) {
    const std::string says = "'" + huge + "' is beyond the range of float";
    expect_says(answer("a.xyz", "0 0 0\n1 " + huge + " 2\n"), "line 2: field 2, y: " + says);
    expect_says(answer("a.csv", "id,x,y,z\n7,0,0," + huge + "\n"), "line 2: field 4, z: " + says);
    if (reads("obj")) expect_says(answer("a.obj", "v 0 0 0\nv 0 " + huge + " 0\n"), "line 2: " + says);
    if (!reads("pcd")) continue;
    for (const char* size : {"4 4 4", "8 8 8"})
      expect_says(answer("a.pcd", "FIELDS x y z\nSIZE " + std::string(size) +
                                      "\nTYPE F F F\nWIDTH 2\nDATA ascii\n0 0 0\n0 0 " + huge + "\n"),
                  "line 7: " + says);
  }
  EXPECT_EQ(answer("b.xyz", "0 0 0\n1 3.4e38 2\n"), "read");
}

TEST_F(BadFiles, TwoColumnsOfOneName) {
  expect_says(answer("a.csv", "x,y,z,x\n0,0,0,9\n"), "line 1: two columns are called x, fields 1 and 4");
  expect_says(answer("b.csv", "id;X;Y;y;Z\n1;0;0;0;9\n"), "line 1: two columns are called y, fields 3 and 4");
  EXPECT_EQ(answer("c.csv", "id,x,y,z,id\n1,0,0,0,9\n"), "read");  // others do not matter
}

TEST_F(BadFiles, WithoutFaces) {
  if (!reads("ply")) GTEST_SKIP();
  const std::string none =
      replaced(ply_text_file.substr(0, ply_text_file.find("3 0 1 2")), "face 2", "face 0");
  const Dataset d = read(put("a.ply", none));
  EXPECT_EQ(d.kind, Kind::cloud);
  EXPECT_EQ(d.size(), 4u);
  EXPECT_EQ(read(put("b.off", "OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n")).kind, Kind::cloud);
  EXPECT_EQ(read(put("c.obj", "v 0 0 0\nv 1 0 0\n")).kind, Kind::cloud);
  expect_says(answer("d.stl", std::string(84, '\0')), "no ");
}

TEST_F(BadFiles, CountsThatNoFileCouldHold) {
  if (!reads("ply")) GTEST_SKIP();
  expect_says(answer("a.ply", replaced(ply_text_file, "vertex 4", "vertex 4000000000")), "vertex 4");
  expect_says(answer("b.ply", replaced(ply_text_file, "vertex 4", "vertex -5")),
              "line 3: expected 'element NAME COUNT'");
  expect_says(answer("c.ply", replaced(ply_text_file, "face 2", "face 18446744073709551615")),
              "face 2, line 15");
  std::string stl = stl_binary(tetrahedron());
  stl[0] = 'S';
  expect_says(answer("d.stl", stl.replace(80, 4, bytes_of(0xffffffffu))),
              "byte 80: promises 4294967295 triangles");
  expect_says(answer("e.off", "OFF\n3 4000000000 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"),
              "line 2: promises 4000000000 faces");
  expect_says(answer("f.off", "OFF\n3 -5 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"), "line 2: expected the counts");
  expect_says(answer("g.off", "OFF\n6 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"), "line 6");
  expect_says(answer("h.ply", replaced(ply_text_file, "3 0 1 3", "200 0 1 3")),
              "face 1, line 15: a list of length 200");
  // Found by fuzzing: a length that no integer holds.
  const std::string float_lengths = replaced(ply_text_file, "list uchar int", "list float int");
  expect_says(answer("i.ply", replaced(float_lengths, "3 0 1 3", "2.1e+40 0 1 3")), "runs past the end");
}

TEST_F(BadFiles, HeadersThatDoNotEnd) {
  if (!reads("ply")) GTEST_SKIP();
  expect_says(answer("a.ply", replaced(ply_text_file, "end_header\n", "")), "line 9: unknown header line");
  expect_says(answer("b.ply", ply_start + ply_xyz + ply_faces), "line 8: the file ends within the header");
  expect_says(answer("c.ply", "ply"), "line 1: the file ends within the header");
}

TEST_F(BadFiles, FacesOfFewerThanThreeCorners) {
  if (!reads("ply")) GTEST_SKIP();
  expect_says(answer("a.ply", replaced(ply_text_file, "3 0 1 3", "2 0 1")),
              "face 1, line 15: a face of 2 corners");
  expect_says(answer("b.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n2 0 1\n"), "line 6: face 0");
  expect_says(answer("c.obj", "v 0 0 0\nv 1 0 0\nf 1 2\n"), "line 3: a face of 2 corners");
  // A corner twice is kept where the format's reader can, and counted where it cannot.
  EXPECT_EQ(read(put("d.ply", replaced(ply_text_file, "3 0 1 3", "3 0 1 1"))).size(), 2u);
  const Dataset d = read(put("e.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2 2\n"));
  EXPECT_EQ(d.size(), 1u);
  ASSERT_EQ(d.notes.size(), 1u);
  expect_says(d.notes[0], "left out 1 faces");
}

TEST_F(BadFiles, PcdWithoutHeightWhoseDataLookLikeText) {
  if (!reads("pcd")) GTEST_SKIP();
  const std::string head =
      "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 1\nPOINTS 1\nDATA binary\n";
  const std::string data = "COLUMNS x \n\xff";
  const Dataset d = read(put("a.pcd", head + data.substr(0, 12)));
  geometry::Vec3f p;
  std::memcpy(&p, data.data(), 12);
  EXPECT_EQ(d.cloud.points, std::vector{p});
  expect_says(answer("b.pcd", replaced(head, "TYPE F F F", "TYPE F F Q") + data), "line 4: 'Q' is no type");
}

// ---- what is no file of the format at all ---------------------------------------------------------------

TEST_F(BadFiles, OtherContentUnderTheName) {
  std::string wide;
  for (const char c : std::string("0 0 0\n1 0 0\n")) (wide += c) += '\0';
  for (const std::string e : {"ply", "obj", "off", "xyz", "csv", "pcd", "gltf"}) {
    if (!reads(e)) continue;
    expect_says(answer("utf16." + e, "\xFF\xFE" + wide), "byte 0: is text in UTF-16");
    expect_says(answer("packed." + e, "\x1F\x8B\x08" + wide), "byte 0: is compressed by gzip");
    expect_says(answer("zipped." + e, "PK\x03\x04" + wide), "byte 0: is a zip archive");
    EXPECT_NE(answer("wide." + e, wide), "read") << e;
    EXPECT_NE(answer("long." + e, std::string(1u << 20, 'x')), "read") << e;
    expect_says(answer("none." + e, ""), "the file is empty");
  }
}

TEST_F(BadFiles, WhatIsNoFile) {
  const auto folder_named = folder() / "folder.ply";
  std::filesystem::create_directory(folder_named);
  expect_says(answer_of(folder_named), "not a regular file");
  const auto pipe = folder() / "pipe.ply";  // opening one waits for a writer for ever
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  expect_says(answer_of(pipe), "not a regular file");
  const auto device = folder() / "device.xyz";  // without an end
  std::filesystem::create_symlink("/dev/zero", device);
  expect_says(answer_of(device), "not a regular file");
  const auto nowhere = folder() / "nowhere.ply";
  std::filesystem::create_symlink("nothing", nowhere);
  expect_says(answer_of(nowhere), "no such file");
  if (geteuid() != 0) {
    const auto locked = put("locked.ply", ply_text_file);
    std::filesystem::permissions(locked, std::filesystem::perms::none);
    expect_says(answer_of(locked), "cannot be opened");
  }
}

// ---- what looks odd and is right --------------------------------------------------------------------------

TEST_F(BadFiles, LineEndsOfEitherKindAndNoneAtTheEnd) {
  const auto with_returns = [](const std::string& text) {
    std::string r;
    for (const char c : text) (c == '\n' ? r += '\r' : r) += c;
    return r;
  };
  for (const auto& [extension, bytes] : seed_files()) {
    const bool text = bytes.find('\0') == std::string::npos && bytes.find("binary") == std::string::npos;
    if (!reads(extension) || !text || extension == "gltf") continue;
    const std::uint64_t hash = read(put("a." + extension, bytes)).hash();
    EXPECT_EQ(read(put("b." + extension, with_returns(bytes))).hash(), hash) << bytes;
    EXPECT_EQ(read(put("c." + extension, bytes.substr(0, bytes.size() - 1))).hash(), hash) << bytes;
    EXPECT_EQ(read(put("d." + extension, bytes + "\n \n")).hash(), hash) << bytes;
  }
  if (!reads("ply")) return;
  // Data follow the header's last line end at once, whichever kind it is.
  std::string binary = ply_big_endian(tetrahedron());
  const std::size_t body = binary.find("end_header\n") + 11;
  const std::uint64_t hash = read(put("e.ply", binary)).hash();
  EXPECT_EQ(read(put("f.ply", with_returns(binary.substr(0, body)) + binary.substr(body))).hash(), hash);
}

TEST_F(BadFiles, LinesOfAnyLength) {
  const std::string blanks(1u << 20, ' ');
  EXPECT_EQ(read(put("a.xyz", "0 0 0\n1" + blanks + "2 3\n")).size(), 2u);
  if (!reads("obj")) return;
  // One polygon of 100 000 corners in one line is a fan of two less.
  std::string obj, face = "f";
  for (int i = 1; i <= 100'000; ++i) {
    obj += "v " + std::to_string(i) + " " + std::to_string(i % 317) + " 0\n";
    face += " " + std::to_string(i);
  }
  EXPECT_EQ(read(put("b.obj", obj + face + "\n")).size(), 99'998u);
}

// ---- glTF: what assimp would read otherwise, or not come back from
// -----------------------------------------

TEST_F(BadFiles, GltfWhoseNodesAreNoTree) {
  if (!reads("gltf")) GTEST_SKIP();
  const std::string good = gltf_text(tetrahedron()), nodes = R"("nodes":[{"mesh":0)";
  EXPECT_EQ(answer("good.gltf", good), "read");
  expect_says(answer("a.gltf", replaced(good, nodes, R"("nodes":[{"children":[0],"mesh":0)")),
              "their own ancestors");
  expect_says(answer("b.gltf", replaced(good, nodes, R"("nodes":[{"children":[1,1]},{"mesh":0)")),
              "node 0: names node 1, which has a parent already");
  expect_says(
      answer("c.gltf", replaced(good, R"("scenes":[{"nodes":[0]}])", R"("scenes":[{"nodes":[0,0]}])")),
      "scene 0: names node 0 twice");
  expect_says(answer("d.gltf", replaced(good, nodes, R"("nodes":[{"mesh":1)")), "node 0: names a mesh");
  expect_says(answer("e.gltf", replaced(good, nodes, R"("nodes":[{"matrix":[1,0,0],"mesh":0)")),
              "matrix needs 16");
  std::string chain = R"("nodes":[)";
  for (int i = 1; i <= 5000; ++i) chain += R"({"children":[)" + std::to_string(i) + "]},";
  expect_says(answer("f.gltf", replaced(good, R"("nodes":[{"mesh")", chain + R"({"mesh")")),
              "more than 1000 nodes deep");
  expect_says(answer("g.gltf", "{\"asset\":" + std::string(300'000, '[')), "nested more than 200 deep");
  // A mesh of 4 triangles shown 100 times is 400.
  std::string forest = R"("nodes":[)", roots = R"("scenes":[{"nodes":[0)";
  for (int i = 0; i < 99; ++i) forest += R"({"mesh":0},)", roots += "," + std::to_string(i + 1);
  EXPECT_EQ(read(put("h.gltf", replaced(replaced(good, R"("nodes":[{"mesh")", forest + R"({"mesh")"),
                                        R"("scenes":[{"nodes":[0)", roots)))
                .size(),
            400u);
}

TEST_F(BadFiles, GltfOfOtherTypes) {
  if (!reads("gltf")) GTEST_SKIP();
  const std::string good = gltf_text(tetrahedron());
  expect_says(answer("a.gltf", replaced(good, "5126", "5121")),
              "mesh 0, primitive 0: its positions are no triples of float");
  expect_says(answer("b.gltf", replaced(good, "VEC3", "VEC2")), "mesh 0, primitive 0: its positions");
  expect_says(answer("c.gltf", replaced(good, "5125", "5126")), "its indices are no unsigned integers");
  expect_says(answer("d.gltf", replaced(good, R"("buffer":0,)", R"("buffer":0,"byteStride":4,)")),
              "accessor 0: its bufferView's byteStride");
  expect_says(
      answer(
          "e.gltf",
          replaced(
              good, R"("type":"VEC3",)",
              R"("type":"VEC3","sparse":{"count":9,"indices":{"bufferView":1,"componentType":5125},"values":{"bufferView":0}},)")),
      "accessor 0: has more sparse elements");
  expect_says(answer("f.gltf", replaced(good, "base64,AAAA", "base64,")), "expected 96 bytes");
  expect_says(answer("g.gltf", replaced(good, R"("indices":1)", R"("indices":2)")),
              "indices names an accessor");
}

TEST_F(BadFiles, GltfThatNeedsWhatIsNotRead) {
  if (!reads("gltf")) GTEST_SKIP();
  const std::string good = gltf_text(tetrahedron()), start = R"({"asset")";
  const auto needing = [&](const std::string& list) {
    return replaced(good, start, R"({"extensionsRequired":)" + list + R"(,"asset")");
  };
  for (const std::string name : {"KHR_draco_mesh_compression", "EXT_meshopt_compression", "ACME_surfaces"})
    expect_says(answer("a.gltf", needing(R"(["KHR_materials_unlit",")" + name + R"("])")),
                "extensionsRequired: the file needs '" + name + "', which is not read");
  EXPECT_EQ(answer("b.gltf", needing(R"(["KHR_materials_unlit","KHR_texture_transform"])")), "read");
  expect_says(answer("c.gltf", needing("7")), "extensionsRequired: is no list");
  expect_says(answer("d.gltf", needing("[7]")), "its JSON is broken");
}

TEST_F(BadFiles, PlyThatKeepsTrianglesInStrips) {
  if (!reads("ply")) GTEST_SKIP();
  expect_says(answer("a.ply", ply_start + ply_xyz +
                                  "element tristrips 1\nproperty list int int vertex_indices\nend_header\n"
                                  "0 0 0\n1 0 0\n0 1 0\n0 0 1\n5 0 1 2 3 -1\n"),
              "triangles in strips (element 'tristrips')");
}

}  // namespace
}  // namespace treeline::datasets
