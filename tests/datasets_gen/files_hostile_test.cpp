// Broken files: each is refused with its name, the place and the reason; none crashes, none is read in part.
#include "datasets_gen/portable.hpp"
#include "files_common.hpp"

namespace treeline::datasets {
namespace {

class Hostile : public FolderTest {
 protected:
  /// Reading must fail at this place for this reason.
  void refused(const std::string& name, const std::string& bytes, const std::string& place,
               const std::string& reason) {
    if (!reads(name.substr(name.rfind('.') + 1))) return;
    const auto path = put(name, bytes);
    try {
      const Dataset d = read(path);
      ADD_FAILURE() << name << " was read: " << d.size() << " elements";
    } catch (const FileError& e) {
      EXPECT_EQ(e.path, path);
      EXPECT_NE(e.place.find(place), std::string::npos) << e.what();
      EXPECT_NE(e.problem.find(reason), std::string::npos) << e.what();
      EXPECT_NE(std::string(e.what()).find(name), std::string::npos) << e.what();
    }
  }
};

TEST_F(Hostile, EmptyMissingAndUnknownFiles) {
  for (const std::string e : {"ply", "obj", "stl", "off", "glb", "gltf", "pcd", "xyz", "csv"})
    if (reads(e)) refused("empty." + e, "", "", "empty");
  refused("thing.blend", "x", "", "ply, obj, stl, off, gltf, glb, pcd, xyz, txt, csv");
  refused("noextension", "x", "", "no extension");
  EXPECT_THROW(read(folder() / "missing.ply"), FileError);
  EXPECT_THROW(read(folder()), FileError);
}

TEST_F(Hostile, BinaryJunkUnderEveryExtension) {
  Draws draws(1, 1);
  std::string junk(5000, '\0');
  for (char& c : junk) c = static_cast<char>(draws.below(256));
  for (const std::string e : {"ply", "obj", "stl", "off", "glb", "gltf", "pcd", "xyz", "csv"}) {
    if (!reads(e)) continue;
    EXPECT_THROW(read(put("junk." + e, junk)), FileError) << e;
    EXPECT_THROW(read(put("zero." + e, std::string(5000, '\0'))), FileError) << e;
  }
}

TEST_F(Hostile, Ply) {
  const std::string text = ply_text(small_mesh()), binary = ply_big_endian(small_mesh());
  const std::string vertices = std::to_string(small_mesh().vertices.size()),
                    faces = std::to_string(small_mesh().size());
  refused("a.ply", "PLY\n", "line 1", "starts with 'ply'");
  refused("b.ply", text.substr(0, 60), "line", "header");
  refused("c.ply", replaced(text, "float y", "quaternion y"), "line 6", "unknown type");
  refused("d.ply", replaced(text, "float y", "float v"), "header", "x, y and z");
  refused("e.ply", text.substr(0, text.size() / 2), "", "");
  refused("f.ply", text.substr(0, text.rfind('\n', text.size() - 2) + 1),
          "face " + std::to_string(small_mesh().size() - 1), "ends here");
  refused("g.ply", text + "1 2 3\n", "line", "follow");
  refused("h.ply", replaced(text, "element vertex " + vertices, "element vertex 4000000000"), "line", "");
  refused("i.ply", replaced(text, "element face " + faces, "element face 99999999999999999999"), "line 9",
          "COUNT");
  refused("j.ply", replaced(text, "\n3 ", "\n2 "), "face 0, line", "2 corners");
  refused("k.ply", text.substr(0, text.rfind(' ') + 1) + "999999\n",
          "face " + std::to_string(small_mesh().size() - 1), "999999");
  refused("l.ply", text.substr(0, text.rfind(' ') + 1) + "-1\n", "face", "vertex -1");
  refused("m.ply", replaced(text, " 255\n", " nan\n"), "vertex 0, line 12", "'nan'");
  refused("n.ply", replaced(text, " 255\n", "\n"), "vertex 0, line 12", "fewer values");
  refused("o.ply", replaced(text, "vertex_index", "corners"), "header", "vertex_indices");
  refused("p.ply", binary.substr(0, binary.size() - 1),
          "face " + std::to_string(small_mesh().size() - 1) + ", byte", "ends here");
  refused("q.ply", binary + "x", "byte", "1 bytes follow");
  refused("r.ply", replaced(binary, "element vertex " + vertices, "element vertex 4000000000"), "vertex", "");
  std::string bad = binary;
  bad[bad.size() - 2] = '\x7f', bad[bad.size() - 5] = '\x7f';
  refused("s.ply", bad, "face " + std::to_string(small_mesh().size() - 1), "names vertex");
  refused("t.ply",
          "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\nproperty float "
          "z\nend_header\n",
          "", "no points");
  refused("u.ply",
          "ply\nformat ascii 1.0\nelement vertex 1\nproperty double x\nproperty float y\nproperty float "
          "z\nend_header\n1e39 0 0\n",
          "vertex 0", "range of float");
}

TEST_F(Hostile, Obj) {
  const std::string three = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  refused("a.obj", three + "f 1 2 4\n", "line 4", "vertex 4 of 3");
  refused("b.obj", three + "f 1 2 0\n", "line 4", "vertex 0");
  refused("c.obj", three + "f 1 2 -4\n", "line 4", "vertex -4");
  refused("d.obj", three + "f 1 2\n", "line 4", "2 corners");
  refused("e.obj", three + "f 1 two 3\n", "line 4", "'two'");
  refused("f.obj", three + "v 1 2\n", "line 4", "three coordinates");
  refused("g.obj", three + "v 1 2 x\n", "line 4", "'x'");
  refused("h.obj", three + "v 1 2 nan\n", "line 4", "'nan'");
  refused("i.obj", three + "v 1 2 1e99\n", "line 4", "range of float");
  refused("j.obj", "# nothing\n", "", "no vertex");
  refused("k.obj", three + "f 1 2 \\\n", "line 4", "continued");
  refused("l.obj", three + "f 1 1 2\n", "", "no triangle");
  refused("m.obj", three + "f 1 2 99999999999999999999\n", "line 4", "not a vertex index");
}

TEST_F(Hostile, Off) {
  const std::string good = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  refused("a.off", replaced(good, "OFF", "FOO"), "line 1", "'FOO'");
  refused("b.off", replaced(good, "3 1 0", "3 2 0"), "line 6", "face 1 of 2");
  refused("c.off", replaced(good, "3 1 0", "4000000000 1 0"), "line 2", "room");
  refused("d.off", replaced(good, "3 0 1 2", "3 0 1 3"), "line 6", "'3' of 3");
  refused("e.off", replaced(good, "3 0 1 2", "3 0 1 -1"), "line 6", "'-1'");
  refused("f.off", replaced(good, "3 0 1 2", "4 0 1 2"), "line 6", "as many indices");
  refused("g.off", good + "9\n", "line 7", "follow");
  refused("h.off", replaced(good, "1 0 0", "1 0"), "line 4", "three coordinates");
  refused("i.off", "OFF BINARY\n", "line 1", "binary");
  refused("j.off", "OFF\n", "line 1", "still to come");
}

TEST_F(Hostile, Stl) {
  const std::string binary = stl_binary(small_mesh()), text = stl_text(small_mesh());
  refused("a.stl", binary.substr(0, 50), "line", "");  // begins with "solid", so it is text
  refused("b.stl", std::string(50, 'x'), "byte 50", "84 bytes");
  std::string named_otherwise = binary;
  named_otherwise[0] = 'x';
  refused("c.stl", named_otherwise.substr(0, binary.size() - 1), "byte 80", "promises");
  refused("d.stl", named_otherwise + "x", "byte 80", "promises");
  std::string nan = named_otherwise;
  nan.replace(84 + 50 * 7 + 12, 4, bytes_of(std::numeric_limits<float>::quiet_NaN()));
  refused("e.stl", nan, "triangle 7", "not finite");
  refused("f.stl", text.substr(0, text.size() - 15), "line", "");
  refused("g.stl", replaced(text, "endloop", "vertex 1 2 3"), "line 7", "expected 'endloop'");
  refused("h.stl", replaced(text, "vertex ", "vertex x"), "line 4", "not a finite number");
  refused("i.stl", "solid nothing\nendsolid\n", "", "no ");
}

TEST_F(Hostile, Gltf) {
  const std::string good = glb(small_mesh());
  refused("a.glb", good.substr(0, 16), "byte", "header");
  refused("b.glb", good.substr(0, good.size() - 1), "byte 8", "promises");
  std::string long_chunk = good;
  long_chunk.replace(12, 4, bytes_of(0x7fffffffu));
  refused("c.glb", long_chunk, "byte 12", "runs past the end");
  std::string version = good;
  version[4] = 1;
  refused("d.glb", version, "byte 4", "version 1");
  // Same length, larger count: the accessor no longer fits its view.
  const std::string count = "\"count\":" + std::to_string(small_mesh().vertices.size());
  refused("e.glb",
          replaced(good, count,
                   "\"count\":" + std::string(std::to_string(small_mesh().vertices.size()).size(), '9')),
          "accessor 0", "run past the end");
  refused("f.glb", replaced(good, "\"bufferView\":1", "\"bufferView\":9"), "accessor 1", "not there");
  refused("g.glb", replaced(good, "\"buffer\":0", "\"buffer\":3"), "bufferView 0", "not there");
  std::string index = good;  // the file ends with the last triangle's last corner
  index.replace(index.size() - 4, 4, bytes_of(std::uint32_t{60000}));
  refused("k.glb", index, "mesh 0, primitive 0", "not there");
  refused("h.gltf", "{\"asset\":", "", "JSON");
  refused("i.gltf", "[1, 2]", "", "");
  refused("j.gltf", "{\"asset\":{\"version\":\"2.0\"}}", "", "");
}

TEST_F(Hostile, Pcd) {
  const std::string head =
      "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 2\nHEIGHT 1\n"
      "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 2\n";
  const std::string text = head + "DATA ascii\n1 2 3\n4 5 6\n",
                    binary = head + "DATA binary\n" + std::string(24, 'a');
  refused("a.pcd", head, "line 9", "before DATA");
  refused("b.pcd", replaced(text, "4 5 6\n", ""), "line 11", "1 of 2 points");
  refused("c.pcd", text + "7 8 9\n", "line 13", "more points");
  refused("d.pcd", replaced(text, "4 5 6", "4 five 6"), "line 12", "'five'");
  refused("e.pcd", replaced(text, "4 5 6", "4 5"), "line 12", "2 values");
  refused("f.pcd", binary.substr(0, binary.size() - 1), "byte", "ends here");
  refused("g.pcd", replaced(replaced(binary, "WIDTH 2", "WIDTH 4000000000"), "POINTS 2", "POINTS 4000000000"),
          "line 6", "room");
  refused("h.pcd", replaced(text, "POINTS 2", "POINTS 3"), "line 9", "WIDTH times HEIGHT");
  refused("i.pcd", replaced(text, "FIELDS x y z", "FIELDS x y w"), "line 2", "x, y and z");
  refused("j.pcd", replaced(text, "TYPE F F F", "TYPE F F"), "line 3", "differ");
  refused("k.pcd", replaced(text, "DATA ascii", "DATA morse"), "line 10", "'morse'");
  refused("l.pcd", head + "DATA binary_compressed\n" + bytes_of(100u) + bytes_of(24u) + "abc", "byte",
          "ends here");
  refused("m.pcd", head + "DATA binary_compressed\n" + bytes_of(3u) + bytes_of(99u) + "abc", "byte",
          "unpacks to 99");
  refused("n.pcd", head + "DATA binary_compressed\n" + bytes_of(3u) + bytes_of(24u) + "abc", "", "");
  refused("o.pcd", replaced(text, "SIZE 4 4 4", "SIZE 4 4 3"), "line 3", "'3'");
}

TEST_F(Hostile, Xyz) {
  refused("a.xyz", "1 2 3\n4 5\n", "line 2", "has 2 fields; the first line has 3");
  refused("b.xyz", "1 2 3\n4 5 six\n", "line 2", "'six'");
  refused("c.csv", "a,b,c\n1,2,3\n", "line 1", "header");
  refused("d.xyz", "# only a comment\n", "", "no points");
  refused("e.xyz", "1 2 1e39\n", "line 1", "range of float");
  refused("f.csv", "t,x,y,z\n1,2,3,4\n1,2,3\n", "line 3", "has 3 fields; the first line has 4");
  refused("g.xyz", "1 2 3\n1 2 3x\n", "line 2", "'3x'");
}

// Cut at any byte, or with any byte changed, a file is read in full or refused; indices stay in range.
TEST_F(Hostile, CutAndChangedFilesNeverCrash) {
  geometry::Mesh3f tetrahedron;
  tetrahedron.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  tetrahedron.faces = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  const std::string pcd =
      "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 2\nHEIGHT 1\n"
      "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 2\nDATA ";
  const std::pair<std::string, std::string> files[] = {
      {"a.ply", ply_text(tetrahedron)},
      {"b.ply", ply_big_endian(tetrahedron)},
      {"c.off", off_text(tetrahedron)},
      {"d.stl", stl_binary(tetrahedron)},
      {"e.stl", stl_text(tetrahedron)},
      {"f.glb", glb(tetrahedron)},
      {"g.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 3/1/1 2//1 -3\n"},
      {"h.pcd", pcd + "ascii\n1 2 3\n4 5 6\n"},
      {"i.pcd", pcd + "binary\n" + std::string(24, 'a')},
      {"j.csv", "x,y,z\n1,2,3\n4,5,6\n"}};
  std::size_t refusals = 0;
  const auto must_survive = [&](const std::string& name, const std::string& bytes) {
    const auto path = put(name, bytes);
    try {
      const Dataset d = read(path);
      for (const auto& f : d.mesh.faces)
        for (const auto v : f) ASSERT_LT(v, d.mesh.vertices.size());
    } catch (const FileError&) {
      ++refusals;
    }
  };
  for (const auto& [name, good] : files) {
    if (!reads(name.substr(2))) continue;
    SCOPED_TRACE(name);
    for (std::size_t length = 1; length<good.size(); length += good.size()> 600 ? 7 : 1)
      must_survive(name, good.substr(0, length));
    for (std::uint64_t change = 0; change < 300; ++change) {
      Draws draws(99, change);
      std::string bad = good;
      const std::uint64_t at = draws.below(bad.size()), value = draws.below(256);
      bad[at] = static_cast<char>(value);
      must_survive(name, bad);
    }
  }
  EXPECT_GT(refusals, 500u);
}

// Spreadsheets and editors of one system put it in front of text.
TEST_F(Hostile, AByteOrderMarkIsReadOver) {
  const std::string mark = "\xEF\xBB\xBF";
  const std::string ply_head =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
      "property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
      "end_header\n";
  const std::pair<std::string, std::string> files[] = {
      {"a.csv", "x,y,z\n0,0,0\n1,0,0\n0,1,0\n"},
      {"b.xyz", "0 0 0\n1 0 0\n0 1 0\n"},
      {"c.txt", "0;0;0\n1;0;0\n0;1;0\n"},
      {"d.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"},
      {"e.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"},
      {"f.ply", ply_head + "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"}};
  for (const auto& [name, text] : files) {
    if (!reads(name.substr(2))) continue;
    const Dataset plain = read(put(name, text)), marked = read(put(name, mark + text));
    EXPECT_EQ(marked.kind, plain.kind) << name;
    EXPECT_EQ(marked.hash(), plain.hash()) << name;
    EXPECT_EQ(plain.size(), plain.kind == Kind::mesh ? 1u : 3u) << name;
    EXPECT_THROW(read(put(name, mark)), FileError) << name << " of nothing but the mark";
    EXPECT_THROW(read(put(name, mark + mark + text)), FileError) << name << " marked twice";
  }
}

TEST_F(Hostile, FieldsOfTextClouds) {
  refused("gap.csv", "x,y,z,i\n1,2,3,9\n4,,6,9\n", "line 3", "field 2, y: is empty");
  refused("gap_no_header.csv", "1;2;3;9\n4;5;;9\n", "line 2", "field 3, z: is empty");
  refused("gap_first.csv", ",2,3\n", "line 1", "field 1, x: is empty");
  refused("gap_tabs.txt", "x\ty\tz\ti\n4\t\t6\t9\n", "line 2", "has 3 fields; the first line has 4");
  refused("short.csv", "x,y,z,i\n1,2,3\n", "line 2", "has 3 fields; the first line has 4");
  refused("long.xyz", "1 2 3\n1 2 3 4\n", "line 2", "has 4 fields; the first line has 3");
  refused("mixed.csv", "1,2,3\n1;2;3\n", "line 2", "has 1 fields; the first line has 3");
  refused("word.csv", "i,z,y,x\n1,2,red,3\n", "line 2", "field 3, y: 'red' is not a number");
  refused("comma.csv", "1,5;2,5;3,5\n", "line 1", "decimal comma");
  refused("comma_header.csv", "x;y;z\n1;2,5;3\n", "line 2", "field 2, y: '2,5' has a decimal comma");
  refused("comma_quoted.csv", "\"1,5\",\"2,5\",\"3,5\"\n", "line 1", "decimal comma");
  refused("comma_blanks.xyz", "1,5 2,5 3,5\n", "line 1", "decimal commas are not read");
}

// id,x,y,z without names would be read as x,y,z: every distance wrong, and no sign of it.
TEST_F(Hostile, AFirstColumnThatCountsThePointsIsNoX) {
  refused("from_0.csv", "0,5,6,7\n1,8,9,4\n2,1,2,2\n", "", "counts the points from 0");
  refused("from_1.xyz", "1 5 6 7 9\n2 8 9 4 9\n3 1 2 2 9\n", "", "'id x y z c5'");
  refused("quoted.csv", "\"1\";5;6;7\n\"2\";8;9;4\n\"3\";1;2;2\n", "", "'id;x;y;z'");
  const std::pair<const char*, const char*> fine[] = {
      {"named.csv", "id,x,y,z\n0,5,6,7\n1,8,9,4\n2,1,2,2\n"},   // what the refusal asks for
      {"x_named.csv", "x,y,z,w\n0,5,6,7\n1,8,9,4\n2,1,2,2\n"},  // it is x indeed
      {"three.csv", "0,5,6\n1,8,9\n2,1,2\n"},                   // there is no other x
      {"from_7.csv", "7,5,6,7\n8,8,9,4\n9,1,2,2\n"},            // a scan that starts anywhere
      {"gap.csv", "0,5,6,7\n1,8,9,4\n3,1,2,2\n"},
      {"two.csv", "0,5,6,7\n1,8,9,4\n"},
      {"fractions.csv", "0.0,5,6,7\n1.0,8,9,4\n2.0,1,2,2\n"}};
  for (const auto& [name, text] : fine) EXPECT_GE(read(put(name, text)).size(), 2u) << name;
  EXPECT_EQ(read(put("named.csv", fine[0].second)).cloud.points[1], (geometry::Vec3f{8, 9, 4}));
}

TEST_F(Hostile, GltfBuffersOutsideItsFolder) {
  for (const std::string uri : {"../../../etc/passwd", "/etc/passwd", "a/../../b.bin", "%2e%2e/b.bin",
                                "..\\\\b.bin", "file:///etc/passwd", "C:/b.bin"})
    refused("outside.gltf",
            R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":12,"uri":")" + uri + R"("}]})", "buffer 0",
            "outside the folder");
}

}  // namespace
}  // namespace treeline::datasets
