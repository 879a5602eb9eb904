// Columns of faces above a point: on coarse grids, where points share lines and planes with everything.
#include <gtest/gtest.h>

#include <limits>

#include "geometry/exact/column_grid.hpp"
#include "geometry/random.hpp"

namespace treeline::geometry {
namespace {

Vec3f on_grid(Pcg32& random, std::uint32_t cells) {
  return {static_cast<float>(random.below(cells)), static_cast<float>(random.below(cells)),
          static_cast<float>(random.below(cells))};
}

/// By four orientations: 1 strictly inside, 0 on the surface, -1 outside.
int in_tetrahedron(const std::array<Triangle3f, 4>& faces, const Vec3f& p) {
  int most = -1;
  for (const Triangle3f& t : faces) most = std::max(most, orientation(t.a, t.b, t.c, p));
  return -most;
}

TEST(Column, TellsTetrahedraOnAGrid) {
  Pcg32 random(1);
  std::size_t counts[3] = {};
  for (int i = 0; i < 3000; ++i) {
    const Vec3f a = on_grid(random, 5), b = on_grid(random, 5), c = on_grid(random, 5),
                d = on_grid(random, 5);
    const int side = orientation(a, b, c, d);
    if (side == 0) continue;
    std::array<Triangle3f, 4> faces{{{a, c, b}, {a, b, d}, {b, c, d}, {c, a, d}}};
    if (side < 0)
      for (Triangle3f& t : faces) std::swap(t.b, t.c);
    for (int j = 0; j < 20; ++j) {
      Vec3f p = on_grid(random, 5);
      if (j % 2 == 0) p = p * 0.5f + on_grid(random, 5) * 0.5f;
      int winding = 0;
      bool on = false;
      for (const Triangle3f& t : faces) winding += column_crossing(p, t), on = on || is_on_triangle(p, t);
      const int expected = in_tetrahedron(faces, p);
      ++counts[expected + 1];
      ASSERT_EQ(on, expected == 0);
      if (!on) {
        ASSERT_EQ(winding, expected > 0 ? 1 : 0);
      }
    }
  }
  for (const std::size_t n : counts) EXPECT_GT(n, 500u);
}

// Faces that share an edge, seen from straight below it: the column passes one of them.
TEST(Column, SharedEdgesAreCrossedOnce) {
  const Vec3f a{0, 0, 1}, b{2, 0, 1}, c{2, 2, 2}, d{0, 2, 0.5f};
  for (const Vec3f p : {Vec3f{1, 1, 0}, Vec3f{0, 0, 0}, Vec3f{2, 2, 0}, Vec3f{0, 1, 0}, Vec3f{1, 0, 0}}) {
    const int one = column_crossing(p, {a, b, c}) + column_crossing(p, {a, c, d});
    EXPECT_LE(one, 1);
    // The point is moved along x, then along y: from the lower left corner into the square.
    EXPECT_EQ(one, p[0] < 2 && p[1] < 2 ? 1 : 0) << p[0] << " " << p[1];
    EXPECT_EQ(column_crossing(p, {a, c, b}) + column_crossing(p, {a, d, c}), -one);
  }
  EXPECT_EQ(column_crossing({1, 1, 3}, {a, b, c}), 0);                                    // above it
  EXPECT_EQ(column_crossing({1, 0, 0}, Triangle3f{{0, 0, 1}, {2, 0, 1}, {1, 0, 3}}), 0);  // edge-on
}

TEST(Column, PointsOnTrianglesWithoutArea) {
  const Triangle3f segment{{0, 0, 0}, {2, 2, 2}, {1, 1, 1}}, point{{1, 2, 3}, {1, 2, 3}, {1, 2, 3}};
  EXPECT_TRUE(is_on_triangle({0.5f, 0.5f, 0.5f}, segment));
  EXPECT_FALSE(is_on_triangle({0.5f, 0.5f, std::nextafter(0.5f, 1.0f)}, segment));
  EXPECT_TRUE(is_on_triangle({1, 2, 3}, point));
  EXPECT_FALSE(is_on_triangle({1, 2, std::nextafter(3.0f, 4.0f)}, point));
}

/// The corners of a tetrahedron, and what is inside of it on the left of each face.
void add_tetrahedron(Mesh3f& mesh, const std::array<Vec3f, 4>& corners, bool inside_out) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), corners.begin(), corners.end());
  const bool turned = (orientation(corners[0], corners[1], corners[2], corners[3]) < 0) != inside_out;
  for (std::array<std::uint32_t, 3> f :
       {std::array{0u, 2u, 1u}, std::array{0u, 1u, 3u}, std::array{1u, 2u, 3u}, std::array{2u, 0u, 3u}}) {
    if (turned) std::swap(f[1], f[2]);
    mesh.faces.push_back({first + f[0], first + f[1], first + f[2]});
  }
}

