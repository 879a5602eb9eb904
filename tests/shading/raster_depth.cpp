// The rasteriser against rays and planes in double, and the laws of what it covers.
#include <gtest/gtest.h>

#include <algorithm>

#include "accel/bvh.hpp"
#include "raster_common.hpp"
#include "shading/raster/cast_depth.hpp"

namespace treeline::shading::raster {
namespace {

using namespace test;
using Tree = accel::Bvh<accel::Triangles<double>>;
using FloatTree = accel::Bvh<accel::Triangles<float>, accel::Wide>;

Tree tree_of(const Mesh3f& mesh) {
  geometry::Mesh3d wide;
  for (const auto& p : mesh.vertices) wide.vertices.push_back(Vec3d(p));
  wide.faces = mesh.faces;
  return Tree(wide);
}

/// Distance of a point from the projected edges of a mesh, in texels, at most `limit`.
double distance_from_edges(const Mesh3f& mesh, const LightView& view, int side, double x, double y,
                           double limit) {
  double least = limit;
  for (const auto& face : mesh.faces)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto a = view.place(Vec3d(mesh.vertices[face[k]])),
                 b = view.place(Vec3d(mesh.vertices[face[(k + 1) % 3]]));
      const double ax = a.x * side - x, ay = a.y * side - y, dx = (b.x - a.x) * side, dy = (b.y - a.y) * side;
      const double along = dx * dx + dy * dy;
      const double t = along > 0 ? std::clamp(-(ax * dx + ay * dy) / along, 0.0, 1.0) : 0;
      least = std::min(least, std::hypot(ax + t * dx, ay + t * dy));
    }
  return least;
}

/// How far depth may be off on a triangle, by what rasterise_depth.hpp says.
double slack(const geometry::Triangle<float>& t, const LightView& view, int side) {
  const auto a = view.place(Vec3d(t.a)), b = view.place(Vec3d(t.b)), c = view.place(Vec3d(t.c));
  const double bx = (b.x - a.x) * side, by = (b.y - a.y) * side, cx = (c.x - a.x) * side,
               cy = (c.y - a.y) * side;
  const double area = bx * cy - by * cx;
  const double gx = ((b.depth - a.depth) * cy - (c.depth - a.depth) * by) / area,
               gy = (bx * (c.depth - a.depth) - cx * (b.depth - a.depth)) / area;
  const double slope = std::abs(gx) + std::abs(gy);
  // Positions are rounded to 2^-17 of a texel each; a register's 16 texels and a tile's 64 rows are stepped
  // over in float, a few roundings of what is stepped over and of depths below 1. In perspective the slope is
  // not the same everywhere; its planes are of numbers below 1, too.
  constexpr double u = 0x1p-24;
  return slope * 0x1p-15 + 6 * u * (1 + 64 * slope);
}

class EveryScene : public testing::TestWithParam<std::tuple<std::string, bool>> {};
INSTANTIATE_TEST_SUITE_P(Scenes, EveryScene,
                         testing::Combine(testing::ValuesIn(datasets::scene_names()), testing::Bool()),
                         [](const auto& info) {
                           return std::get<0>(info.param) +
                                  (std::get<1>(info.param) ? "_from_a_point" : "_from_afar");
                         });

// Every texel is what a ray through its centre meets, by a tree of doubles: the depth of that triangle's
// plane where both found the same surface, and where not, the centre is within 1/128 of a texel of an edge.
TEST_P(EveryScene, AgreesWithRaysButForCentresOnEdges) {
  const auto& [name, perspective] = GetParam();
  const Mesh3f mesh = datasets::make_scene(name, 3000, 1).mesh;
  const LightView view = view_of(mesh, perspective);
  constexpr int side = 200;
  const DepthMap map = draw(mesh, view, side);
  const Tree tree = tree_of(mesh);
  std::size_t others = 0, covered = 0;
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      const float depth = map.first[map.index(x, y)];
      const auto hit = tree.closest_hit(texel_ray<double>(view, side, side, x, y));
      covered += bool(hit);
      if (!hit && depth == 1) continue;
      if (hit && std::abs(double(depth) - hit.t) <= slack(mesh.triangle(hit.primitive), view, side)) continue;
      ++others;
      ASSERT_LE(distance_from_edges(mesh, view, side, x + 0.5, y + 0.5, 1), 1.0 / 128)
          << x << ", " << y << ": " << depth << ", the ray " << hit.t;
    }
  EXPECT_GT(covered, std::size_t(side * side / 10));
  // A band of 1/128 of a texel on either side of all edges cannot hold more, by far.
  EXPECT_LT(others, covered / 50);
  RecordProperty("texels_apart", int(others));
  std::printf("%s%s: %zu of %zu texels apart\n", name.c_str(), perspective ? ", perspective" : "", others,
              covered);
}

