// Damage, slivers and decimation: each does what its name says, in the amount asked for, and nothing else.
#include "datasets_gen/meshes/damage.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "datasets_gen/diagnosis.hpp"
#include "datasets_gen/loss.hpp"

namespace treeline::datasets {
namespace {

using geometry::Mesh3f;

const Mesh3f& ball() {
  static const Mesh3f mesh = generate("icosphere", 5000, 1).mesh;  // 5120 faces
  return mesh;
}
Mesh3f damaged_ball(const std::string& name, std::uint64_t seed = 3) {
  return damaged(ball(), damage_named(name), seed);
}

TEST(Damage, HitsAsManyFacesAsAskedFor) {
  EXPECT_EQ(damaged_ball("missing_1").size(), 5120u - 51);
  EXPECT_EQ(damaged_ball("duplicated_1").size(), 5120u + 51);
  EXPECT_EQ(damaged_ball("hole_2").size(), 5120u - 102);
  EXPECT_EQ(damaged_ball("degenerate_1").size(), 5120u + 2 * 26);
  EXPECT_EQ(damaged_ball("missing_0.0001").size(), 5119u);
  std::size_t flipped = 0;
  const Mesh3f m = damaged_ball("flipped_10");
  ASSERT_EQ(m.size(), 5120u);
  for (std::size_t f = 0; f < m.size(); ++f) {
    flipped += m.faces[f] != ball().faces[f];
    EXPECT_EQ(std::set(m.faces[f].begin(), m.faces[f].end()),
              std::set(ball().faces[f].begin(), ball().faces[f].end()));
  }
  EXPECT_EQ(flipped, 512u);
}

TEST(Damage, IsOfTheKindThatItsNameSays) {
  const auto check = [](const std::string& name) { return geometry::check_mesh(damaged_ball(name)); };
  const auto hole = check("hole_2");
  EXPECT_EQ(hole.boundary_loops, 1u);
  EXPECT_EQ(hole.components, 1u);
  EXPECT_GT(check("missing_1").boundary_loops, 40u);
  const auto flipped = check("flipped_1");
  EXPECT_TRUE(flipped.closed);
  EXPECT_GT(flipped.misoriented_edges.count, 2u * 51);  // three a face, where no two are neighbours
  EXPECT_LE(flipped.misoriented_edges.count, 3u * 51);
  EXPECT_EQ(check("duplicated_1").duplicate_faces.count, 51u);
  const auto slits = check("degenerate_1");
  EXPECT_EQ(slits.degenerate_faces.count, 52u);
  EXPECT_TRUE(slits.closed && slits.oriented);
  EXPECT_EQ(slits.non_manifold_edges.count + slits.non_manifold_vertices.count, 0u);
  EXPECT_EQ(slits.duplicate_vertices.count, 26u);
  const auto whole = geometry::check_mesh(ball());
  EXPECT_DOUBLE_EQ(slits.volume, whole.volume);
  const auto soup = check("unwelded");
  EXPECT_EQ(soup.components, 5120u);
  EXPECT_TRUE(soup.welded.closed && soup.welded.oriented);
  EXPECT_EQ(soup.welded.vertices, ball().vertices.size());
  EXPECT_DOUBLE_EQ(check("inside_out").volume, -whole.volume);
  const auto nested = check("nested");
  EXPECT_EQ(nested.components, 2u);
  EXPECT_NEAR(nested.volume, whole.volume * (1 + 1 / 8.0), 1e-5 * whole.volume);
  EXPECT_EQ(diagnose(damaged_ball("nested"), 1, 1).crossings.count, 0u);
}

TEST(Damage, IsTheSameForTheSameSeedAndAnotherForAnother) {
  for (const char* name : {"hole_2", "missing_1", "flipped_10", "duplicated_1", "degenerate_1"}) {
    EXPECT_EQ(damaged_ball(name).faces, damaged_ball(name).faces);
    EXPECT_NE(damaged_ball(name, 3).faces, damaged_ball(name, 4).faces) << name;
  }
}

TEST(Damage, IsPartOfADatasetsName) {
  const Dataset d = generate("icosphere+hole_2+unwelded", 5000, 1);
  EXPECT_EQ(d.name, "icosphere+hole_2+unwelded");
  EXPECT_FALSE(d.closed);
  EXPECT_EQ(d.mesh.vertices.size(), 3 * d.mesh.size());
  EXPECT_TRUE(generate("icosphere+inside_out", 5000, 1).closed);
  EXPECT_FALSE(generate("icosphere+flipped_1", 5000, 1).closed);
  // One name, one content, on every machine.
  EXPECT_EQ(generate("icosphere+flipped_10", 5000, 7).hash(), 0x5d770cc67d07c381ull);
  EXPECT_EQ(generate("needles", 5000, 7).hash(), 0xfab052524ffa6343ull);
  EXPECT_EQ(generate("caps", 5000, 7).hash(), 0x0ce51b68ef98c6efull);
  for (const char* name :
       {"icosphere+", "icosphere+dent_3", "icosphere+hole", "icosphere+hole_0", "icosphere+hole_101",
        "icosphere+hole_2x", "icosphere+unwelded_3", "grid+unwelded", "cubes+hole_2"})
    EXPECT_THROW(generate(name, 5000, 1), std::invalid_argument) << name;
  EXPECT_THROW(damaged({}, {DamageKind::unwelded}, 1), std::invalid_argument);
  EXPECT_THROW(damaged(ball(), {DamageKind::hole, 0}, 1), std::invalid_argument);
}

TEST(Slivers, AreThinFromTenToAHundredThousand) {
  for (const std::string name : {"needles", "caps"}) {
    const Dataset d = generate(name, 20'000, 1);
    ASSERT_EQ(d.size(), 20'000u);
    std::size_t decades[7] = {};
    for (std::size_t i = 0; i < d.size(); ++i) {
      const geometry::Triangle3d t(d.mesh.triangle(i));
      double sides[3] = {length(t.b - t.a), length(t.c - t.b), length(t.a - t.c)};
      std::sort(sides, sides + 3);
      // Longest side over height.
      const double aspect = sides[2] * sides[2] / (2 * t.area() + 1e-30);
      ++decades[std::clamp(static_cast<int>(std::log10(aspect)), 0, 6)];
      if (name == "needles") {
        EXPECT_LT(sides[0], 0.11 * sides[2]);
      } else {
        EXPECT_GT(sides[0], 0.1 * sides[2]);
      }
      for (const auto& p : {t.a, t.b, t.c})
        for (int k = 0; k < 3; ++k) ASSERT_LE(std::abs(p[k]), 1);
    }
    for (int k = 1; k <= 4; ++k) EXPECT_GT(decades[k], 2000u) << name << " " << k;
  }
}

TEST(Decimation, ReachesItsShareAndStaysNearTheSurface) {
  if (!has_half_edges()) GTEST_SKIP() << "built without OpenMesh";
  const double volume = geometry::check_mesh(ball()).volume;
  double last = 0;
  for (const double ratio : {0.5, 0.25, 0.1, 0.05}) {
    const Decimated d = decimated(ball(), ratio);
    EXPECT_TRUE(d.input.faithful());
    EXPECT_LE(static_cast<double>(d.mesh.size()), ratio * 5120);
    EXPECT_GE(static_cast<double>(d.mesh.size()), ratio * 5120 - 2);  // a collapse takes two
    const auto check = geometry::check_mesh(d.mesh);
    EXPECT_TRUE(check.closed && check.oriented);
    const double error = std::abs(check.volume - volume);
    EXPECT_LT(error, 0.03 * volume) << ratio;
    EXPECT_GE(error, last) << "less mesh, more error";
    last = error;
  }
  EXPECT_EQ(decimated(ball(), 1).mesh.size(), 5120u);
  for (const double ratio : {0.0, -1.0, 1.5, std::nan("")})
    EXPECT_THROW(decimated(ball(), ratio), std::invalid_argument);
  Mesh3f odd = ball();
  odd.vertices[9][1] = std::numeric_limits<float>::infinity();
  EXPECT_THROW(decimated(odd, 0.5), std::invalid_argument);
}

// A cube of side 2 beside one of side 1 that is gone, and the same cube with a corner pulled in.
TEST(Losses, HaveTheirClosedForms) {
  const auto cube = [](float low, float high) {
    Mesh3f m;
    for (int i = 0; i < 8; ++i)
      m.vertices.push_back({i & 1 ? high : low, i & 2 ? high : low, i & 4 ? high : low});
    m.faces = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
               {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
    return m;
  };
  const Mesh3f one = cube(-1, 1);
  Mesh3f two = one;
  const Mesh3f other = cube(3, 4);
  two.vertices.insert(two.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (const auto& f : other.faces) two.faces.push_back({f[0] + 8, f[1] + 8, f[2] + 8});
  const Loss same = loss(one, one, 1), less = loss(two, one, 1);
  EXPECT_EQ(same.farthest, 0);
  EXPECT_EQ(same.area, 24);
  EXPECT_EQ(same.volume_left, 8);
  EXPECT_EQ(same.crossings, 0u);
  EXPECT_EQ(less.parts, 2u);
  EXPECT_EQ(less.parts_left, 1u);
  EXPECT_EQ(less.area - less.area_left, 6);
  EXPECT_EQ(less.volume - less.volume_left, 1);
  EXPECT_NEAR(less.farthest, std::sqrt(27.0), 1e-6);
  EXPECT_NEAR(less.diagonal, std::sqrt(75.0), 1e-6);
  Mesh3f open = one;
  open.faces.pop_back();
  EXPECT_TRUE(std::isnan(loss(one, open, 1).volume_left));
  EXPECT_NE(as_text(loss(one, open, 1)).find("no longer closed"), std::string::npos);
  EXPECT_TRUE(std::isinf(loss(one, Mesh3f{}, 1).farthest));
}

TEST(HalfEdges, WhatOpenMeshDoesToNonManifoldInputIsReported) {
  if (!has_half_edges()) GTEST_SKIP() << "built without OpenMesh";
  EXPECT_TRUE(half_edge_report(ball()).faithful());
  // A third face on an edge gets three vertices of its own, and so three boundary edges.
  Mesh3f fin = ball();
  fin.vertices.push_back({2, 2, 2});
  fin.faces.push_back(
      {fin.faces[0][0], fin.faces[0][1], static_cast<std::uint32_t>(fin.vertices.size() - 1)});
  EXPECT_EQ(half_edge_report(fin).copied_vertices, 3u);
  EXPECT_EQ(half_edge_report(fin).boundary_edges, 3u);
  Mesh3f flat = ball();
  flat.faces.push_back({0, 0, 1});
  EXPECT_EQ(half_edge_report(flat).lost_faces, 1u);
}

TEST(Diagnosis, IsCleanOnlyWhereNothingIsFound) {
  EXPECT_TRUE(diagnose(ball(), 5, 1).clean());
  for (const char* name : {"hole_2", "missing_1", "flipped_1", "duplicated_1", "degenerate_1", "unwelded",
                           "inside_out", "nested"})
    EXPECT_FALSE(diagnose(damaged_ball(name), 5, 1).clean()) << name;
}

// What the lines of a diagnosis say follows from one another: open means edges with an odd number of faces,
// borders mean edges with one. Each damage, with and without others.
TEST(Diagnosis, DoesNotContradictItself) {
  for (const char* name : {"hole_2", "missing_1", "flipped_1", "duplicated_1", "degenerate_1", "unwelded",
                           "inside_out", "nested", "duplicated_5+hole_2", "missing_1+duplicated_10",
                           "flipped_10+duplicated_10", "duplicated_10+unwelded", "hole_2+degenerate_5"}) {
    SCOPED_TRACE(name);
    Dataset d = generate("icosphere+" + std::string(name), 2000, 1);
    const Diagnosis found = diagnose(d.mesh, 1, 1);
    const geometry::MeshCheck& m = found.mesh;
    EXPECT_EQ(m.closed, m.odd_edges == 0);
    EXPECT_EQ(m.oriented, m.misoriented_edges.count == 0);
    EXPECT_EQ(m.boundary_loops > 0, m.boundary_edges.count > 0);
    EXPECT_LE(m.boundary_loops, m.boundary_edges.count);
    EXPECT_GE(m.odd_edges, m.boundary_edges.count);
    EXPECT_LE(m.odd_edges, m.boundary_edges.count + m.non_manifold_edges.count);
    EXPECT_EQ(m.welded.closed, m.welded.odd_edges == 0);
    EXPECT_EQ(m.welded.oriented, m.welded.misoriented_edges == 0);
    EXPECT_GE(m.welded.odd_edges, m.welded.boundary_edges);
    const std::string text = as_text(d, found);
    EXPECT_EQ(text.find("closed: yes") != std::string::npos,
              m.closed || (m.duplicate_vertices.count > 0 && m.welded.closed));
    const auto json = nlohmann::json::parse(as_json(d, found));
    EXPECT_EQ(json["odd_edges"], m.odd_edges);
    EXPECT_EQ(json["welded"]["odd_edges"], m.welded.odd_edges);
  }
}

// Two triangles that meet along x = 1/4 … 3/4 of a line, away from every corner.
TEST(Diagnosis, TellsWhereFacesCross) {
  Dataset d;
  d.mesh = {{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {0.25f, 1, -1}, {0.75f, 1, -1}, {0.5f, 1, 1}},
            {{0, 1, 2}, {3, 4, 5}}};
  const Diagnosis found = diagnose(d.mesh, 3, 1);
  ASSERT_EQ(found.crossings.count, 1u);
  const auto json = nlohmann::json::parse(as_json(d, found));
  const auto at = json["self_intersections"]["first"][0]["positions"][0];
  EXPECT_NEAR(at[1].get<double>(), 1, 1e-12);
  EXPECT_NEAR(at[2].get<double>(), 0, 1e-12);
  EXPECT_TRUE(at[0] > 0.37 && at[0] < 0.63) << at;  // 3/8 … 5/8
  const std::string text = as_text(d, found);
  EXPECT_NE(text.find("face 0, face 1 meet at ("), std::string::npos) << text;
  EXPECT_NE(text.find("count from 0"), std::string::npos) << text;
  const Dataset clean = generate("icosphere", 1000, 1);
  EXPECT_EQ(as_text(clean, diagnose(clean.mesh, 3, 1)).find("count from 0"), std::string::npos);
}

TEST(Diagnosis, IsValidJsonWithTheSameCounts) {
  Dataset d = generate("icosphere+duplicated_1", 5000, 1);
  d.name = "a \"name\" with \\ and \n";
  d.mesh.vertices.push_back({std::numeric_limits<float>::quiet_NaN(), 0, 0});
  const Diagnosis found = diagnose(d.mesh, 3, 1);
  const auto json = nlohmann::json::parse(as_json(d, found));
  EXPECT_EQ(json["file"], d.name);
  EXPECT_EQ(json["duplicate_faces"]["count"], 51);
  EXPECT_EQ(json["duplicate_faces"]["first"].size(), 3u);
  EXPECT_TRUE(json["non_finite_vertices"]["first"][0]["positions"][0][0].is_null());
  EXPECT_EQ(json["clean"], false);
  const std::string text = as_text(d, found);
  EXPECT_NE(text.find("51  faces that are there already"), std::string::npos) << text;
}

}  // namespace
}  // namespace treeline::datasets
