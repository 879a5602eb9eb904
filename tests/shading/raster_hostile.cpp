// What a rasteriser breaks on: broken vertices, planes that clip, sizes that overflow, views that are none.
#include <gtest/gtest.h>

#include "accel/bvh.hpp"
#include "geometry/random.hpp"
#include "raster_common.hpp"
#include "shading/raster/cast_depth.hpp"

namespace treeline::shading::raster {
namespace {

using namespace test;

/// Looks down from y = 0 at what is below; a square of side 2, or at distance 1 so wide.
LightView down_view(bool perspective) {
  LightView v;
  v.forward = {0, -1, 0}, v.right = {1, 0, 0}, v.down = cross(v.forward, v.right);
  v.perspective = perspective, v.near = 1, v.far = 5;
  return v;
}

std::string refusal(const auto& act) {
  try {
    act();
  } catch (const InvalidScene& e) {
    return e.what();
  }
  return "";
}

TEST(Hostile, NothingGivesAnEmptyMap) {
  for (const bool perspective : {false, true}) {
    Mesh3f mesh;
    EXPECT_EQ(draw(mesh, down_view(perspective), 5).first, std::vector<float>(25, 1.0f));
    mesh.vertices = {{0, -2, 0}, {1, -2, 0}, {0, -2, 1}};
    EXPECT_EQ(draw(mesh, down_view(perspective), 5).first, std::vector<float>(25, 1.0f)) << "no faces";
    mesh.faces = {{0, 1, 1}, {0, 0, 0}, {2, 1, 2}};
    EXPECT_EQ(draw(mesh, down_view(perspective), 5).first, std::vector<float>(25, 1.0f)) << "no area";
    mesh.vertices[2] = {0.5f, -3, 0};
    mesh.faces = {{0, 1, 2}};
    EXPECT_EQ(draw(mesh, down_view(false), 64).first, std::vector<float>(64 * 64, 1.0f)) << "edge-on";
  }
}

TEST(Hostile, BrokenVerticesTakeOnlyTheirFacesAway) {
  const Mesh3f mesh = datasets::generate("icosphere", 2000, 1).mesh;
  const LightView view = view_of(mesh, true);
  for (const float bad : {NAN, INFINITY, -INFINITY}) {
    Mesh3f broken = mesh;
    broken.vertices[100][1] = bad;
    DepthWork work;
    const DepthMap map = rasterise_depth(broken, view, 90, 90, {}, &work);
    Mesh3f rest = mesh;
    const std::size_t removed =
        std::erase_if(rest.faces, [](const auto& f) { return std::ranges::count(f, 100u) > 0; });
    EXPECT_EQ(map.first, draw(rest, view, 90).first);
    EXPECT_EQ(work.broken, removed);
    EXPECT_EQ(work.clipped, 0u);
  }
}

TEST(Hostile, OneTexelAndOddSidesWork) {
  const Mesh3f mesh = datasets::generate("icosphere", 2000, 1).mesh;
  const LightView view = view_of(mesh, false);
  EXPECT_LT(draw(mesh, view, 1).first[0], 1);
  for (const auto& [w, h] : {std::pair{1, 77}, std::pair{77, 1}, std::pair{17, 130}, std::pair{65, 63}}) {
    const DepthMap map = rasterise_depth(mesh, view, w, h, {.layers = 2});
    EXPECT_EQ(map.first.size(), std::size_t(w * h));
    const DepthMap cast = cast_depth(accel::Bvh<accel::Triangles<float>, accel::Wide>(mesh), view, w, h);
    std::size_t apart = 0;
    for (std::size_t i = 0; i < map.first.size(); ++i) apart += (map.first[i] < 1) != (cast.first[i] < 1);
    EXPECT_LE(apart, std::size_t(w + h) / 20);
  }
}

TEST(Hostile, TheNearPlaneCutsExactly) {
  // A ramp that rises through the near plane: it must end where it does, and nothing before may be seen.
  for (const bool perspective : {false, true}) {
    Mesh3f ramp;
    ramp.vertices = {{-30, 14, -30}, {-30, 14, 30}, {30, -16, 30}, {30, -16, -30}};  // y = -1 - x/2
    ramp.faces = {{0, 1, 2}, {0, 2, 3}};
    const LightView view = down_view(perspective);
    DepthWork work;
    const DepthMap map = rasterise_depth(ramp, view, 128, 128, {.layers = 2}, &work);
    EXPECT_EQ(work.clipped, 2u);
    for (int y = 0; y < 128; ++y)
      for (int x = 0; x < 128; ++x) {
        // A ray (a, -1, b)·s hits where -s = -1 - a·s/2; a straight one at x = a has depth 1 + a/2.
        const double a = (x + 0.5) / 64 - 1, z = perspective ? 1 / (1 - a / 2) : 1 + a / 2;
        const float depth = map.first[map.index(x, y)];
        if (a > 0) {
          EXPECT_NEAR(depth, (z - 1) / 4, 2e-6) << x;
        } else {
          EXPECT_EQ(depth, 1) << x;
        }
        EXPECT_EQ(map.second[map.index(x, y)], 1) << "two triangles at one edge";
      }
  }
}

TEST(Hostile, TheFarPlaneHidesWhatIsBehind) {
  Mesh3f sheet;
  sheet.vertices = {{-9, -4.999f, -9}, {-9, -4.999f, 9}, {9, -4.999f, 9}, {9, -4.999f, -9}};
  sheet.faces = {{0, 1, 2}, {0, 2, 3}};
  for (const bool perspective : {false, true}) {
    EXPECT_NEAR(draw(sheet, down_view(perspective), 8).first[20], 0.99975, 1e-5);
    Mesh3f behind = sheet;
    for (auto& p : behind.vertices) p[1] = -5.001f;
    EXPECT_EQ(draw(behind, down_view(perspective), 8).first, std::vector<float>(64, 1.0f));
  }
}

// Triangles of any size about the view, far beyond what fixed point holds, and through the light: each
// texel's depth is that of the plane by which it was made.
TEST(Hostile, HugeTrianglesKeepTheirPlane) {
  for (const bool perspective : {false, true})
    for (const double size : {3.0, 1e3, 1e5, 1e7, 1e12, 1e30}) {
      std::size_t covered = 0;
      for (std::uint64_t seed = 0; seed < 40; ++seed) {
        const auto draw_one = [&](std::uint64_t i) {
          return 2 * double(geometry::hash_u64(seed, i) >> 11) * 0x1p-53 - 1;
        };
        // A plane y = c + a·x + b·z, and three corners on it around the view.
        const double a = 0.5 * draw_one(0), b = 0.5 * draw_one(1), c = -2.5 + draw_one(2);
        Mesh3f mesh;
        for (int k = 0; k < 3; ++k) {
          const double turn = 2.0944 * (k + 0.5 * draw_one(3)),
                       r = size * (3 + draw_one(4 + std::uint64_t(k)));
          const double x = r * std::cos(turn), z = r * std::sin(turn);
          mesh.vertices.push_back(geometry::Vec3f(Vec3d{x, c + a * x + b * z, z}));
        }
        mesh.faces = {{0, 1, 2}};
        // The plane of the corners as they were rounded.
        const auto t = mesh.triangle(0);
        const Vec3d p(t.a), e = Vec3d(t.b) - p, f = Vec3d(t.c) - p, n = cross(e, f);
        const LightView view = down_view(perspective);
        const DepthMap map = draw(mesh, view, 64);
        const auto at = [&](double x, double y) {
          const Vec3d from = view.at({x, y, 0}), way = view.at({x, y, 1}) - from;
          return dot(p - from, n) / dot(way, n);
        };
        for (int y = 0; y < 64; ++y)
          for (int x = 0; x < 64; ++x) {
            const float depth = map.first[map.index(x, y)];
            covered += depth < 1;
            // Where the corners' own rounding leaves something of the plane to compare with.
            if (size > 1e7) continue;
            const double wanted = at((x + 0.5) / 64, (y + 0.5) / 64);
            const double slack = 1e-5 + size * 1e-7;
            const bool must = wanted > slack && wanted < 1 - slack && size >= 1e3;
            if (must || depth < 1) {
              EXPECT_NEAR(depth, wanted, slack);
            }
          }
      }
      // Corners farther away than that are not rounded to a plane that is still in view.
      if (size <= 1e7) {
        EXPECT_GT(covered, 10'000u) << size;
      }
    }
}

// A fan of long thin triangles about a point in the map, with corners far beyond it: no centre is left out or
// covered twice.
TEST(Hostile, EdgesFarBeyondTheMapStayShared) {
  for (const bool perspective : {false, true})
    for (const double size : {2.0, 300.0, 1e5, 1e9}) {
      Mesh3f fan;
      fan.vertices.push_back({0.123f, -3, 0.077f});
      constexpr std::uint32_t spokes = 97;
      for (std::uint32_t k = 0; k < spokes; ++k) {
        const double turn = 6.283185307179586 * k / spokes;
        // Far corners are at other heights, but for the smallest: they are also clipped.
        const double y = size > 2 ? -3 + 0.1 * size * std::sin(5 * turn) : -3 + 0.2 * std::sin(3 * turn);
        fan.vertices.push_back(
            geometry::Vec3f(Vec3d{8 * size * std::cos(turn), y, 8 * size * std::sin(turn)}));
        fan.faces.push_back({0, 1 + k, 1 + (k + 1) % spokes});
      }
      LightView view = down_view(perspective);
      view.far = 1e4;
      const DepthMap map = draw(fan, view, 256, {.layers = 2});
      for (std::size_t i = 0; i < map.first.size(); ++i) {
        ASSERT_LT(map.first[i], 1) << "a hole at " << i << ", size " << size;
        ASSERT_EQ(map.second[i], 1) << "twice at " << i << ", size " << size;
      }
    }
}

TEST(Hostile, ManyFacesOverAllTilesAreDrawnInRounds) {
  // 20000 faces on 16×16 tiles each: more references than are kept at a time.
  Mesh3f mesh;
  for (std::uint32_t k = 0; k < 20'000; ++k) {
    const float y = -4.5f + 3e-5f * float(k);
    mesh.vertices.insert(mesh.vertices.end(), {{-9, y, -9}, {9, y, -9}, {0, y, 18}});
    mesh.faces.push_back({3 * k, 3 * k + 1, 3 * k + 2});
  }
  DepthWork work;
  const DepthMap map = rasterise_depth(mesh, down_view(false), 1024, 1024, {.threads = 2}, &work);
  EXPECT_EQ(work.references, 20'000u * 256);
  for (const float depth : map.first) ASSERT_NEAR(depth, (4.5 - 3e-5 * 19'999 - 1) / 4, 1e-6);
}

TEST(Hostile, RefusesWithTheReason) {
  const Mesh3f mesh = datasets::generate("icosphere", 1000, 1).mesh;
  const LightView view = view_of(mesh, false);
  const auto why = [&](int w, int h, const DepthOptions& o = {}) {
    return refusal([&] { rasterise_depth(mesh, view, w, h, o); });
  };
  EXPECT_NE(why(0, 5).find("0 × 5"), std::string::npos);
  EXPECT_NE(why(5, -1).find("-1"), std::string::npos);
  EXPECT_NE(why(16385, 5).find("16384"), std::string::npos);
  EXPECT_NE(why(5, 5, {.layers = 3}).find("3 layers"), std::string::npos);
  EXPECT_NE(why(5, 5, {.threads = 0}).find("threads"), std::string::npos);
  Mesh3f wrong = mesh;
  wrong.faces[77][2] = std::uint32_t(wrong.vertices.size());
  EXPECT_NE(refusal([&] { draw(wrong, view, 9); }).find("face 77"), std::string::npos);
  wrong.faces[77][2] = 0xffffffff;
  EXPECT_NE(refusal([&] { draw(wrong, view, 9); }).find("face 77"), std::string::npos);
  const std::vector<std::pair<const char*, void (*)(LightView&)>> faults{
      {"not finite", [](LightView& v) { v.origin[1] = NAN; }},
      {"width", [](LightView& v) { v.half_width = 0; }},
      {"width", [](LightView& v) { v.half_height = NAN; }},
      {"near", [](LightView& v) { v.near = v.far; }},
      {"near", [](LightView& v) { v.perspective = true, v.near = 0; }}};
  for (const auto& [part, spoil] : faults) {
    LightView bad = view;
    spoil(bad);
    EXPECT_NE(refusal([&] { draw(mesh, bad, 9); }).find(part), std::string::npos) << part;
  }
}

TEST(Hostile, TheLargestSideWorks) {
  const Mesh3f mesh = datasets::generate("icosphere", 1000, 1).mesh;
  const LightView view = view_of(mesh, false);
  const DepthMap map = rasterise_depth(mesh, view, 16384, 3);
  EXPECT_EQ(map.first.size(), 16384u * 3);
  const DepthMap cast = cast_depth(accel::Bvh<accel::Triangles<float>, accel::Wide>(mesh), view, 16384, 3);
  std::size_t apart = 0, covered = 0;
  for (std::size_t i = 0; i < map.first.size(); ++i)
    apart += std::abs(map.first[i] - cast.first[i]) > 1e-4f, covered += map.first[i] < 1;
  EXPECT_GT(covered, 10'000u);
  EXPECT_LT(apart, covered / 100);
}

}  // namespace
}  // namespace treeline::shading::raster
