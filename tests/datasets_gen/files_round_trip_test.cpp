// What is written is read back bit for bit; what other programs write is read as they meant it.
#include "files_common.hpp"
#include "geometry/mesh_check.hpp"

namespace treeline::datasets {
namespace {

class RoundTrip : public FolderTest {};
class Reading : public FolderTest {};

TEST_F(RoundTrip, WritesEveryRecipeAndReadsTheSameBits) {
  for (const Recipe& recipe : recipes()) {
    if (recipe.kind == Kind::vectors || recipe.kind == Kind::image) continue;
    const Dataset made = generate(recipe.name, 3000, 5);
    for (const std::string extension : {"ply", "obj", "pcd", "xyz", "csv"}) {
      if (recipe.kind == Kind::mesh && extension != "ply" && extension != "obj") continue;
      if (!reads(extension)) continue;
      const auto path = folder() / (recipe.name + "." + extension);
      write(made, path);
      const Dataset again = read(path);
      EXPECT_EQ(again.kind, made.kind) << path;
      EXPECT_EQ(again.hash(), made.hash()) << path;
      EXPECT_EQ(again.closed, made.closed) << path;
      EXPECT_EQ(again.name, recipe.name + "." + extension);
      ASSERT_EQ(again.notes.size(), recipe.precise ? 1u : 0u) << path;
      EXPECT_EQ(again.precise.points, made.precise.points) << path;
      if (recipe.precise) EXPECT_EQ(again.rounding, made.rounding) << path;
    }
  }
}

// Whatever else a face holds, before its corners or behind them, in whatever types: the same mesh.
TEST_F(Reading, PlyFacesWithOtherProperties) {
  if (!reads("ply")) GTEST_SKIP();
  const std::string vertices = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n";
  const int corners[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  const auto file = [&](const std::string& name, const std::string& type, const std::string& first,
                        const std::string& first_values, const std::string& last,
                        const std::string& last_values) {
    std::string text =
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
        "property float z\nelement face 4\n" +
        first + "property list uchar " + type + " vertex_indices\n" + last + "end_header\n" + vertices;
    for (const auto& c : corners)
      text += first_values + "3 " + std::to_string(c[0]) + " " + std::to_string(c[1]) + " " +
              std::to_string(c[2]) + last_values + "\n";
    return read(put(name, text)).mesh.faces;
  };
  const auto plain = file("plain.ply", "int", "", "", "", "");
  ASSERT_EQ(plain.size(), 4u);
  for (int f = 0; f < 4; ++f)
    for (int k = 0; k < 3; ++k)
      EXPECT_EQ(plain[std::size_t(f)][std::size_t(k)], std::uint32_t(corners[f][k]));
  const std::string flag = "property uchar flags\n", uv = "property list uchar float texcoord\n",
                    tags = "property list uchar int tags\n";
  EXPECT_EQ(file("a.ply", "int", flag, "7 ", "", ""), plain);
  EXPECT_EQ(file("b.ply", "int", uv, "2 0.5 0.25 ", "", ""), plain);
  EXPECT_EQ(file("c.ply", "int", tags, "3 3 3 3 ", "", ""), plain);
  EXPECT_EQ(file("d.ply", "int", "", "", uv, " 6 0 0 1 0 0 1"), plain);
  EXPECT_EQ(file("e.ply", "int", flag + tags, "1 2 0 0 ", uv + flag, " 2 0.5 0.5 9"), plain);
  EXPECT_EQ(file("f.ply", "float", "", "", "", ""), plain);
  EXPECT_EQ(file("g.ply", "ushort", "", "", flag, " 1"), plain);
}

TEST_F(RoundTrip, RefusesToOverwriteUnlessToldTo) {
  const Dataset a = generate("grid", 1000, 1), b = generate("uniform_cube", 1000, 1);
  const auto path = folder() / "cloud.xyz";
  write(a, path);
  EXPECT_THROW(write(b, path), FileError);
  EXPECT_EQ(read(path).hash(), a.hash());
  write(b, path, true);
  EXPECT_EQ(read(path).hash(), b.hash());
}

TEST_F(RoundTrip, LeavesFilesOfSimilarNamesAlone) {
  const auto other = put("cloud.xyz.part", "mine");
  write(generate("grid", 1000, 1), folder() / "cloud.xyz");
  std::ifstream in(other);
  std::string text;
  EXPECT_TRUE(in >> text && text == "mine");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder()), {}), 2);
}

