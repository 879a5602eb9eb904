// Adjacency and what is built on it, silhouettes and pseudonormals, against OpenMesh's half-edges on manifold
// meshes, and by hand where OpenMesh refuses the input.
#include "geometry/adjacency.hpp"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <set>

#include "accel/signed_distance/pseudonormal.hpp"
#include "datasets_gen/dataset.hpp"
#include "tests/geometry/meshes.hpp"

namespace treeline::test {
namespace {

using HalfEdgeMesh = OpenMesh::TriMesh_ArrayKernelT<OpenMesh::DefaultTraitsDouble>;

HalfEdgeMesh half_edge_mesh(const Mesh3f& mesh) {
  HalfEdgeMesh r;
  std::vector<HalfEdgeMesh::VertexHandle> v;
  for (const auto& p : mesh.vertices) v.push_back(r.add_vertex({p[0], p[1], p[2]}));
  for (const auto& f : mesh.faces)
    if (!r.add_face(v[f[0]], v[f[1]], v[f[2]]).is_valid())
      throw std::runtime_error("OpenMesh refused a face");
  return r;
}

std::size_t boundary_loops(HalfEdgeMesh& mesh) {
  std::set<int> seen;
  std::size_t loops = 0;
  for (auto start : mesh.halfedges()) {
    if (!start.is_boundary() || seen.count(start.idx())) continue;
    ++loops;
    for (auto h = start; seen.insert(h.idx()).second;) h = h.next();
  }
  return loops;
}

void check_against_open_mesh(const Mesh3f& mesh) {
  HalfEdgeMesh other = half_edge_mesh(mesh);
  const Adjacency ours(mesh);
  ASSERT_EQ(ours.edges().size(), other.n_edges());
  std::size_t boundary = 0;
  for (auto e : other.edges()) boundary += e.is_boundary();
  EXPECT_EQ(ours.boundary_edges(), boundary);
  EXPECT_EQ(ours.closed(), boundary == 0);
  EXPECT_EQ(ours.boundary_loops(), boundary_loops(other));
  EXPECT_TRUE(ours.manifold());
  EXPECT_TRUE(ours.oriented());
  for (std::uint32_t f = 0; f < mesh.size(); ++f)
    for (int i = 0; i < 3; ++i) {
      const auto from = other.vertex_handle(mesh.faces[f][i]),
                 to = other.vertex_handle(mesh.faces[f][(i + 1) % 3]);
      const auto across = other.face_handle(other.opposite_halfedge_handle(other.find_halfedge(from, to)));
      EXPECT_EQ(ours.neighbour(f, i), across.is_valid() ? std::uint32_t(across.idx()) : Adjacency::none);
    }
}

TEST(Adjacency, ClosedMeshesAgreeWithOpenMesh) {
  check_against_open_mesh(octahedron<float>());
  check_against_open_mesh(sphere<float>(3));
  check_against_open_mesh(cube<float>(1));
  check_against_open_mesh(torus<float>(20, 8));
}

TEST(Adjacency, MeshesWithHolesAgreeWithOpenMesh) {
  const bool ok = rc::check([] {
    // Removes faces that share no vertex (each its own hole), or a connected half.
    Mesh3f mesh = *rc::gen::arbitrary<bool>() ? sphere<float>(2) : torus<float>(12, 7);
    Pcg32 random(*rc::gen::arbitrary<std::uint64_t>());
    std::set<std::uint32_t> used;
    const std::uint32_t tries = random.below(40);
    for (std::uint32_t i = 0; i < tries; ++i) {
      const std::uint32_t f = random.below(static_cast<std::uint32_t>(mesh.size()));
      const auto face = mesh.faces[f];
      if (used.count(face[0]) || used.count(face[1]) || used.count(face[2])) continue;
      used.insert(face.begin(), face.end());
      mesh.faces.erase(mesh.faces.begin() + f);
    }
    std::shuffle(mesh.faces.begin(), mesh.faces.end(), random);
    check_against_open_mesh(mesh);
    RC_ASSERT(!testing::Test::HasFailure());
    RC_ASSERT(Adjacency(mesh).boundary_loops() * 3 == used.size());
  });
  EXPECT_TRUE(ok);
}

/// Closed and open ones, made here and by the recipes.
std::vector<std::pair<std::string, Mesh3f>> generated_meshes() {
  std::vector<std::pair<std::string, Mesh3f>> r{
      {"sphere", sphere<float>(4)}, {"spiky", spiky<float>(3, 1)}, {"torus", torus<float>(24, 12)}};
  Mesh3f holed = sphere<float>(3);
  holed.faces.erase(holed.faces.begin() + 100, holed.faces.begin() + 180);
  r.push_back({"holed", holed});
  for (const char* name : {"icosphere", "torus_knot", "nested_shells", "terrain"})
    r.push_back({name, datasets::generate(name, 3000, 3).mesh});
  return r;
}

TEST(Adjacency, GeneratedMeshesAgreeWithOpenMesh) {
  for (const auto& [name, mesh] : generated_meshes()) {
    SCOPED_TRACE(name);
    check_against_open_mesh(mesh);
  }
}

using Ends = std::pair<std::uint32_t, std::uint32_t>;

/// Edges between a face turned to the eye and one turned away, decided exactly.
std::set<Ends> silhouette(const Mesh3f& mesh, const Adjacency& adjacency, const Vec3f& eye) {
  std::set<Ends> r;
  for (const Adjacency::Edge& edge : adjacency.edges()) {
    int turned_to = 0, turned_away = 0;
    for (const std::uint32_t h : adjacency.half_edges_of(edge)) {
      const Triangle3f t = mesh.triangle(Adjacency::face_of(h));
      (orientation(t.a, t.b, t.c, eye) > 0 ? turned_to : turned_away) += 1;
    }
    if (turned_to > 0 && turned_away > 0) r.insert({edge.vertices[0], edge.vertices[1]});
  }
  return r;
}

// OpenMesh finds the faces of an edge by half-edges, and looks at them by the normals it makes in double.
TEST(Adjacency, SilhouettesAgreeWithOpenMesh) {
  for (const auto& [name, mesh] : generated_meshes()) {
    SCOPED_TRACE(name);
    const HalfEdgeMesh other = half_edge_mesh(mesh);
    const Adjacency ours(mesh);
    Pcg32 random(17);
    std::size_t compared = 0, unclear = 0, seen = 0;
    for (int i = 0; i < 12; ++i) {
      // Around the mesh, and within its box.
      const Vec3f eye = mesh.box().centre() + random_vec<float>(random) * (i % 2 == 0 ? 3.f : 0.3f);
      const std::set<Ends> found = silhouette(mesh, ours, eye);
      seen += found.size();
      const HalfEdgeMesh::Point from(eye[0], eye[1], eye[2]);
      const auto height = [&](HalfEdgeMesh::HalfedgeHandle h) {
        const auto to_eye = from - other.point(other.to_vertex_handle(h));
        return dot(other.calc_face_normal(other.face_handle(h)), to_eye) / to_eye.norm();
      };
      for (const auto e : other.edges()) {
        if (e.is_boundary()) continue;
        const double one = height(e.h0()), two = height(e.h1());
        ++compared;
        if (std::min(std::abs(one), std::abs(two)) < 1e-9) {
          ++unclear;
          continue;
        }
        const Ends ends =
            std::minmax<std::uint32_t>({std::uint32_t(e.v0().idx()), std::uint32_t(e.v1().idx())});
        ASSERT_EQ(found.contains(ends), (one > 0) != (two > 0)) << ends.first << " " << ends.second;
      }
      if (!ours.closed()) continue;
      // Curves that end nowhere: an even number of edges at every vertex.
      std::map<std::uint32_t, int> at;
      for (const auto& [v, w] : found) ++at[v], ++at[w];
      for (const auto& [v, n] : at) ASSERT_EQ(n % 2, 0) << v;
    }
    EXPECT_LT(unclear, compared / 1000);
    EXPECT_GT(seen, 100u);
  }
}

TEST(Adjacency, PseudonormalsAgreeWithOpenMesh) {
  for (const auto& [name, mesh] : generated_meshes()) {
    SCOPED_TRACE(name);
    const HalfEdgeMesh other = half_edge_mesh(mesh);
    const accel::PseudonormalTable<float> table(mesh);
    const auto expect_same = [](const Vec3d& ours, const HalfEdgeMesh::Normal& sum) {
      const HalfEdgeMesh::Normal n = sum / sum.norm();
      ASSERT_LT(length(ours - Vec3d{n[0], n[1], n[2]}), 1e-9 / sum.norm());
    };
    for (std::uint32_t f = 0; f < mesh.size(); ++f)
      for (int i = 0; i < 3; ++i) {
        const auto at = other.vertex_handle(mesh.faces[f][i]),
                   to = other.vertex_handle(mesh.faces[f][(i + 1) % 3]);
        const auto edge = other.edge_handle(other.find_halfedge(at, to));
        HalfEdgeMesh::Normal of_edge(0, 0, 0), of_vertex(0, 0, 0);
        for (const unsigned side : {0u, 1u})
          if (const auto face = other.face_handle(other.halfedge_handle(edge, side)); face.is_valid())
            of_edge += other.calc_face_normal(face);
        for (const auto in : other.vih_range(at))
          if (!in.is_boundary()) of_vertex += other.calc_face_normal(in.face()) * other.calc_sector_angle(in);
        expect_same(table.edge_normal(f, std::size_t(i)), of_edge);
        expect_same(table.vertex_normal(f, std::size_t(i)), of_vertex);
      }
  }
}

// Closed formulas: a closed surface of genus g has V - E + F = 2 - 2g.
TEST(Adjacency, EulerCharacteristic) {
  const auto euler = [](const Mesh3f& m) {
    return int(m.vertices.size()) - int(Adjacency(m).edges().size()) + int(m.size());
  };
  EXPECT_EQ(euler(sphere<float>(3)), 2);
  EXPECT_EQ(euler(cube<float>(2)), 2);
  EXPECT_EQ(euler(torus<float>(9, 5)), 0);
}

TEST(Adjacency, FlippedFace) {
  Mesh3f mesh = sphere<float>(1);
  std::swap(mesh.faces[5][0], mesh.faces[5][1]);
  const Adjacency a(mesh);
  EXPECT_TRUE(a.closed());
  EXPECT_FALSE(a.oriented());
  EXPECT_EQ(a.misoriented_edges(), 3u);
  EXPECT_EQ(a.boundary_loops(), 0u);
}

TEST(Adjacency, FlippedFaceBesideAHoleLeavesOneLoop) {
  Mesh3f mesh = octahedron<float>();
  std::swap(mesh.faces[1][0], mesh.faces[1][1]);
  mesh.faces.erase(mesh.faces.begin());
  const Adjacency a(mesh);
  EXPECT_EQ(a.boundary_edges(), 3u);
  EXPECT_EQ(a.boundary_loops(), 1u);
  EXPECT_EQ(a.misoriented_edges(), 2u);
}

TEST(Adjacency, MoebiusBandHasOneLoopAndNoOrientation) {
  constexpr std::uint32_t n = 9;  // a strip of 2n triangles over 2n vertices, closed with a half turn
  Mesh3f mesh;
  mesh.vertices.resize(2 * n);
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t a = 2 * i, b = 2 * i + 1;
    const std::uint32_t c = i + 1 < n ? a + 2 : 1, d = i + 1 < n ? b + 2 : 0;
    mesh.faces.push_back({a, c, b}), mesh.faces.push_back({b, c, d});
  }
  const Adjacency a(mesh);
  EXPECT_EQ(a.boundary_edges(), 2 * n);
  EXPECT_EQ(a.boundary_loops(), 1u);
  EXPECT_TRUE(a.manifold());
  EXPECT_FALSE(a.oriented());
}

TEST(Adjacency, TwoTetrahedraOnOneEdge) {
  Mesh3f mesh;
  mesh.vertices.resize(6);
  mesh.faces = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}, {0, 4, 1}, {0, 1, 5}, {1, 4, 5}, {4, 0, 5}};
  const Adjacency a(mesh);
  EXPECT_EQ(a.non_manifold_edges(), 1u);
  EXPECT_TRUE(a.closed());
  EXPECT_TRUE(a.oriented());
  EXPECT_EQ(a.boundary_edges(), 0u);
  EXPECT_EQ(a.boundary_loops(), 0u);
}

