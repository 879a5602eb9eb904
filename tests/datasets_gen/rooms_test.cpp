// Rooms: deterministic, near the size asked for, painted all over, and of the shape that what is known of
// their light speaks of.
#include "datasets_gen/rooms/room.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <map>
#include <set>

#include "datasets_gen/dataset.hpp"
#include "datasets_gen/hard/hard_light.hpp"
#include "geometry/adjacency.hpp"

namespace treeline::datasets {
namespace {

using geometry::Vec3d;
using shading::LitScene;

std::vector<std::string> room_names() {
  std::vector<std::string> names;
  for (const KnobRecipe& r : room_recipes()) names.push_back(r.name);
  return names;
}

Vec3d area_normal(const LitScene& room, std::size_t f) {
  const auto t = room.mesh.triangle(f);
  return 0.5 * cross(Vec3d(t.b) - Vec3d(t.a), Vec3d(t.c) - Vec3d(t.a));
}
/// By material.
std::map<std::string, double> areas(const LitScene& room) {
  std::map<std::string, double> out;
  for (std::size_t f = 0; f < room.mesh.size(); ++f)
    out[room.materials[room.face_materials[f]].name] += length(area_normal(room, f));
  return out;
}

class EveryRoom : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Rooms, EveryRoom, testing::ValuesIn(room_names()),
                         [](const auto& info) { return info.param; });

TEST_P(EveryRoom, GivesTheSameBitsForAnyNumberOfThreads) {
  const auto with = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return generate(GetParam(), 20'000, 3).hash();
  };
  EXPECT_EQ(with(1), with(5));
}

TEST_P(EveryRoom, ComesNearTheSizeAskedFor) {
  for (const auto& [n, share] : {std::pair{5'000, 0.4}, std::pair{200'000, 0.15}})
    EXPECT_NEAR(double(generate(GetParam(), std::size_t(n), 1).size()), n, share * n);
  EXPECT_LE(make_room(GetParam(), 12, 1).mesh.size(), 700u);
}

TEST_P(EveryRoom, IsSoundAndPainted) {
  const LitScene room = make_room(GetParam(), 5000, 1);
  EXPECT_EQ(room.name, GetParam());
  ASSERT_EQ(room.face_materials.size(), room.mesh.size());
  std::set<std::uint32_t> used;
  bool lit = room.background[0] > 0;
  for (std::size_t f = 0; f < room.mesh.size(); ++f) {
    for (const auto v : room.mesh.faces[f]) ASSERT_LT(v, room.mesh.vertices.size());
    EXPECT_GT(length(area_normal(room, f)), 0) << "face " << f;
    ASSERT_LT(room.face_materials[f], room.materials.size());
    used.insert(room.face_materials[f]);
    lit = lit || room.materials[room.face_materials[f]].emission[0] > 0;
  }
  for (const auto& p : room.mesh.vertices) EXPECT_TRUE(is_finite(p));
  EXPECT_EQ(used.size(), room.materials.size()) << "a material without a face";
  EXPECT_TRUE(lit) << "no light at all";
  for (const auto& m : room.materials)
    for (int c = 0; c < 3; ++c)
      EXPECT_TRUE(m.reflectance[c] >= 0 && m.reflectance[c] <= 1 && m.emission[c] >= 0) << m.name;
  const auto& camera = room.camera;
  EXPECT_GT(length(cross(camera.target - camera.position, camera.up)), 1e-6);
}

TEST(Rooms, ClosedBoxesAreSeenFromInsideAndWhole) {
  for (const char* name : {"closed_box", "closed_box_0.5_0.02", "closed_box_0.2_1.5"}) {
    const LitScene room = make_room(name, 3000, 1);
    const double side = read_knobs("room", name, room_recipes()[2])[1];
    auto area = areas(room);
    for (const char* wall : {"floor", "left", "right", "back", "front"}) EXPECT_NEAR(area[wall], 4, 1e-5);
    EXPECT_NEAR(area["lamp"], side * side, 1e-5);
    EXPECT_NEAR(area["ceiling"], 4 - side * side, 1e-5);
    for (std::size_t f = 0; f < room.mesh.size(); ++f)
      EXPECT_GT(dot(area_normal(room, f), Vec3d{0, 1, 0} - Vec3d(room.mesh.triangle(f).a)), 0)
          << "face " << f;
    // What is emitted is (1 - albedo) of what leaves all of it, at a mean radiance of 1.
    const auto& lamp = room.materials.back();
    EXPECT_NEAR(double(lamp.emission[1]) * side * side, (1 - double(lamp.reflectance[1])) * 24, 1e-3);
  }
}

TEST(Rooms, FurnacesGiveBackWhatTheyTake) {
  for (const char* name : {"furnace_room", "furnace_room_0.9", "furnace_spheres"}) {
    const LitScene room = make_room(name, 2000, 1);
    for (const auto& m : room.materials)
      if (m.kind == shading::SurfaceKind::diffuse)
        for (int c = 0; c < 3; ++c) EXPECT_FLOAT_EQ(m.emission[c] + m.reflectance[c], 1) << m.name;
    EXPECT_TRUE(geometry::Adjacency(room.mesh).closed()) << name;
  }
}

TEST(Rooms, NamesThatAreNoneAreRefused) {
  const auto message = [](const std::string& name, std::size_t n) {
    try {
      make_room(name, n, 1);
    } catch (const std::invalid_argument& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_NE(message("ballroom", 100).find("cornell_box"), std::string::npos);
  EXPECT_NE(message("furnace_room_1.5", 100).find("albedo"), std::string::npos);
  EXPECT_NE(message("closed_box_0.5_0.1_7", 100), "");
  EXPECT_NE(message("closed_box_x", 100), "");
  EXPECT_NE(message("closed_box", 11), "");
  EXPECT_FALSE(is_room("city"));
  EXPECT_TRUE(is_room("near_contact_0.1"));
}

TEST(Rooms, AnyMeshGetsAFloorALampAndASky) {
  const geometry::Mesh3f knot = generate("torus_knot", 2000, 1).mesh;
  const std::size_t faces = knot.size();
  const LitScene room = room_of_mesh(knot, "knot");
  ASSERT_EQ(room.face_materials.size(), room.mesh.size());
  EXPECT_EQ(room.face_materials[faces - 1], 0u);
  EXPECT_EQ(room.face_materials[faces], 1u);
  EXPECT_EQ(room.face_materials.back(), 2u);
  EXPECT_GT(area_normal(room, faces)[1], 0);
  EXPECT_LT(area_normal(room, room.mesh.size() - 1)[1], 0) << "the lamp looks down";
  EXPECT_GT(room.materials[2].emission[0], 0);
  EXPECT_GT(room.background[2], 0);
  EXPECT_THROW(room_of_mesh({}, "nothing"), std::invalid_argument);
}

TEST(Rooms, EqualContentHasEqualHashes) {
  const auto hash = [](const auto& change) {
    Dataset d = generate("cornell_box", 500, 1);
    change(d.room);
    return d.hash();
  };
  const auto same = hash([](LitScene&) {});
  EXPECT_EQ(same, hash([](LitScene&) {}));
  EXPECT_NE(same, hash([](LitScene& r) { r.materials[0].reflectance[1] = 0.1f; }));
  EXPECT_NE(same, hash([](LitScene& r) { r.face_materials[0] = 1; }));
  EXPECT_NE(same, hash([](LitScene& r) { r.camera.width = 7; }));
  EXPECT_NE(same, hash([](LitScene& r) { r.background[0] = 1; }));
}

TEST(HardLights, SayWhatTheyAreAndStaySmall) {
  std::set<std::string> names;
  for (const HardLight& c : hard_lights()) {
    EXPECT_TRUE(names.insert(c.name).second) << "twice: " << c.name;
    EXPECT_FALSE(c.source.empty() || c.law.empty()) << c.name;
    const LitScene room = c.make();
    EXPECT_LE(room.mesh.size(), 3000u) << c.name;
    EXPECT_LE(room.camera.width * room.camera.height, 400) << c.name;
  }
  EXPECT_GE(names.size(), 15u);
}

}  // namespace
}  // namespace treeline::datasets