TEST_F(RoundTrip, TakesExtensionsInEitherCase) {
  const Dataset made = generate("grid", 1000, 1);
  write(made, folder() / "cloud.XYZ");
  EXPECT_EQ(read(folder() / "cloud.XYZ").hash(), made.hash());
}

TEST_F(RoundTrip, LeavesNothingBehindWhereItCannotWrite) {
  const Dataset cloud = generate("grid", 1000, 1), mesh = generate("terrain", 1000, 1);
  EXPECT_THROW(write(cloud, folder() / "missing" / "a.ply"), FileError);
  EXPECT_THROW(write(mesh, folder() / "a.pcd"), FileError);
  EXPECT_THROW(write(generate("uniform_8", 1000, 1), folder() / "a.ply"), FileError);
  EXPECT_THROW(write(mesh, folder() / "a.blend"), FileError);
  Dataset odd = cloud;
  odd.cloud.points[3][0] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(write(odd, folder() / "a.obj"), FileError);
  EXPECT_TRUE(std::filesystem::is_empty(folder()));
}

TEST_F(Reading, TakesEveryMeshFormat) {
  const geometry::Mesh3f& mesh = small_mesh();
  const std::pair<std::string, std::string> files[] = {
      {"text.ply", ply_text(mesh)},     {"big.ply", ply_big_endian(mesh)}, {"a.off", off_text(mesh)},
      {"binary.stl", stl_binary(mesh)}, {"text.stl", stl_text(mesh)},      {"a.glb", glb(mesh)}};
  for (const auto& [name, bytes] : files) {
    if (!reads(name.substr(name.find('.') + 1))) continue;
    const Dataset d = read(put(name, bytes));
    ASSERT_EQ(d.kind, Kind::mesh) << name;
    EXPECT_TRUE(d.closed) << name;
    ASSERT_EQ(d.mesh.size(), mesh.size()) << name;
    EXPECT_EQ(d.mesh.vertices.size(), mesh.vertices.size()) << name;
    // STL numbers its vertices anew: triangles are compared by their corners' positions, in the order of the
    // file.
    for (std::size_t i = 0; i < mesh.size(); ++i)
      ASSERT_EQ(d.mesh.triangle(i), mesh.triangle(i)) << name << " " << i;
  }
}

TEST_F(Reading, AppliesTheTransformsOfAScene) {
  if (!reads("glb")) GTEST_SKIP() << "built without assimp";
  const Dataset d = read(put("moved.glb", glb(small_mesh(), 4)));
  ASSERT_EQ(d.mesh.size(), small_mesh().size());
  for (std::size_t i = 0; i < d.mesh.size(); ++i)
    EXPECT_NEAR(d.mesh.triangle(i).a[0], small_mesh().triangle(i).a[0] + 4, 1e-6);
}

