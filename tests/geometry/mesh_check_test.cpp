// The diagnosis of meshes, by meshes whose defects are put in by hand and counted by hand.
#include "geometry/mesh_check.hpp"

#include <gtest/gtest.h>

#include "accel/self_intersections.hpp"
#include "geometry/crossing_point.hpp"
#include "tests/geometry/meshes.hpp"

namespace treeline::test {
namespace {

accel::SelfIntersections crossings(const Mesh3f& mesh, int threads = 1) {
  return accel::self_intersections(mesh, check_mesh(mesh).sound_faces, {.kept = 1000, .threads = threads});
}
Mesh3f joined(Mesh3f a, const Mesh3f& b) {
  const auto first = static_cast<std::uint32_t>(a.vertices.size());
  a.vertices.insert(a.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (auto f : b.faces) a.faces.push_back({f[0] + first, f[1] + first, f[2] + first});
  return a;
}

TEST(MeshCheck, FindsNothingWrongWithClosedMeshes) {
  for (const Mesh3f& mesh :
       {octahedron<float>(), sphere<float>(4), cube<float>(3), spiky<float>(3, 1), torus<float>(40, 20)}) {
    const MeshCheck c = check_mesh(mesh);
    EXPECT_TRUE(c.closed && c.oriented && !c.inside_out());
    for (const Finding* f :
         {&c.non_finite_vertices, &c.unused_vertices, &c.duplicate_vertices, &c.repeated_corner_faces,
          &c.degenerate_faces, &c.duplicate_faces, &c.boundary_edges, &c.non_manifold_edges,
          &c.misoriented_edges, &c.non_manifold_vertices})
      EXPECT_EQ(f->count, 0u);
    EXPECT_EQ(c.components, 1u);
    EXPECT_EQ(c.sound_faces.size(), mesh.size());
    EXPECT_EQ(c.edges * 2, mesh.size() * 3);
    EXPECT_EQ(crossings(mesh).count, 0u);
  }
}

TEST(MeshCheck, VolumesHaveTheirClosedForms) {
  EXPECT_DOUBLE_EQ(check_mesh(cube<float>(2)).volume, 8);
  EXPECT_NEAR(check_mesh(octahedron<float>()).volume, 4.0 / 3, 1e-15);
  // Far from the origin, too, where corners are exact.
  EXPECT_DOUBLE_EQ(check_mesh(moved(cube<float>(2), {1024, -4096, 512})).volume, 8);
  Mesh3f inside_out = cube<float>(1);
  for (auto& f : inside_out.faces) std::swap(f[0], f[1]);
  EXPECT_DOUBLE_EQ(check_mesh(inside_out).volume, -8);
  EXPECT_TRUE(check_mesh(inside_out).inside_out());
  // A hollow cube: the inner one looks inward.
  const MeshCheck hollow = check_mesh(joined(cube<float>(1), moved(inside_out, {}, 0.5f)));
  EXPECT_DOUBLE_EQ(hollow.volume, 8 - 1);
  EXPECT_EQ(hollow.components, 2u);
  EXPECT_EQ(hollow.inward_components, 1u);
}

TEST(MeshCheck, FindsPartsThatLookTheWrongWay) {
  const Mesh3f outward = sphere<float>(2);
  Mesh3f inward = outward;
  for (auto& f : inward.faces) std::swap(f[0], f[1]);
  const auto misnested = [](const Mesh3f& m) { return check_mesh(m).misnested_components.count; };
  const auto small = [](const Mesh3f& m) { return moved(m, {}, 0.5f); };
  const auto tiny = [](const Mesh3f& m) { return moved(m, {}, 0.25f); };
  const auto aside = [](const Mesh3f& m) { return moved(m, {3, 0, 0}); };
  EXPECT_EQ(misnested(joined(outward, small(inward))), 0u);
  EXPECT_EQ(misnested(joined(joined(outward, small(inward)), tiny(outward))), 0u);
  EXPECT_EQ(misnested(joined(outward, aside(outward))), 0u);
  EXPECT_EQ(misnested(joined(outward, aside(inward))), 1u);
  // Boxes that touch, and one flush in another, whichever face comes first.
  const auto box = [](const geometry::Vec3f& low, const geometry::Vec3f& high, std::size_t first) {
    Mesh3f m;
    for (std::uint32_t i = 0; i < 8; ++i)
      m.vertices.push_back({i & 1 ? high[0] : low[0], i & 2 ? high[1] : low[1], i & 4 ? high[2] : low[2]});
    m.faces = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
               {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    std::ranges::rotate(m.faces, m.faces.begin() + static_cast<std::ptrdiff_t>(first));
    return m;
  };
  for (std::size_t i = 0; i < 12; ++i) {
    const Mesh3f below = box({0, 0, 0}, {4, 4, 4}, 0);
    EXPECT_EQ(misnested(joined(below, box({1, 1, 4}, {3, 3, 6}, i))), 0u) << i;
    EXPECT_EQ(misnested(joined(box({1, 1, 4}, {3, 3, 6}, i), below)), 0u) << i;
    EXPECT_GE(misnested(joined(below, box({1, 1, 0}, {3, 3, 1}, i))), 1u) << i;
  }
  const MeshCheck both = check_mesh(joined(outward, small(outward)));
  EXPECT_EQ(both.misnested_components.count, 1u);
  EXPECT_EQ(both.misnested_components.first.at(0).faces, std::vector<std::uint32_t>{128});
}

TEST(MeshCheck, NamesWhatIsWrongAndWhere) {
  Mesh3f m = sphere<float>(2);  // 128 faces
  const auto n = static_cast<std::uint32_t>(m.vertices.size());
  m.vertices.push_back({9, 9, 9});                                        // n: used by nobody
  m.vertices.push_back(m.vertices[5]);                                    // n + 1: a copy of 5
  m.vertices.push_back({std::numeric_limits<float>::quiet_NaN(), 0, 0});  // n + 2
  m.faces.push_back({n + 1, n + 1, 3});                                   // 128: a corner twice
  m.faces.push_back({m.faces[7][2], m.faces[7][1], m.faces[7][0]});       // 129: face 7 the other way around
  m.faces.push_back({m.faces[9][0], n + 1, n + 2});                       // 130: with a NaN
  const MeshCheck c = check_mesh(m);
  const auto only = [](const Finding& f, std::vector<std::uint32_t> faces,
                       std::vector<std::uint32_t> vertices) {
    ASSERT_EQ(f.count, 1u);
    EXPECT_EQ(f.first.at(0).faces, faces);
    if (!vertices.empty()) {
      EXPECT_EQ(f.first[0].vertices, vertices);
    }
  };
  only(c.unused_vertices, {}, {n});
  only(c.duplicate_vertices, {}, {n + 1, 5});
  only(c.non_finite_vertices, {}, {n + 2});
  only(c.repeated_corner_faces, {128}, {n + 1, n + 1, 3});
  only(c.duplicate_faces, {129, 7}, {});
  EXPECT_EQ(c.non_manifold_edges.count, 3u);
  EXPECT_EQ(c.boundary_edges.count, 3u);
  EXPECT_FALSE(c.closed);
  EXPECT_EQ(c.sound_faces.size(), 128u);
}

TEST(MeshCheck, FlatFacesAreDegenerateWhateverTheirShape) {
  Mesh3f m{{{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}};
  const MeshCheck c = check_mesh(m);
  EXPECT_EQ(c.degenerate_faces.count, 1u);
  EXPECT_EQ(c.degenerate_faces.first.at(0).faces, std::vector<std::uint32_t>{0});
  EXPECT_EQ(c.sound_faces, std::vector<std::uint32_t>{1});
}

TEST(MeshCheck, TwoTetrahedraThatTouchAtAVertexOrEdge) {
  const Mesh3f one{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                   {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
  Mesh3f vertex = one;
  vertex.vertices.insert(vertex.vertices.end(), {{-1, 0, 0}, {0, -1, 0}, {0, 0, -1}});
  for (const auto& f : one.faces)  // mirrored through the origin
    vertex.faces.push_back({f[0] ? f[0] + 3 : 0, f[2] ? f[2] + 3 : 0, f[1] ? f[1] + 3 : 0});
  const MeshCheck v = check_mesh(vertex);
  EXPECT_EQ(v.components, 2u);
  ASSERT_EQ(v.non_manifold_vertices.count, 1u);
  EXPECT_EQ(v.non_manifold_vertices.first[0].vertices, std::vector<std::uint32_t>{0});
  EXPECT_EQ(v.non_manifold_edges.count, 0u);
  EXPECT_TRUE(v.closed && v.oriented);
  EXPECT_EQ(crossings(vertex).count, 0u);

  Mesh3f edge = one;  // mirrored through the edge from 0 to 3
  edge.vertices.insert(edge.vertices.end(), {{-1, 0, 0}, {0, -1, 0}});
  const std::uint32_t to[4] = {0, 4, 5, 3};
  for (const auto& f : one.faces) edge.faces.push_back({to[f[0]], to[f[1]], to[f[2]]});
  const MeshCheck e = check_mesh(edge);
  ASSERT_EQ(e.non_manifold_edges.count, 1u);
  EXPECT_EQ(e.non_manifold_edges.first[0].vertices, (std::vector<std::uint32_t>{0, 3}));
  EXPECT_EQ(e.non_manifold_edges.first[0].faces.size(), 4u);
  EXPECT_TRUE(e.closed);
  EXPECT_EQ(crossings(edge).count, 0u);
}

// Tents over a common ridge, each closed: which of their faces lie between which others tells whether they
// cross there.
TEST(MeshCheck, TellsCrossingsAlongEdgesFromTouches) {
  /// Between two directions from the ridge, in degrees, the second counter-clockwise of the first.
  const auto tent = [](double first, double second) {
    const auto at = [](double degrees, float y) {
      const double a = degrees * std::numbers::pi / 180;
      return Vec3f{static_cast<float>(std::cos(a)), y, static_cast<float>(std::sin(a))};
    };
    Mesh3f m;
    m.vertices = {{0, 0, 0}, {0, 1, 0}, at(first, 0), at(second, 0), at(first, 1), at(second, 1)};
    m.faces = {{0, 1, 4}, {0, 4, 2}, {0, 3, 5}, {0, 5, 1}, {2, 4, 5}, {2, 5, 3}, {0, 2, 3}, {1, 5, 4}};
    return m;
  };
  EXPECT_GT(check_mesh(tent(10, 70)).volume, 0);
  const auto turned = [](Mesh3f m) {
    for (auto& f : m.faces) std::swap(f[0], f[1]);
    return m;
  };
  const auto crossed = [](const Mesh3f& m) { return check_mesh(m).crossed_edges.count; };
  const Mesh3f one = tent(10, 70);
  EXPECT_EQ(crossed(one), 0u);
  for (const Mesh3f& other : {tent(40, 100), tent(20, 50)}) {  // across, and within
    EXPECT_EQ(crossed(joined(one, other)), 1u);
    EXPECT_EQ(crossed(joined(turned(one), turned(other))), 1u);
    const MeshCheck welded = check_mesh(geometry::welded(joined(one, other)).mesh);
    EXPECT_EQ(welded.crossed_edges.count, 1u);
    EXPECT_EQ(welded.crossed_edges.first[0].faces.size(), 4u);
  }
  for (const Mesh3f& other : {tent(100, 160), tent(190, 250), turned(tent(20, 50))})  // beside, and a hollow
    EXPECT_EQ(crossed(joined(one, other)), 0u);
  EXPECT_EQ(crossed(joined(joined(one, tent(100, 160)), tent(190, 250))), 0u);
  EXPECT_EQ(crossed(joined(joined(one, tent(100, 160)), tent(130, 250))), 1u);
}

TEST(Weld, UndoesASoupAndNothingElse) {
  const Mesh3f mesh = sphere<float>(3);
  const Welded<float> same = welded(mesh);
  EXPECT_EQ(same.mesh.faces, mesh.faces);
  EXPECT_EQ(same.joined + same.collapsed, 0u);
  Mesh3f soup;
  for (std::size_t f = 0; f < mesh.size(); ++f) {
    const auto n = static_cast<std::uint32_t>(soup.vertices.size());
    for (const std::uint32_t v : mesh.faces[f]) soup.vertices.push_back(mesh.vertices[v]);
    soup.faces.push_back({n, n + 1, n + 2});
  }
  for (auto& p : soup.vertices)
    if (p[0] == 0) p[0] = -0.0f;
  const Welded<float> made = welded(soup);
  EXPECT_EQ(made.mesh.vertices.size(), mesh.vertices.size());
  EXPECT_EQ(made.joined, soup.vertices.size() - mesh.vertices.size());
  EXPECT_TRUE(check_mesh(made.mesh).closed && check_mesh(made.mesh).oriented);
  for (std::size_t f = 0; f < mesh.size(); ++f) EXPECT_EQ(made.mesh.triangle(f), mesh.triangle(f));
  // Faces that end up with a corner twice go; what is not finite is equal to nothing.
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const Mesh3f odd{{{0, 0, 0}, {1, 0, 0}, {-0.0f, 0, 0}, {nan, 0, 0}, {nan, 0, 0}}, {{0, 1, 2}, {0, 1, 3}}};
  EXPECT_EQ(welded(odd).collapsed, 1u);
  EXPECT_EQ(welded(odd).joined, 1u);
  EXPECT_EQ(welded(odd).mesh.faces, (std::vector<Mesh3f::Face>{{0, 1, 2}}));
  EXPECT_THROW(welded(Mesh3f{{{0, 0, 0}}, {{0, 0, 9}}}), std::out_of_range);
}

TEST(SelfIntersections, AreThoseOfAllPairs) {
  Pcg32 random(5);
  Mesh3f soup;
  for (std::uint32_t i = 0; i < 600; ++i) {
    const Vec3f at = random_vec<float>(random);
    const float size = i % 50 == 0 ? 2.f : 0.2f;
    for (int k = 0; k < 3; ++k) soup.vertices.push_back(at + random_vec<float>(random) * size);
    soup.faces.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  for (const Mesh3f& mesh : {soup, joined(sphere<float>(3), moved(sphere<float>(3), {0.5f, 0.25f, 0})),
                             joined(cube<float>(1), moved(cube<float>(1), {0.25f, 0, 0})),
                             joined(sheet<float>(3, 0), moved(sheet<float>(3, 0), {0.125f, 0, 0}))}) {
    std::vector<accel::SelfIntersections::Pair> expected;
    const auto sound = check_mesh(mesh).sound_faces;
    for (const std::uint32_t i : sound)
      for (const std::uint32_t j : sound)
        if (i < j && cross_each_other(mesh.triangle(i), mesh.triangle(j))) expected.push_back({i, j});
    EXPECT_GT(expected.size(), 50u);
    for (const int threads : {1, 3}) {
      const auto found = accel::self_intersections(mesh, sound, {.kept = 100'000, .threads = threads});
      EXPECT_EQ(found.pairs, expected);
      EXPECT_EQ(found.count, expected.size());
      const auto few = accel::self_intersections(mesh, sound, {.kept = 7, .threads = threads});
      EXPECT_EQ(few.count, expected.size());
      EXPECT_TRUE(std::ranges::equal(few.pairs, std::span(expected).first(7)));
    }
  }
}

TEST(CrossingPoint, LiesOnBothTriangles) {
  for (const Mesh3f& mesh : {joined(sphere<float>(3), moved(sphere<float>(3), {0.5f, 0.25f, 0})),
                             joined(cube<float>(1), moved(cube<float>(1), {0.25f, 0, 0})),
                             joined(cube<float>(1), moved(cube<float>(1), {0.25f, 0.5f, 0.75f})),
                             joined(sheet<float>(3, 0), moved(sheet<float>(3, 0), {0.125f, 0, 0}))}) {
    const auto found = crossings(mesh);
    ASSERT_GT(found.count, 10u);
    for (const auto& [i, j] : found.pairs) {
      const Triangle3f a = mesh.triangle(i), b = mesh.triangle(j);
      const Vec3d p = crossing_point(a, b);
      for (const Triangle3f& t : {a, b})
        EXPECT_LT(closest_point_on_triangle(p, Triangle3d(t)).distance2, 1e-28) << i << " " << j;
    }
  }
}

TEST(CrossingPoint, IsWhereClosedFormsSay) {
  const Triangle3f flat{{0, 0, 0}, {8, 0, 0}, {0, 8, 0}};
  // Upright, with one corner below at (1, 2, -1): it cuts the plane from (1, 2, 0) on along y = 2.
  const Vec3d through = crossing_point(flat, {{1, 2, -1}, {1, 2, 1}, {3, 2, 1}});
  EXPECT_NEAR(through[1], 2, 1e-12);
  EXPECT_NEAR(through[2], 0, 1e-12);
  EXPECT_TRUE(through[0] > 1 - 1e-12 && through[0] < 2 + 1e-12);
  // A shared corner is none: the side across it meets the plane at (2, 3, 0).
  const Vec3d beyond = crossing_point(flat, {{0, 0, 0}, {2, 3, -1}, {2, 3, 1}});
  EXPECT_LT(distance(beyond, Vec3d{2, 3, 0}), 1e-12);
  // Only that corner of the second touches.
  const Vec3d touch = crossing_point({{5, 5, 5}, {2, 1, 0}, {6, 5, 5}}, flat);
  EXPECT_LT(distance(touch, Vec3d{2, 1, 0}), 1e-12);
}

TEST(SelfIntersections, RefuseFacesThatAreNotSound) {
  const Mesh3f m{{{0, 0, 0}, {1, 1, 1}, {2, 2, 2}}, {{0, 1, 2}, {0, 1, 9}}};
  for (const std::uint32_t face : {0u, 1u, 2u})
    EXPECT_THROW(accel::self_intersections(m, std::vector<std::uint32_t>{face}), accel::InvalidInput) << face;
  EXPECT_EQ(accel::self_intersections(m, {}).count, 0u);
}

}  // namespace
}  // namespace treeline::test