TEST_P(EveryScene, CastsTheSameMap) {
  const auto& [name, perspective] = GetParam();
  const Mesh3f mesh = datasets::make_scene(name, 3000, 1).mesh;
  const LightView view = view_of(mesh, perspective);
  constexpr int side = 200;
  const DepthMap drawn = draw(mesh, view, side, {.layers = 2});
  const DepthMap cast = cast_depth(tree_of(mesh), view, side, side, {.layers = 2});
  const DepthMap narrow = cast_depth(FloatTree(mesh), view, side, side, {.layers = 2, .threads = 2});
  std::size_t covered = 0, first = 0, second = 0, in_float = 0;
  for (std::size_t i = 0; i < drawn.first.size(); ++i) {
    covered += drawn.first[i] < 1;
    first += std::abs(drawn.first[i] - cast.first[i]) > 1e-3f;
    second += std::abs(drawn.second[i] - cast.second[i]) > 1e-3f;
    in_float += std::abs(narrow.first[i] - cast.first[i]) > 1e-3f;
  }
  // Steep faces and edges; the test above tells them apart.
  EXPECT_LT(first, covered / 50);
  EXPECT_LT(second, covered / 50);
  EXPECT_LT(in_float, covered / 50);
}

TEST(DrawnOver, MapsOfBeforeLeaveNothingAndTheirMemoryIsKept) {
  const Mesh3f mesh = datasets::make_scene("city", 2000, 1).mesh;
  const LightView view = view_of(mesh, false);
  const FloatTree tree(mesh);
  DepthMap drawn, cast;
  DepthScratch scratch;
  CastScratch<float> rays;
  for (const auto& [side, layers] : {std::pair{120, 2}, {75, 1}, {120, 2}}) {  // 75: rows are padded
    const float* const before = drawn.first.data();
    const std::size_t room = drawn.first.capacity();
    rasterise_depth(mesh, view, side, side, drawn, scratch, {.layers = layers});
    EXPECT_TRUE(room == 0 || (drawn.first.data() == before && drawn.first.capacity() == room));
    const DepthMap fresh = draw(mesh, view, side, {.layers = layers});
    EXPECT_EQ(drawn.first, fresh.first) << side;
    EXPECT_EQ(drawn.second, fresh.second) << side;
    cast_depth(tree, view, side, side, cast, rays, {.layers = layers});
    const DepthMap cast_fresh = cast_depth(tree, view, side, side, {.layers = layers});
    EXPECT_EQ(cast.first, cast_fresh.first) << side;
    EXPECT_EQ(cast.second, cast_fresh.second) << side;
  }
}

// A closed surface is entered as often as it is left: the texels that faces toward the light cover are those
// that the others cover, all of them.
TEST(Closed, EveryTexelThatIsCoveredIsCoveredFromBothSides) {
  for (const char* name : {"icosphere", "torus_knot", "nested_shells"})
    for (const bool perspective : {false, true})
      for (const int side : {37, 128, 501}) {
        const Mesh3f mesh = datasets::generate(name, 20'000, 1).mesh;
        const LightView view = view_of(mesh, perspective);
        const DepthMap toward = draw(mesh, view, side, {.facing = Facing::toward}),
                       away = draw(mesh, view, side, {.facing = Facing::away}), both = draw(mesh, view, side);
        std::size_t covered = 0;
        for (std::size_t i = 0; i < both.first.size(); ++i) {
          covered += both.first[i] < 1;
          ASSERT_EQ(toward.first[i] < 1, away.first[i] < 1) << name << ", texel " << i;
          ASSERT_EQ(both.first[i], std::min(toward.first[i], away.first[i]));
        }
        EXPECT_GT(covered, std::size_t(side * side / 8));
      }
}

/// A square of cells × cells × 2 triangles.
Mesh3f oblique_sheet(std::size_t cells) {
  Mesh3f mesh;
  const Vec3d u{0.83, 0.31, -0.2}, v{-0.1, 0.45, 0.77};
  for (std::size_t j = 0; j <= cells; ++j)
    for (std::size_t i = 0; i <= cells; ++i)
      mesh.vertices.push_back(
          geometry::Vec3f(u * (double(i) / double(cells)) + v * (double(j) / double(cells))));
  for (std::size_t j = 0; j < cells; ++j)
    for (std::size_t i = 0; i < cells; ++i) {
      const auto a = std::uint32_t(j * (cells + 1) + i), b = std::uint32_t(a + cells + 1);
      mesh.faces.push_back({a, a + 1, b + 1}), mesh.faces.push_back({a, b + 1, b});
    }
  return mesh;
}

// A flat sheet in oblique position, however it is split, covers each centre in it once: no hole, no texel
// with a second surface, and the depth of the plane.
TEST(Sheet, IsCoveredOnceAndHasTheDepthOfItsPlane) {
  for (const std::size_t cells : {1u, 5u, 40u, 300u})
    for (const int side : {16, 100, 333}) {
      const Mesh3f mesh = oblique_sheet(cells);
      const LightView view = view_of(mesh, false);
      const DepthMap map = draw(mesh, view, side, {.layers = 2});
      // The corners of the square: it is convex, and so is what it covers.
      const auto corner = [&](std::size_t i) { return view.place(Vec3d(mesh.vertices[i])); };
      const std::size_t row = cells + 1;
      const std::array q{corner(0), corner(row - 1), corner(row * row - 1), corner(row * row - row)};
      const auto gradient = [&](int axis) {  // of depth, from the two sides at the first corner
        const double bx = q[1].x - q[0].x, by = q[1].y - q[0].y, bz = q[1].depth - q[0].depth;
        const double cx = q[3].x - q[0].x, cy = q[3].y - q[0].y, cz = q[3].depth - q[0].depth;
        return (axis == 0 ? bz * cy - cz * by : bx * cz - cx * bz) / (bx * cy - by * cx);
      };
      std::size_t within = 0;
      for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) {
          const double px = (x + 0.5) / side, py = (y + 0.5) / side;
          double inside = INFINITY;  // distance from the border in texels, positive within
          double sign = 0;
          for (std::size_t k = 0; k < 4; ++k) {
            const auto &a = q[k], &b = q[(k + 1) % 4];
            const double cross = (b.x - a.x) * (py - a.y) - (b.y - a.y) * (px - a.x);
            if (sign == 0) {
              const auto& c = q[(k + 2) % 4];
              sign = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x) > 0 ? 1 : -1;
            }
            inside = std::min(inside, sign * cross / std::hypot(b.x - a.x, b.y - a.y) * side);
          }
          const std::size_t i = map.index(x, y);
          if (inside > 0.01) {
            ++within;
            const double depth = q[0].depth + gradient(0) * (px - q[0].x) + gradient(1) * (py - q[0].y);
            // A centre just beside a triangle that rounding took it into gets the depth of its border.
            const double slope = (std::abs(gradient(0)) + std::abs(gradient(1))) / side;
            EXPECT_NEAR(map.first[i], depth, slope / 256 + 1e-6);
          } else if (inside < -0.01) {
            EXPECT_EQ(map.first[i], 1);
          }
          EXPECT_EQ(map.second[i], 1) << "covered twice at " << x << ", " << y;
        }
      EXPECT_GT(within, std::size_t(side * side / 8));
    }
}