TEST_F(Reading, TurnsTheFacesOfMirroredGltfNodes) {
  if (!reads("gltf")) GTEST_SKIP() << "built without assimp";
  const std::string good = gltf_text(small_mesh()), node = R"("nodes":[{"mesh":0)";
  const double volume = geometry::check_mesh(small_mesh()).volume;
  const auto volume_of = [&](const std::string& nodes) {
    std::string text = good;
    text.replace(text.find(node), node.size(), nodes);
    const Dataset d = read(put("a.gltf", text));
    EXPECT_TRUE(d.closed) << nodes;
    EXPECT_EQ(d.mesh.size(), small_mesh().size()) << nodes;
    return geometry::check_mesh(d.mesh).volume;
  };
  // A volume grows by the size of the determinant, and stays positive: faces look outward.
  const std::string child = R"("nodes":[{"children":[1],"scale":[1,-1,1]},{"mesh":0)";
  EXPECT_NEAR(volume_of(node), volume, 1e-5 * volume);
  EXPECT_NEAR(volume_of(R"("nodes":[{"scale":[-1,1,1],"mesh":0)"), volume, 1e-5 * volume);
  EXPECT_NEAR(volume_of(R"("nodes":[{"scale":[-2,-1,-1],"mesh":0)"), 2 * volume, 1e-5 * volume);
  EXPECT_NEAR(volume_of(R"("nodes":[{"scale":[-2,-1,1],"mesh":0)"), 2 * volume, 1e-5 * volume);
  EXPECT_NEAR(volume_of(child), volume, 1e-5 * volume) << "mirrored by its parent";
  EXPECT_NEAR(volume_of(child + R"(,"scale":[1,1,-3])"), 3 * volume, 1e-5 * volume) << "mirrored twice";
}

TEST_F(Reading, SaysWhatOfAnObjIsLeftOut) {
  if (!reads("obj")) GTEST_SKIP() << "built without OpenMesh";
  const std::string text =
      "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nl 1 2\nl 2 3\ncstype bezier\ndeg 2\ncurv 0 1 1 2 3\nend\n"
      "surf 0 1 0 1 1 2 3\n";
  const Dataset d = read(put("a.obj", text));
  std::string notes;
  for (const std::string& note : d.notes) notes += note + "\n";
  EXPECT_EQ(d.notes.size(), 3u) << notes;
  for (const char* part : {"2 statements 'l' (lines)", "1 statements 'curv' (curves)", "1 statements 'surf'"})
    EXPECT_NE(notes.find(part), std::string::npos) << part << "\n" << notes;
  EXPECT_TRUE(read(put("b.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\ng a\nf 1 2 3\n")).notes.empty());
}

TEST_F(Reading, TakesTextStlInUpperCase) {
  if (!reads("stl")) GTEST_SKIP() << "built without OpenMesh";
  std::string text = stl_text(small_mesh());
  for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  const Dataset d = read(put("a.stl", text));
  ASSERT_EQ(d.mesh.size(), small_mesh().size());
  for (std::size_t i = 0; i < d.mesh.size(); ++i)
    ASSERT_EQ(d.mesh.triangle(i), small_mesh().triangle(i)) << i;
}

TEST_F(Reading, KeepsNonManifoldAndRepeatedFacesInOrder) {
  if (!reads("ply")) GTEST_SKIP() << "built without OpenMesh";
  // Three faces on one edge, one face twice, one turned over, and one that names a vertex twice.
  geometry::Mesh3f m;
  m.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, -1, 0}};
  m.faces = {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}, {0, 1, 2}, {2, 1, 0}, {3, 3, 4}};
  EXPECT_EQ(read(put("fan.ply", ply_text(m))).mesh.faces, m.faces);
  EXPECT_EQ(read(put("fan.off", off_text(m))).mesh.faces, m.faces);
  EXPECT_FALSE(read(put("fan2.ply", ply_big_endian(m))).closed);
  // STL and OBJ leave the flat one out, and say so.
  const Dataset stl = read(put("fan.stl", stl_binary(m)));
  EXPECT_EQ(stl.mesh.size(), 5u);
  ASSERT_EQ(stl.notes.size(), 1u);
  EXPECT_NE(stl.notes[0].find("left out 1 "), std::string::npos) << stl.notes[0];
  const Dataset obj = read(put("fan.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 1 2\nf 3 2 1\n"));
  EXPECT_EQ(obj.mesh.size(), 2u);
  EXPECT_EQ(obj.notes.size(), 1u);
}

