// Columns of faces above a point: on coarse grids, where points share lines and planes with everything.
#include <gtest/gtest.h>

#include "geometry/exact/column.hpp"
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
  EXPECT_EQ(column_crossing({1, 1, 3}, {a, b, c}), 0);                          // above it
  EXPECT_EQ(column_crossing({1, 0, 0}, {{0, 0, 1}, {2, 0, 1}, {1, 0, 3}}), 0);  // edge-on
}

TEST(Column, PointsOnTrianglesWithoutArea) {
  const Triangle3f segment{{0, 0, 0}, {2, 2, 2}, {1, 1, 1}}, point{{1, 2, 3}, {1, 2, 3}, {1, 2, 3}};
  EXPECT_TRUE(is_on_triangle({0.5f, 0.5f, 0.5f}, segment));
  EXPECT_FALSE(is_on_triangle({0.5f, 0.5f, std::nextafter(0.5f, 1.0f)}, segment));
  EXPECT_TRUE(is_on_triangle({1, 2, 3}, point));
  EXPECT_FALSE(is_on_triangle({1, 2, std::nextafter(3.0f, 4.0f)}, point));
}

}  // namespace
}  // namespace treeline::geometry