// Many solids that cross, some of them inside out: a point is enclosed by as many as hold it.
TEST(ColumnGrid, CountsHowManySolidsHoldAPoint) {
  Pcg32 random(4);
  Mesh3f mesh;
  std::vector<std::array<Vec3f, 4>> solids;
  std::vector<int> counts_as;
  while (solids.size() < 60) {
    std::array<Vec3f, 4> c;
    const Vec3f middle = on_grid(random, 30);
    for (Vec3f& p : c) p = middle + on_grid(random, 24);
    if (orientation(c[0], c[1], c[2], c[3]) == 0) continue;
    counts_as.push_back(solids.size() % 5 == 0 ? -1 : 1);
    add_tetrahedron(mesh, c, counts_as.back() < 0);
    solids.push_back(c);
  }
  mesh.vertices.push_back({std::numeric_limits<float>::quiet_NaN(), 0, 0});
  mesh.faces.push_back({0, 1, static_cast<std::uint32_t>(mesh.vertices.size() - 1)});  // left out
  const ColumnGrid columns(mesh);
  std::size_t seen[4] = {};  // on a face, enclosed -1 times, 0 times, more
  for (int i = 0; i < 20000; ++i) {
    const Vec3f p = on_grid(random, 52) + (i % 2 ? Vec3f{0.25f, 0.5f, 0.125f} : Vec3f{});
    int expected = 0;
    bool on = false;
    for (std::size_t s = 0; s < solids.size(); ++s) {
      auto c = solids[s];
      if (orientation(c[0], c[1], c[2], c[3]) < 0) std::swap(c[0], c[1]);
      const int where = in_tetrahedron(
          {{{c[0], c[2], c[1]}, {c[0], c[1], c[3]}, {c[1], c[2], c[3]}, {c[2], c[0], c[3]}}}, p);
      on = on || where == 0, expected += where > 0 ? counts_as[s] : 0;
    }
    const Enclosure found = columns(p);
    ASSERT_EQ(found.on_surface, on);
    if (!on) {
      ASSERT_EQ(found.winding, expected);
    }
    ++seen[on ? 0 : expected < 0 ? 1 : expected == 0 ? 2 : 3];
  }
  for (const std::size_t n : seen) EXPECT_GT(n, 20u);
}

TEST(ColumnGrid, FacesOfNoAreaBoundNothing) {
  Mesh3f mesh;
  add_tetrahedron(mesh, {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, false);
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), {{0.75f, 0.75f, 0}, {1, 1, 0}, {2, 2, 0}});
  mesh.faces.push_back({first, first + 1, first + 2}), mesh.faces.push_back({first + 1, first, first + 2});
  const ColumnGrid columns(mesh);
  EXPECT_FALSE(columns(Vec3f{1, 1, 0}).on_surface);
  EXPECT_EQ(columns(Vec3f{1, 1, 0}).winding, 0);
  EXPECT_TRUE(columns(Vec3f{0.25f, 0.25f, 0}).on_surface);
}

TEST(ColumnGrid, HoldsNothingWhereThereAreNoFaces) {
  const Mesh3f none;
  EXPECT_EQ(ColumnGrid(none)(Vec3f{1, 2, 3}).winding, 0);
  EXPECT_FALSE(ColumnGrid(none)(Vec3d{}).on_surface);
}

}  // namespace
}  // namespace treeline::geometry