TEST_F(Reading, CutsPolygonsIntoFans) {
  if (!reads("obj")) GTEST_SKIP() << "built without OpenMesh";
  const auto fan = std::vector<geometry::Mesh3f::Face>{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}};
  const std::string five = "v 0 0 0\nv 1 0 0\nv 2 1 0\nv 1 2 0\nv 0 1 0\n";
  EXPECT_EQ(read(put("a.obj", five + "f 1 2 3 4 5\n")).mesh.faces, fan);
  EXPECT_EQ(read(put("b.off", "OFF\n5 1 0\n0 0 0\n1 0 0\n2 1 0\n1 2 0\n0 1 0\n5 0 1 2 3 4\n")).mesh.faces,
            fan);
}

TEST_F(Reading, TakesObjAsOtherProgramsWriteIt) {
  if (!reads("obj")) GTEST_SKIP() << "built without OpenMesh";
  const Dataset d =
      read(put("a.obj",
               "# exported\r\nmtllib none.mtl\r\no thing\r\nv 0 0 0 1 0 0\r\nv 1 0 0\r\nv 0 1 0\r\n"
               "vt 0 0\r\nvn 0 0 1\r\nusemtl red\r\ns off\r\nf 1/1/1 2//1 -1\r\nf 1/1 \\\r\n3/1 2/1\r\n"));
  EXPECT_EQ(d.mesh.faces, (std::vector<geometry::Mesh3f::Face>{{0, 1, 2}, {0, 2, 1}}));
}

TEST_F(Reading, TakesTextClouds) {
  const std::vector<geometry::Vec3f> two{{1.5f, -2, 3e-5f}, {0, 0.25f, 1e10f}};
  const std::pair<const char*, const char*> files[] = {
      {"plain.xyz", "1.5 -2 3e-5\n0 .25 1e10\n"},
      {"tabs.txt", "# comment\n\n1.5\t-2\t+3e-5\t99 red\r\n0 0.25 1E10 7 blue // end\n"},
      {"comma.csv", "1.5, -2, 3e-5\n0,0.25,1e10"},
      {"semicolon.csv", "1.5;-2;3e-5;7\n0;0.25;1e10;8\n"},
      {"header.csv", "\"X\",\"Y\",\"Z\"\n1.5,-2,3e-5\n0,0.25,1e10\n"},
      {"quoted.csv", "\"name\",\"x\",\"y\",\"z\"\n\"a,b\",\"1.5\",\"-2\",3e-5\n,0,0.25,1e10\n"},
      {"empty_after.csv", "x;y;z;i\n1.5;-2;3e-5;\n0;0.25;1e10;8\n"},
      {"columns.csv", "id,z,time,x,y\n1,3e-5,9,1.5,-2\n2,1e10,9,0,0.25\n"}};
  for (const auto& [name, text] : files) EXPECT_EQ(read(put(name, text)).cloud.points, two) << name;
}

TEST_F(Reading, TakesPcdAsTextAndBinary) {
  if (!reads("pcd")) GTEST_SKIP() << "built without PCL";
  const std::string head =
      "VERSION .7\nFIELDS x intensity y z\nSIZE 4 4 4 4\nTYPE F F F F\nCOUNT 1 1 1 1\nWIDTH 2\n"
      "HEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 2\n";
  const std::vector<geometry::Vec3f> two{{1.5f, -2, 3}, {0, 0.25f, 8}};
  EXPECT_EQ(read(put("a.pcd", "# .PCD\n" + head + "DATA ascii\n1.5 9 -2 3\n0 9 0.25 8\n")).cloud.points, two);
  std::string data;
  for (const auto& p : two) data += bytes_of(p[0]) + bytes_of(9.f) + bytes_of(p[1]) + bytes_of(p[2]);
  EXPECT_EQ(read(put("b.pcd", head + "DATA binary\n" + data)).cloud.points, two);
}