TEST(Layers, TheSecondOfAConvexBodyIsItsFarSide) {
  const Mesh3f ball = datasets::make_scene("sphere_over_floor", 20'000, 1).mesh;
  for (const bool perspective : {false, true}) {
    const LightView view = view_of(ball, perspective);
    Mesh3f only = ball;
    std::erase_if(only.faces, [&](const auto& f) { return ball.vertices[f[0]][1] == 0; });  // the floor
    const DepthMap two = draw(only, view, 300, {.layers = 2}),
                   far = draw(only, view, 300, {.facing = Facing::away});
    std::size_t covered = 0;
    for (std::size_t i = 0; i < two.first.size(); ++i) {
      covered += two.first[i] < 1;
      if (two.first[i] == far.first[i] && two.first[i] < 1) continue;  // both faces of the rim, at one depth
      ASSERT_EQ(two.second[i], far.first[i]);
    }
    EXPECT_GT(covered, 1000u);
  }
}

TEST(Layers, AreTheTwoLeastDepthsOfAll) {
  // One map a face, against all at once; sums, gaps and ties of a soup.
  const Mesh3f soup = datasets::generate("needles", 1000, 1).mesh;
  const LightView view = view_of(soup, true);
  std::vector<float> first(64 * 64, 1.0f), second(64 * 64, 1.0f);
  for (const auto& face : soup.faces) {
    Mesh3f one = soup;
    one.faces = {face};
    const DepthMap map = draw(one, view, 64);
    for (std::size_t i = 0; i < first.size(); ++i) {
      const float d = map.first[i];
      if (d < first[i]) {
        second[i] = first[i], first[i] = d;
      } else if (d > first[i]) {
        second[i] = std::min(second[i], d);
      }
    }
  }
  const DepthMap all = draw(soup, view, 64, {.layers = 2});
  EXPECT_EQ(all.first, first);
  EXPECT_EQ(all.second, second);
  EXPECT_GT(std::ranges::count_if(second, [](float d) { return d < 1; }), 100);
}

TEST(Map, DoesNotDependOnThreadsOrTheOrderOfFaces) {
  Mesh3f mesh = datasets::make_scene("leaves", 60'000, 1).mesh;
  for (const bool perspective : {false, true}) {
    const LightView view = view_of(mesh, perspective);
    const DepthMap one = draw(mesh, view, 700, {.layers = 2});
    for (const int threads : {2, 5}) {
      const DepthMap more = draw(mesh, view, 700, {.layers = 2, .threads = threads});
      EXPECT_EQ(one.first, more.first);
      EXPECT_EQ(one.second, more.second);
    }
    Mesh3f turned = mesh;
    std::ranges::reverse(turned.faces);
    EXPECT_EQ(draw(turned, view, 700, {.layers = 2}).second, one.second);
    EXPECT_EQ(draw(mesh, view, 700).first, one.first) << "one layer";
  }
}

}  // namespace
}  // namespace treeline::shading::raster
