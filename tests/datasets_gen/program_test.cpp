// The program treeline_gen: exit status and output of --check and --decimate.
#include <sys/wait.h>

#include "files_common.hpp"

namespace treeline::datasets {
namespace {

class Program : public FolderTest {
 protected:
  struct Result {
    int status;
    std::string output;
  };
  Result run(const std::string& arguments) const {
    const auto log = folder() / "log";
    const std::string command =
        "cd '" + folder().string() + "' && '" TREELINE_GEN "' " + arguments + " >log 2>&1";
    const int status = std::system(command.c_str());
    std::ifstream in(log);
    return {WEXITSTATUS(status), {std::istreambuf_iterator<char>(in), {}}};
  }
};

TEST_F(Program, ChecksFiles) {
  if (!reads("ply")) GTEST_SKIP();
  write(generate("icosphere", 1000, 1), folder() / "good.ply");
  write(generate("icosphere+missing_1", 1000, 1), folder() / "bad.ply");
  put("broken.ply", "ply\n");
  put("points.xyz", "1 2 3\n");
  EXPECT_EQ(run("--check good.ply").status, 0);
  const Result bad = run("--check bad.ply");
  EXPECT_EQ(bad.status, 1);
  EXPECT_NE(bad.output.find("closed: no"), std::string::npos) << bad.output;
  EXPECT_EQ(run("--check bad.ply --json --threads 2").status, 1);
  for (const char* name :
       {"broken.ply", "points.xyz", "missing.ply", "good.ply extra.ply", "good.ply --decimate 0.5", ""})
    EXPECT_EQ(run(std::string("--check ") + name).status, 2) << name;
  EXPECT_EQ(run("--json good.ply a.ply").status, 2);
}

TEST_F(Program, WritesTextures) {
#ifndef TREELINE_HAVE_OPENIMAGEIO
  GTEST_SKIP();
#endif
  const Result listed = run("--list");
  EXPECT_NE(listed.output.find("marble"), std::string::npos) << listed.output;
  EXPECT_NE(listed.output.find("image"), std::string::npos);
  const Result made = run("--n 2500 marble a.png");
  EXPECT_EQ(made.status, 0) << made.output;
  EXPECT_NE(made.output.find("2500 pixels"), std::string::npos) << made.output;
  EXPECT_EQ(read(folder() / "a.png").hash(), generate("marble", 2500, 1).hash());
  EXPECT_EQ(run("--n 2500 ramp a.exr").status, 0);
  EXPECT_EQ(run("--n 2500 ramp b.png").status, 2) << "PNG has no floats";
  EXPECT_EQ(run("--n 2500 marble b.ply").status, 2);
  EXPECT_EQ(run("--check a.png").status, 2);
}

TEST_F(Program, TakesWholeNumbersAsTheyAre) {
  for (const char* seed : {"-1", "18446744073709551616", "1.5", "0x10", "' 1'", "''"}) {
    const Result refused = run(std::string("--n 1000 --seed ") + seed + " uniform_cube a.xyz");
    EXPECT_EQ(refused.status, 2) << seed;
    EXPECT_NE(refused.output.find("--seed"), std::string::npos) << refused.output;
  }
  EXPECT_EQ(run("--check a.ply --examples -1").status, 2);
  const auto bytes = [&](const std::string& seed) {
    const Result made = run("--n 1000 --force --seed " + seed + " uniform_cube a.xyz");
    EXPECT_EQ(made.status, 0) << made.output;
    std::ifstream in(folder() / "a.xyz");
    return std::string(std::istreambuf_iterator<char>(in), {});
  };
  EXPECT_NE(bytes("18446744073709551615"), bytes("18446744073709551614"));
  EXPECT_NE(bytes("0"), bytes("1"));
}

TEST_F(Program, Decimates) {
  if (!reads("ply")) GTEST_SKIP();
  write(generate("icosphere", 5000, 1), folder() / "in.ply");
  const Result made = run("--decimate 0.1 in.ply out.ply");
  EXPECT_EQ(made.status, 0) << made.output;
  for (const char* words : {"of 5120 triangles", "off the faces left", "area", "volume"})
    EXPECT_NE(made.output.find(words), std::string::npos) << made.output;
  EXPECT_LE(read(folder() / "out.ply").size(), 512u);
  EXPECT_EQ(run("--decimate 0.1 in.ply out.ply").status, 2) << "would overwrite";
  EXPECT_EQ(run("--decimate 0.1 in.ply out.ply --force").status, 0);
  for (const char* arguments :
       {"--decimate 0 in.ply a.ply", "--decimate 2 in.ply a.ply", "--decimate 0.5 in.ply"})
    EXPECT_EQ(run(arguments).status, 2) << arguments;
  EXPECT_FALSE(std::filesystem::exists(folder() / "a.ply"));
}

TEST_F(Program, SaysWhyASoupIsNotDecimated) {
  if (!reads("ply")) GTEST_SKIP();
  write(generate("icosphere+unwelded", 1000, 1), folder() / "soup.ply");
  const Result soup = run("--decimate 0.1 soup.ply a.ply");
  EXPECT_EQ(soup.status, 0);
  EXPECT_NE(soup.output.find("--weld joins them first"), std::string::npos) << soup.output;
  write(generate("icosphere", 1000, 1), folder() / "ball.ply");
  const Result ball = run("--decimate 0.5 ball.ply b.ply");
  EXPECT_EQ(ball.output.find("--weld"), std::string::npos) << ball.output;
  EXPECT_EQ(ball.output.find("cross"), std::string::npos) << ball.output;
  const Result joined = run("--decimate 0.5 soup.ply c.ply --weld");
  EXPECT_EQ(joined.status, 0) << joined.output;
  EXPECT_EQ(joined.output.find("--weld"), std::string::npos) << joined.output;
  EXPECT_LE(2 * read(folder() / "c.ply").size(), read(folder() / "soup.ply").size());
  EXPECT_EQ(run("--check c.ply").status, 0);
  EXPECT_EQ(run("--weld --check c.ply").status, 2);
}

TEST_F(Program, SaysWhereADecimatedMeshCrossesItself) {
  if (!reads("ply")) GTEST_SKIP();
  // Two balls that run through each other still do with half the faces.
  Dataset two = generate("icosphere", 1000, 1);
  const auto n = static_cast<std::uint32_t>(two.mesh.vertices.size());
  for (std::uint32_t v = 0; v < n; ++v) {
    const geometry::Vec3f p = two.mesh.vertices[v];
    two.mesh.vertices.push_back({p[0] + 0.5f, p[1] + 0.25f, p[2]});
  }
  const auto faces = two.mesh.faces;
  for (const auto& f : faces) two.mesh.faces.push_back({f[0] + n, f[1] + n, f[2] + n});
  write(two, folder() / "two.ply");
  const Result made = run("--decimate 0.5 two.ply a.ply");
  EXPECT_EQ(made.status, 0);
  EXPECT_NE(made.output.find("pairs of faces cross or overlap after"), std::string::npos) << made.output;
}

}  // namespace
}  // namespace treeline::datasets