TEST_F(Reading, KeepsAndNotesWhatIsNotFinite) {
  const Dataset d = read(put("a.xyz", "0 0 0\n1 nan 0\n1 1 inf\n2 2 2\n"));
  ASSERT_EQ(d.size(), 4u);
  EXPECT_TRUE(std::isnan(d.cloud.points[1][1]));
  ASSERT_EQ(d.notes.size(), 1u);
  EXPECT_NE(d.notes[0].find("2 points"), std::string::npos) << d.notes[0];
  EXPECT_NE(d.notes[0].find("number 1"), std::string::npos) << d.notes[0];
  if (!reads("ply")) return;
  geometry::Mesh3f m = small_mesh();
  m.vertices[7][2] = std::numeric_limits<float>::infinity();
  EXPECT_EQ(read(put("a.ply", ply_big_endian(m))).notes.size(), 1u);
}

TEST_F(Reading, NotesWhatFloatCannotHold) {
  // Metres in a national grid: float steps are 0.5 m at 5e6, the extent is 100 m.
  const Dataset far = read(put("far.xyz", "500000.123 5000000.456 10\n500100.5 5000100.25 20.1\n"));
  ASSERT_EQ(far.notes.size(), 1u);
  EXPECT_NE(far.notes[0].find("float would move coordinates by up to 0.25"), std::string::npos)
      << far.notes[0];  // 5000100.25 lies between steps of one half
  ASSERT_EQ(far.precise.size(), 2u);
  EXPECT_EQ(far.precise.points[0], (geometry::Vec3d{500000.123, 5000000.456, 10}));
  EXPECT_TRUE(read(put("mild.xyz", "0.123 0.456 0.1\n100.5 100.25 20.1\n")).precise.points.empty());
  EXPECT_TRUE(read(put("near.xyz", "0.123 0.456 0.1\n100.5 100.25 20.1\n")).notes.empty());
  if (!reads("ply")) return;
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 2\nproperty double x\nproperty double y\nproperty double z\n"
      "end_header\n";
  const Dataset cloud = read(put("far.ply", ply + "5000000.123 0 0\n5000001.3 0 0\n"));
  EXPECT_EQ(cloud.kind, Kind::cloud);
  EXPECT_EQ(cloud.notes.size(), 1u);
  EXPECT_EQ(cloud.precise.points, (std::vector<geometry::Vec3d>{{5000000.123, 0, 0}, {5000001.3, 0, 0}}));
  EXPECT_NEAR(cloud.rounding, 0.2, 1e-9);  // float's steps there are of one half: 1.3 becomes 1.5
  // One point in float's coarse range does not matter where the extent is as large.
  EXPECT_TRUE(read(put("wide.ply", ply + "5000000.123 0 0\n0 0 0\n")).notes.empty());
}

