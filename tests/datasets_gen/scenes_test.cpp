// Scenes: deterministic, near the size asked for, in view, and of the shape that their closed forms speak of.
#include "datasets_gen/scenes/scene.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <map>
#include <numbers>

#include "datasets_gen/scenes/light.hpp"
#include "geometry/adjacency.hpp"
#include "shading/shadow/light_view.hpp"

namespace treeline::datasets {
namespace {

using geometry::Box3d;
using geometry::Vec3d;
using shading::Light;
using shading::LightKind;
using shading::Scene;

Box3d box_of(const geometry::Mesh3f& mesh) {
  Box3d box;
  for (const auto& p : mesh.vertices) box.grow(Vec3d(p));
  return box;
}

class EveryScene : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Scenes, EveryScene, testing::ValuesIn(scene_names()),
                         [](const auto& info) { return info.param; });

TEST_P(EveryScene, GivesTheSameBitsForAnyNumberOfThreads) {
  const auto with = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return generate(GetParam(), 20'000, 3).hash();
  };
  EXPECT_EQ(with(1), with(5));
}

TEST_P(EveryScene, ComesNearTheSizeAskedFor) {
  for (const auto& [n, share] : {std::pair{2500, 0.25}, std::pair{20'000, 0.1}, std::pair{200'000, 0.05}})
    EXPECT_NEAR(double(generate(GetParam(), std::size_t(n), 1).size()), n, share * n);
}

TEST_P(EveryScene, IsSoundAndSeen) {
  const Scene s = make_scene(GetParam(), 5000, 1);
  EXPECT_EQ(s.name, GetParam());
  std::vector<bool> used(s.mesh.vertices.size());
  for (const auto& f : s.mesh.faces)
    for (const auto v : f) {
      ASSERT_LT(v, used.size());
      used[v] = true;
    }
  for (const auto& p : s.mesh.vertices) EXPECT_TRUE(is_finite(p));
  for (std::size_t f = 0; f < s.mesh.size(); ++f) {
    const auto t = s.mesh.triangle(f);
    EXPECT_GT(length(cross(Vec3d(t.b) - Vec3d(t.a), Vec3d(t.c) - Vec3d(t.a))), 0) << "face " << f;
  }
  EXPECT_NEAR(length(s.light.direction), 1, 1e-12);
  EXPECT_NO_THROW(shading::shadow::fit_view(s.light, box_of(s.mesh)));
  const Vec3d sight = s.camera.target - s.camera.position;
  EXPECT_GT(length(cross(normalized(sight), normalized(s.camera.up))), 0.05) << "up is the line of sight";
  EXPECT_TRUE(box_of(s.mesh).contains(s.camera.target));
}

TEST_P(EveryScene, CanBeAsSmallAsItsShape) { EXPECT_LE(make_scene(GetParam(), 12, 1).mesh.size(), 3000u); }

TEST(Scenes, GiveTheSameBitsOnEveryMachine) {
  static const std::map<std::string, std::uint64_t> pinned{
      {"tilted_plane", 0xece95fa311cbd78cull},
      {"wall_on_floor", 0x8f55b3c31a4f3055ull},
      {"slab_and_sheet", 0xec13cdb79cfed8aeull},
      {"half_plane_edge", 0x9436fb46fbe5e124ull},
      {"sphere_over_floor", 0x286178e19927f645ull},
      {"two_stacked", 0xcc099d6ed123adeull},
      {"three_layers", 0xcff142ce6be3c9e3ull},
      {"slit", 0xe2e80cbb1cfdea90ull},
      {"picket_fence", 0x56b4918cf6101db1ull},
      {"leaves", 0x61d484b741d20f14ull},
      {"city", 0x1a61034a325937efull},
      {"open_casters", 0x43d385ca976af93eull},
      {"non_manifold", 0xfddd386b8e41ebceull},
      {"eye_inside_volume", 0x4530b10e1cc0b6efull},
  };
  for (const std::string& name : scene_names()) {
    ASSERT_TRUE(pinned.contains(name)) << name;
    EXPECT_EQ(generate(name, 5000, 7).hash(), pinned.at(name))
        << name << std::hex << " " << generate(name, 5000, 7).hash();
  }
}

TEST(Scenes, HashesTellMeshLightAndCamera) {
  const Dataset a = generate("half_plane_edge", 1000, 1);
  Dataset b = a;
  EXPECT_EQ(a.hash(), b.hash());
  b.scene.light.u[0] *= 2;
  EXPECT_NE(a.hash(), b.hash());
  b = a, b.scene.camera.width = 641;
  EXPECT_NE(a.hash(), b.hash());
  b = a, b.scene.mesh.vertices[0][0] += 1;
  EXPECT_NE(a.hash(), b.hash());
  EXPECT_NE(generate("city", 1000, 1).hash(), generate("city", 1000, 2).hash());
}

TEST(Scenes, TiltedPlanesHaveTheAngleAskedFor) {
  for (const double theta : {0.0, 30.0, 85.0})
    for (const double phi : {0.0, 45.0}) {
      const Scene s =
          make_scene("tilted_plane_" + std::to_string(theta) + "_" + std::to_string(phi), 1000, 1);
      for (std::size_t f = 0; f < s.mesh.size(); ++f) {
        const auto t = s.mesh.triangle(f);
        const Vec3d n = normalized(cross(Vec3d(t.b) - Vec3d(t.a), Vec3d(t.c) - Vec3d(t.a)));
        EXPECT_NEAR(std::acos(std::min(1.0, -dot(n, s.light.direction))) * 180 / std::numbers::pi, theta,
                    1e-3);
        // Its slope, in the axes of the shadow map.
        const auto view = shading::shadow::fit_view(s.light, box_of(s.mesh));
        if (theta == 0) continue;
        EXPECT_NEAR(std::abs(std::tan(phi * std::numbers::pi / 180)),
                    std::abs(dot(n, view.right) / dot(n, view.down)), 1e-4);
      }
    }
}

TEST(Scenes, StackedLevelsHaveTheRatioAskedFor) {
  for (const double r : {0.1, 0.5, 1.0}) {
    const Scene s = make_scene("two_stacked_" + std::to_string(r), 1000, 1);
    std::map<float, int> levels;
    for (const auto& p : s.mesh.vertices) ++levels[p[1]];
    ASSERT_EQ(levels.size(), 3u);
    const double t = levels.begin()->first, b = std::next(levels.begin())->first, a = levels.rbegin()->first;
    EXPECT_NEAR((b - t) / (a - b), r, 1e-5);
  }
}

TEST(Scenes, FloorsFaceUpAndBoxesAreClosed) {
  for (const char* name : {"wall_on_floor", "city", "picket_fence", "eye_inside_volume"}) {
    const Scene s = make_scene(name, 3000, 1);
    geometry::Mesh3f boxes = s.mesh;
    std::erase_if(boxes.faces, [&](const auto& f) {
      const auto t =
          geometry::Triangle<float>{s.mesh.vertices[f[0]], s.mesh.vertices[f[1]], s.mesh.vertices[f[2]]};
      const bool ground = t.a[1] == 0 && t.b[1] == 0 && t.c[1] == 0;
      return ground && cross(t.b - t.a, t.c - t.a)[1] > 0;
    });
    EXPECT_LT(boxes.size(), s.mesh.size()) << name;
    const geometry::Adjacency adjacency(boxes);
    EXPECT_TRUE(adjacency.closed() && adjacency.oriented()) << name;
  }
  for (const char* name : {"open_casters", "non_manifold"})
    EXPECT_FALSE(geometry::Adjacency(make_scene(name, 3000, 1).mesh).closed()) << name;
}

TEST(Scenes, RefuseWithTheReason) {
  const auto message = [](const char* name, std::size_t n = 1000) {
    try {
      make_scene(name, n, 1);
    } catch (const std::invalid_argument& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_NE(message("nowhere").find("tilted_plane"), std::string::npos);
  EXPECT_NE(message("tilted_plane_x").find("theta"), std::string::npos);
  EXPECT_NE(message("tilted_plane_").find("no number"), std::string::npos);
  for (const char* name : {"tilted_plane_theta=60", "tilted_plane_90"})
    EXPECT_NE(message(name).find(" from 0 to 89.9"), std::string::npos) << message(name);
  EXPECT_NE(message("tilted_plane_90").find("theta"), std::string::npos);
  EXPECT_NE(message("tilted_plane_nan").find("theta"), std::string::npos);
  EXPECT_NE(message("tilted_plane_1_2_3").find("one too many"), std::string::npos);
  EXPECT_NE(message("city_1").find("0 knobs"), std::string::npos);
  EXPECT_NE(message("city", 11).find("out of range"), std::string::npos);
  EXPECT_THROW(generate("city+hole_1", 1000, 1), std::invalid_argument);
}

TEST(Stage, HoldsAnyMeshAndFitsLightAndCamera) {
  for (const double scale : {1e-3, 1.0, 1e4}) {
    const Dataset d = generate("torus_knot", 2000, 1);
    geometry::Mesh3f mesh = d.mesh;
    for (auto& p : mesh.vertices) p = p * float(scale) + geometry::Vec3f{float(5 * scale), 0, 0};
    const Box3d before = box_of(mesh);
    const Scene s = scene_of_mesh(mesh, "knot");
    EXPECT_EQ(s.name, "knot");
    ASSERT_GT(s.mesh.size(), mesh.size());
    EXPECT_EQ(std::vector(s.mesh.faces.begin(), s.mesh.faces.begin() + std::ptrdiff_t(mesh.size())),
              mesh.faces);
    EXPECT_NEAR(box_of(s.mesh).low[1], before.low[1], 1e-6 * scale) << "the floor is below it";
    EXPECT_LT(s.light.direction[1], -0.7);
    // Every corner of the mesh is in view of the camera.
    const Vec3d forward = normalized(s.camera.target - s.camera.position);
    for (const auto& p : mesh.vertices) {
      const Vec3d to = Vec3d(p) - s.camera.position;
      EXPECT_GT(dot(to, forward) / length(to), std::cos(0.5 * s.camera.height_angle));
    }
  }
}

TEST(Stage, TakesAnyUpAndLeavesBrokenVerticesOut) {
  Dataset d = generate("terrain", 2000, 1);
  const std::size_t faces = d.mesh.size();
  d.mesh.vertices[7][1] = NAN;
  const Scene s = scene_of_mesh(d.mesh, "hills", {.up = {0, 0, 1}});
  EXPECT_GT(s.mesh.size(), faces);
  EXPECT_TRUE(is_finite(s.camera.position));
  EXPECT_NEAR(s.light.direction[2], -0.8, 1e-12);
  EXPECT_EQ(scene_of_mesh(d.mesh, "hills", {.up = {0, 0, 1}, .floor = false}).mesh.size(), faces);
  EXPECT_THROW(scene_of_mesh(d.mesh, "hills", {.up = {0, 0, 2}}), std::invalid_argument);
  EXPECT_THROW(scene_of_mesh({}, "nothing"), std::invalid_argument);
  // What no face names, or no ray can meet, does not stretch it.
  geometry::Mesh3f stray = d.mesh;
  stray.vertices.push_back({1e6f, 1e6f, 1e6f});
  EXPECT_EQ(scene_of_mesh(stray, "hills", {.up = {0, 0, 1}}).mesh.box(), s.mesh.box());
  const auto first = static_cast<std::uint32_t>(stray.vertices.size());
  stray.vertices.push_back({std::numeric_limits<float>::infinity(), 0, 0});
  stray.faces.push_back({0, 1, first});
  EXPECT_EQ(scene_of_mesh(stray, "hills", {.up = {0, 0, 1}}).mesh.box(), s.mesh.box());
  geometry::Mesh3f wrong;
  wrong.vertices.resize(3), wrong.faces.push_back({0, 1, 3});
  EXPECT_THROW(scene_of_mesh(wrong, "wrong"), std::invalid_argument);
}

TEST(Lights, AreReadFromText) {
  const Light sun = parse_light("directional:0,-2,0:0.5");
  EXPECT_EQ(sun.kind, LightKind::directional);
  EXPECT_EQ(sun.direction, (Vec3d{0, -1, 0}));
  EXPECT_NEAR(sun.angle, 0.5 * std::numbers::pi / 180, 1e-15);
  EXPECT_EQ(parse_light("directional:1,0,0").angle, 0);
  EXPECT_EQ(parse_light("point:1,2.5,-3e1").position, (Vec3d{1, 2.5, -30}));
  EXPECT_NEAR(parse_light("spot:0,5,0:0,-1,0:30").angle, std::numbers::pi / 6, 1e-15);
  for (const char* text :
       {"rectangle:0,5,0:0,-1,0:2,1", "rectangle:0,5,0:1,2,3:2,1", "disc:0,5,0:1,-1,1:2"}) {
    const Light l = parse_light(text);
    const bool disc = l.kind == LightKind::disc;
    EXPECT_NEAR(length(l.u), disc ? 2 : 1, 1e-12);
    EXPECT_NEAR(length(l.v), disc ? 2 : 0.5, 1e-12);
    EXPECT_NEAR(dot(l.u, l.v), 0, 1e-12);
    EXPECT_NEAR(dot(l.u, l.direction), 0, 1e-12);
    EXPECT_NEAR(dot(l.v, l.direction), 0, 1e-12);
    const Light again = parse_light(format_light(l));
    EXPECT_NEAR(length(again.u - l.u) + length(again.v - l.v), 0, 1e-12) << text;
  }
  EXPECT_EQ(format_light(parse_light("spot:0,5,0:0,-1,0:30")).substr(0, 18), "spot:0,5,0:0,-1,0:");
}

TEST(Lights, AreRefusedWithTheReasonAndThePlace) {
  const std::vector<std::pair<std::string, std::string>> cases{
      {"", "no kind"},
      {"sun:1,2,3", "'sun'"},
      {"directional", "0 parts"},
      {"directional:1,2", "2 numbers"},
      {"directional:1,2,3,4", "more than 3"},
      {"directional:1,,3", "number 2 of 3"},
      {"directional:1,2,x", "'x'"},
      {"directional:0,0,0", "no finite length"},
      {"directional:nan,0,0", "'nan'"},
      {"directional:1,0,0:90", "half angle"},
      {"directional:1,0,0:-1", "half angle"},
      {"directional:1,0,0:1:2", "3 parts"},
      {"point:1,2,", "''"},
      {"spot:1,2,3:0,-1,0", "2 parts"},
      {"spot:1,2,3:0,-1,0:0", "angle"},
      {"rectangle:1,2,3:0,-1,0:1", "1 numbers"},
      {"rectangle:1,2,3:0,-1,0:1,-1", "height"},
      {"disc:1,2,3:0,-1,0:inf", "'inf'"},
      {"disc:1,2,3:0,-1,0:-2", "radius"},
  };
  for (const auto& [text, part] : cases) {
    try {
      parse_light(text);
      ADD_FAILURE() << text;
    } catch (const std::invalid_argument& e) {
      EXPECT_NE(std::string(e.what()).find(part), std::string::npos) << text << ": " << e.what();
    }
  }
}

}  // namespace
}  // namespace treeline::datasets