TEST(Adjacency, ThreeFacesOnOneEdge) {
  Mesh3f mesh;
  mesh.vertices.resize(5);
  mesh.faces = {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}};
  const Adjacency a(mesh);
  EXPECT_EQ(a.non_manifold_edges(), 1u);
  EXPECT_FALSE(a.closed());
  EXPECT_EQ(a.boundary_edges(), 6u);
  EXPECT_EQ(a.odd_edges(), 7u);
  EXPECT_EQ(a.boundary_loops(), 2u);
  EXPECT_EQ(a.half_edges_of(a.edges()[0]).size(), 3u);
}

// A copy of a face leaves its edges odd, and the mesh open, but gives it no border.
TEST(Adjacency, CopiesOfFacesMakeNoLoops) {
  for (const bool turned : {false, true}) {
    Mesh3f mesh = octahedron<float>();
    auto copy = mesh.faces[3];
    if (turned) std::swap(copy[0], copy[1]);
    mesh.faces.push_back(copy);
    const Adjacency a(mesh);
    EXPECT_FALSE(a.closed());
    EXPECT_EQ(a.odd_edges(), 3u);
    EXPECT_EQ(a.non_manifold_edges(), 3u);
    EXPECT_EQ(a.boundary_edges(), 0u);
    EXPECT_EQ(a.boundary_loops(), 0u);
    // A hole elsewhere has the one loop there is.
    mesh.faces.erase(mesh.faces.begin() + 6);
    EXPECT_EQ(Adjacency(mesh).boundary_loops(), 1u);
  }
}

TEST(Adjacency, FacesThatRepeatAVertexBoundNothing) {
  Mesh3f mesh = octahedron<float>();
  mesh.faces.push_back({0, 2, 2});
  mesh.faces.push_back({1, 1, 1});
  const Adjacency a(mesh);
  EXPECT_EQ(a.repeated_vertex_faces(), 2u);
  EXPECT_TRUE(a.closed());
  EXPECT_TRUE(a.manifold());
  EXPECT_EQ(a.neighbour(8, 0), Adjacency::none);
}

TEST(Adjacency, EmptyMesh) {
  const Adjacency a(Mesh3f{});
  EXPECT_TRUE(a.edges().empty());
  EXPECT_TRUE(a.closed());
}

TEST(Adjacency, NamesAFaceWithAnIndexOutOfRange) {
  Mesh3f mesh = octahedron<float>();
  mesh.faces[4][1] = 6;
  try {
    Adjacency a(mesh);
    FAIL() << "accepted";
  } catch (const std::out_of_range& e) {
    EXPECT_STREQ(e.what(), "adjacency: face 4 refers to vertex 6, but there are 6 vertices");
  }
}

}  // namespace
}  // namespace treeline::test