// The same two points in every text format. What a format declares is kept to: doubles where it declares
// doubles or nothing, floats with a note of the largest rounding and the remedy where it declares floats.
TEST_F(Reading, SaysWhatRoundingGeoreferencedTextCosts) {
  const std::vector<geometry::Vec3d> two{{512345.3, 5403210.7, 10}, {512445.3, 5403310.2, 20}};
  const std::string blank = "512345.3 5403210.7 10\n512445.3 5403310.2 20\n",
                    comma = "x,y,z\n512345.3,5403210.7,10\n512445.3,5403310.2,20\n";
  const auto pcd = [&](const char* size) {
    return "VERSION .7\nFIELDS x y z\nSIZE " + std::string(size) +
           "\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 2\nHEIGHT 1\nPOINTS 2\nDATA ascii\n" + blank;
  };
  const auto ply = [&](const std::string& type) {
    return "ply\nformat ascii 1.0\nelement vertex 2\nproperty " + type + " x\nproperty " + type +
           " y\nproperty " + type + " z\nend_header\n" + blank;
  };
  const std::string obj = "v 512345.3 5403210.7 10\nv 512445.3 5403310.2 20\n", off = "OFF\n2 0 0\n" + blank;
  const double moved = 0.2;  // 5403210.7 becomes .5, and so does the .2 move by .2 to .0
  for (const auto& [name, text] :
       std::initializer_list<std::pair<const char*, std::string>>{{"a.xyz", blank},
                                                                  {"a.csv", comma},
                                                                  {"a.obj", obj},
                                                                  {"a.off", off},
                                                                  {"a.ply", ply("double")},
                                                                  {"a.pcd", pcd("8 8 8")}}) {
    if (!reads(std::string(name).substr(2))) continue;
    const Dataset d = read(put(name, text));
    ASSERT_EQ(d.notes.size(), 1u) << name;
    EXPECT_NE(d.notes[0].find("float would move coordinates by up to 0.2"), std::string::npos) << d.notes[0];
    EXPECT_EQ(d.precise.points, two) << name;
    EXPECT_NEAR(d.rounding, moved, 1e-9) << name;
  }
  for (const auto& [name, text] : std::initializer_list<std::pair<const char*, std::string>>{
           {"f.ply", ply("float")}, {"f.pcd", pcd("4 4 4")}}) {
    if (!reads(std::string(name).substr(2))) continue;
    const Dataset d = read(put(name, text));
    ASSERT_EQ(d.notes.size(), 1u) << name;
    for (const char* words :
         {"rounded to float, which moved them by up to 0.2", "Declare doubles", "such as 512345 5403210 10"})
      EXPECT_NE(d.notes[0].find(words), std::string::npos) << d.notes[0];
    EXPECT_EQ(d.precise.size(), 0u) << name;
    EXPECT_NEAR(d.rounding, moved, 1e-9) << name;
    EXPECT_EQ(d.cloud.points, (std::vector{geometry::Vec3f(two[0]), geometry::Vec3f(two[1])})) << name;
  }
  if (!reads("obj")) return;
  const Dataset mesh = read(put("m.obj", obj + "v 512345.3 5403310.2 15\nf 1 2 3\n"));
  ASSERT_EQ(mesh.notes.size(), 1u);
  EXPECT_NE(mesh.notes[0].find("meshes are kept as floats. Subtract"), std::string::npos) << mesh.notes[0];
  EXPECT_NEAR(mesh.rounding, moved, 1e-9);
  // Of small extent an offset in whole numbers leaves what it was to take off; and float has no room for
  // numbers that are all too small.
  const Dataset small = read(put(
      "s.obj", "v 0.30000001 7.0000001 0\nv 0.30000001 7.00000012 0\nv 0.30000003 7.0000001 0\nf 1 2 3\n"));
  ASSERT_EQ(small.notes.size(), 1u);
  EXPECT_NE(small.notes[0].find("(6 times the extent)"), std::string::npos) << small.notes[0];
  EXPECT_NE(small.notes[0].find("such as 0.3"), std::string::npos) << small.notes[0];
  EXPECT_NE(small.notes[0].find(" 7.000000"), std::string::npos) << small.notes[0];
  const Dataset tiny = read(put("t.obj", "v 0 0 0\nv 1e-46 0 0\nv 0 1e-46 0\nf 1 2 3\n"));
  ASSERT_EQ(tiny.notes.size(), 1u);
  EXPECT_NE(tiny.notes[0].find("take a smaller unit"), std::string::npos) << tiny.notes[0];
}

/// The area of a mesh, and the vector area: equal in size where all of it lies in one plane and looks one
/// way.
std::pair<double, double> areas(const geometry::Mesh3f& mesh) {
  double area = 0;
  geometry::Vec3d sum{};
  for (std::size_t f = 0; f < mesh.size(); ++f) {
    const geometry::Vec3d n = geometry::Triangle3d(mesh.triangle(f)).area_normal() * 0.5;
    area += length(n), sum += n;
  }
  return {area, length(sum)};
}

TEST_F(Reading, FillsPolygonsThatAreNotConvex) {
  if (!reads("obj")) GTEST_SKIP() << "built without OpenMesh";
  const auto obj = [](const std::vector<std::array<double, 3>>& outline, bool turned) {
    std::string text, face = "f";
    for (const auto& [x, y, z] : outline)
      text += "v " + std::to_string(x) + " " + std::to_string(y) + " " + std::to_string(z) + "\n";
    for (std::size_t i = 1; i <= outline.size(); ++i)
      face += " " + std::to_string(turned ? outline.size() + 1 - i : i);
    return text + face + "\n";
  };
  struct Case {
    std::vector<std::array<double, 3>> outline;
    double area;
  };
  std::vector<Case> cases{
      {{{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {1, 0.5, 0}}, 1.5},                    // an arrow head
      {{{0, 0, 0}, {3, 0, 0}, {3, 1, 0}, {1, 1, 0}, {1, 3, 0}, {0, 3, 0}}, 5},  // an L
      {{{0, 0, 1}, {0, 3, 1}, {0, 3, 0}, {0, 2, 0}, {0, 1, 0}, {0, 0, 0}}, 3},  // in line
      {{{0, 0, 0}, {4, 0, 4}, {4, 3, 4}, {3, 3, 3}, {3, 1, 3}, {1, 1, 1}, {1, 3, 1}, {0, 3, 0}},  // a U,
                                                                                                  // slanting
       8 * std::sqrt(2.0)}};
  Case comb{{}, 0};  // of 40 teeth
  comb.outline.push_back({0, 0, 0}), comb.outline.push_back({80, 0, 0});
  for (int i = 79; i >= 0; --i) comb.outline.push_back({double(i), i % 2 == 0 ? 1.0 : 5.0, 0});
  for (std::size_t i = 0; i < comb.outline.size(); ++i) {
    const auto &p = comb.outline[i], &q = comb.outline[(i + 1) % comb.outline.size()];
    comb.area += 0.5 * (p[0] * q[1] - p[1] * q[0]);
  }
  cases.push_back(comb);
  for (std::size_t i = 0; i < cases.size(); ++i)
    for (const bool turned : {false, true}) {
      const Dataset d = read(put("concave.obj", obj(cases[i].outline, turned)));
      EXPECT_TRUE(d.notes.empty());
      EXPECT_EQ(d.mesh.size(), cases[i].outline.size() - 2) << i;
      const auto [area, vector] = areas(d.mesh);
      EXPECT_NEAR(area, std::abs(cases[i].area), 1e-5 * area) << i;
      EXPECT_NEAR(vector, area, 1e-6 * area) << i;
    }
  // A bow: no triangles fill it, and the note says which face it is.
  const Dataset bow = read(put("bow.obj", "v 0 0 0\nv 1 1 0\nv 1 0 0\nv 0 1 0\nf 1 3 2\nf 1 2 3 4\n"));
  EXPECT_EQ(bow.mesh.size(), 3u);
  ASSERT_EQ(bow.notes.size(), 1u);
  EXPECT_NE(bow.notes[0].find("1 polygon crosses itself"), std::string::npos) << bow.notes[0];
  EXPECT_NE(bow.notes[0].find("the first is face 1"), std::string::npos) << bow.notes[0];
  // Outlines that go around twice: a square's, a star of five corners, and a loop within a loop.
  for (const char* twice :
       {"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4 5 6 7 8\n",
        "v 0 10 0\nv -6 -8 0\nv 9.5 3 0\nv -9.5 3 0\nv 6 -8 0\nf 1 2 3 4 5\n",
        "v 0 0 0\nv 9 0 0\nv 9 9 0\nv 0 9 0\nv 1 1 0\nv 5 1 0\nv 5 5 0\nv 1 5 0\nf 1 2 3 4 5 6 7 8\n"})
    EXPECT_EQ(read(put("twice.obj", twice)).notes.size(), 1u) << twice;
}

// An outline that goes along a bridge to a hole, around it and back goes around once: the hole stays, whether
// the way back names vertices again or others at the same places, in every format that has polygons.
TEST_F(Reading, KeepsHolesOfPolygons) {
  if (!reads("obj")) GTEST_SKIP() << "built without OpenMesh";
  const std::string corners[] = {"0 0 0", "9 0 0", "9 9 0", "0 9 0", "1 1 0", "1 5 0",
                                 "5 5 0", "5 1 0", "0 0 0", "1 1 0", "7 7 3"};  // the last: of no polygon
  const std::vector<int> again{0, 1, 2, 3, 0, 4, 5, 6, 7, 4}, others{0, 1, 2, 3, 8, 9, 5, 6, 7, 4},
      square{0, 1, 2, 3};
  const auto list = [](const std::vector<int>& face, int from) {
    std::string r;
    for (const int c : face) r += " " + std::to_string(c + from);
    return r + "\n";
  };
  const auto obj = [&](const std::vector<std::vector<int>>& faces) {
    std::string text;
    for (const auto& c : corners) text += "v " + c + "\n";
    for (const auto& f : faces) text += "f" + list(f, 1);
    return text;
  };
  const auto off = [&](const std::vector<std::vector<int>>& faces) {
    std::string text = "OFF\n11 " + std::to_string(faces.size()) + " 0\n";
    for (const auto& c : corners) text += c + "\n";
    for (const auto& f : faces) text += std::to_string(f.size()) + list(f, 0);
    return text;
  };
  const auto ply = [&](const std::vector<std::vector<int>>& faces) {
    std::string text =
        "ply\nformat ascii 1.0\nelement vertex 11\nproperty float x\nproperty float y\nproperty float z\n"
        "element face " +
        std::to_string(faces.size()) + "\nproperty list int int vertex_indices\nend_header\n";
    for (const auto& c : corners) text += c + "\n";
    for (const auto& f : faces) text += std::to_string(f.size()) + list(f, 0);
    return text;
  };
  for (const auto& frame : {again, others}) {
    // Between two squares, so that what stands for a vertex mixes up no other polygon.
    const std::vector<std::vector<int>> faces{square, frame, square, frame};
    const Dataset of_obj = read(put("framed.obj", obj(faces)));
    EXPECT_TRUE(of_obj.notes.empty()) << of_obj.notes[0];
    EXPECT_EQ(of_obj.mesh.vertices.size(), 11u);
    EXPECT_NEAR(areas(of_obj.mesh).first, 2 * 81 + 2 * (81 - 16), 1e-4);
    EXPECT_NEAR(areas(of_obj.mesh).second, 2 * 81 + 2 * (81 - 16), 1e-4);
    for (const Dataset& other : {read(put("framed.off", off(faces))), read(put("framed.ply", ply(faces)))}) {
      EXPECT_EQ(other.mesh.vertices, of_obj.mesh.vertices) << other.name;
      EXPECT_EQ(other.mesh.faces, of_obj.mesh.faces) << other.name;
    }
  }
  // What is named twice in a row is no way back.
  const Dataset twice = read(put("twice.obj", obj({{0, 0, 1, 2, 2, 3, 0}})));
  EXPECT_EQ(twice.mesh.size(), 2u);
  EXPECT_NEAR(areas(twice.mesh).second, 81, 1e-4);
  ASSERT_EQ(twice.notes.size(), 1u);
  EXPECT_NE(twice.notes[0].find("name a vertex twice in a row: 1, the first in line 12"), std::string::npos)
      << twice.notes[0];
}

}  // namespace
}  // namespace treeline::datasets
