// Shadow volumes: against rays, pixel by pixel and layer by layer; and where each of their tests fails.
#include "shading/shadow/shadow_volumes.hpp"

#include <gtest/gtest.h>

#include <set>

#include "accel/bvh/wide_triangles.hpp"
#include "shading/shadow/area_rays.hpp"
#include "tests/accel/triangles_common.hpp"
#include "tests/shading/shadow_scenes.hpp"

namespace treeline::shading::shadow::test {
namespace {

using namespace shading::test;
using Tree = accel::Bvh<accel::Triangles<float, geometry::Watertight>, accel::Wide>;
using geometry::Pcg32;

ShadowVolumeOptions options(VolumeTest test) {
  ShadowVolumeOptions o;
  o.test = test;
  return o;
}
Mesh3f box(const Vec3f& low, const Vec3f& high) {
  Mesh3f mesh;
  accel::test::add_box(mesh, geometry::Box3f{low, high});
  return mesh;
}
Light sun() {
  Light light;
  light.direction = normalized(Vec3d{0.45, -1, 0.3});
  return light;
}
Light lamp(const Vec3d& at) {
  Light light;
  light.kind = LightKind::point, light.position = at;
  return light;
}

/// A floor, seen from the side; what stands on it is to be added.
Scene floor_scene(const Light& light) {
  Scene scene;
  add_quad(scene.mesh, {0, 0, 0}, {0, 0, 12}, {12, 0, 0});
  scene.camera.position = {1, 5, 9}, scene.camera.target = {0.5, 0.5, 0};
  scene.camera.width = 160, scene.camera.height = 120;
  scene.light = light;
  return scene;
}
void add_closed_bodies(Scene& scene) {
  append(scene.mesh, box({-2, 0, -1}, {-1, 1.5f, 0.2f}));
  append(scene.mesh, accel::test::sphere<float>(3, {0.7f, 1.1f, 0.3f}, 0.8f));
  append(scene.mesh, box({-1.5f, 2, -0.8f}, {1, 2.2f, 0.9f}));
}
/// A sheet, a ball without its lid, three sheets at one edge, and one edge with six more.
void add_open_bodies(Scene& scene) {
  add_quad(scene.mesh, {-1.5, 1.4, 0.4}, {0.6, 0.2, 0}, {0, 0.1, 0.7});
  Mesh3f ball = accel::test::sphere<float>(3, {1, 1.2f, 0}, 0.8f);
  std::erase_if(ball.faces, [&](const auto& f) { return ball.vertices[f[0]][1] > 1.6f; });
  append(scene.mesh, ball);
  const Vec3d a{-0.6, 0.3, -1.2}, b{-0.4, 1.9, -1};
  for (int i = 0; i < 9; ++i) {
    const double angle = 0.7 * i;
    add_triangle(scene.mesh, a, b, Vec3d{-0.5 + std::cos(angle), 1, -1.1 + std::sin(angle)});
  }
}

struct Seen {
  std::vector<Receiver> receivers;
  std::vector<float> truth;
};
Seen seen_of(const Scene& scene) {
  const Tree tree(scene.mesh);
  Seen s{seen_by_camera(scene, tree), {}};
  s.truth.resize(s.receivers.size());
  AreaRays(tree, scene).visibility(s.receivers, s.truth);
  return s;
}
bool is_seen(const Receiver& r) { return !(r.normal == Vec3d{}); }

/// Share of the pixels with something to see that are wrong: all of them, and those with no border of a
/// shadow within one pixel.
struct Wrong {
  double all = 0, far_from_borders = 0;
};
Wrong compare(const Scene& scene, const Seen& seen, const std::vector<float>& found) {
  const int w = scene.camera.width, h = scene.camera.height;
  Wrong wrong;
  double pixels = 0;
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      const auto at = [&](int i, int j) {
        return seen.truth[static_cast<std::size_t>(std::clamp(j, 0, h - 1) * w + std::clamp(i, 0, w - 1))];
      };
      if (!is_seen(seen.receivers[static_cast<std::size_t>(y * w + x)])) continue;
      ++pixels;
      if (found[static_cast<std::size_t>(y * w + x)] == at(x, y)) continue;
      bool border = false;
      for (int j = -1; j <= 1; ++j)
        for (int i = -1; i <= 1; ++i) border |= at(x + i, y + j) != at(x, y);
      wrong.all += 1, wrong.far_from_borders += border ? 0 : 1;
    }
  wrong.all /= pixels, wrong.far_from_borders /= pixels;
  return wrong;
}
Wrong wrong_pixels(const Scene& scene, const Seen& seen, const ShadowVolumeOptions& o) {
  std::vector<float> found(seen.receivers.size());
  ShadowVolumes(scene, o).visibility(seen.receivers, found);
  return compare(scene, seen, found);
}
double shadowed_share(const Seen& seen) {
  double sum = 0, pixels = 0;
  for (std::size_t i = 0; i < seen.truth.size(); ++i)
    if (is_seen(seen.receivers[i])) sum += 1 - double(seen.truth[i]), ++pixels;
  return sum / pixels;
}

TEST(ShadowVolumes, AreWhatRaysSee) {
  for (const Light& light : {sun(), lamp({-3, 6, 2}), lamp({0.2, 3.4, 0.1})})
    for (const int bodies : {1, 2, 3}) {
      Scene scene = floor_scene(light);
      if (bodies & 1) add_closed_bodies(scene);
      if (bodies & 2) add_open_bodies(scene);
      const Seen seen = seen_of(scene);
      EXPECT_GT(shadowed_share(seen), 0.02);
      for (const VolumeTest test : {VolumeTest::z_pass, VolumeTest::z_fail}) {
        const Wrong wrong = wrong_pixels(scene, seen, options(test));
        EXPECT_EQ(wrong.far_from_borders, 0) << bodies << ' ' << int(test);
        EXPECT_LT(wrong.all, 2e-4) << bodies << ' ' << int(test);
      }
    }
}

TEST(ShadowVolumes, HoldForASpotAndTheMiddleOfAnArea) {
  for (const LightKind kind : {LightKind::spot, LightKind::rectangle}) {
    Light light = lamp({-3, 6, 2});
    Scene scene = floor_scene(light);
    add_closed_bodies(scene);
    const Seen seen = seen_of(scene);
    scene.light.kind = kind;
    EXPECT_EQ(wrong_pixels(scene, seen, options(VolumeTest::z_fail)).far_from_borders, 0);
  }
}

// The eye inside one volume: z-pass is off by one wherever it looks, z-fail is not.
TEST(ShadowVolumes, EyeInsideAVolume) {
  for (const Light& light : {sun(), lamp({-3, 6, 2})}) {
    Scene scene = floor_scene(light);
    append(scene.mesh, box({-1, 2.6f, -1}, {1, 3, 1}));
    // In the shadow of the box: from its middle on along the light.
    const Vec3d way =
        light.kind == LightKind::point ? normalized(Vec3d{0, 2.8, 0} - light.position) : light.direction;
    scene.camera.position = Vec3d{0, 2.8, 0} + way * 1.2, scene.camera.target = {3, 0, 1};
    scene.camera.height_angle = 1.4;
    const Seen seen = seen_of(scene);
    EXPECT_GT(shadowed_share(seen), 0.05);
    EXPECT_GT(wrong_pixels(scene, seen, options(VolumeTest::z_pass)).all, 0.999);
    EXPECT_EQ(wrong_pixels(scene, seen, options(VolumeTest::z_fail)).far_from_borders, 0);
    const ShadowVolumes volumes(scene);
    for (std::size_t i = 0; i < seen.receivers.size(); i += 97) {
      const VolumeCounts<> c = volumes.count<int>(seen.receivers[i]);
      EXPECT_EQ(c.behind, c.before + 1);
    }
  }
}

// The part of the near plane that a volume covers is the part of the image where z-pass misses an entry.
TEST(ShadowVolumes, NearPlaneCutsAVolume) {
  Scene scene = floor_scene(Light{});
  scene.light.direction = {0, -1, 0};
  append(scene.mesh, box({-12, 4, -12}, {0, 4.2f, 8}));  // its shadow: x < 0, from z = 8 on
  scene.camera.position = {0.01, 1, 8.5}, scene.camera.target = {0.01, 0, 4.5};
  scene.camera.height_angle = 0.4;
  const Seen seen = seen_of(scene);
  EXPECT_NEAR(shadowed_share(seen), 0.5, 0.05);
  ShadowVolumeOptions o = options(VolumeTest::z_pass);
  EXPECT_EQ(wrong_pixels(scene, seen, o).far_from_borders, 0);
  o.near = 0.2;  // not yet there
  EXPECT_EQ(wrong_pixels(scene, seen, o).far_from_borders, 0);
  o.near = 1;  // left half
  EXPECT_NEAR(wrong_pixels(scene, seen, o).all, 0.5, 0.02);
  o.test = VolumeTest::z_fail;
  EXPECT_EQ(wrong_pixels(scene, seen, o).far_from_borders, 0);
}

TEST(ShadowVolumes, ZFailNeedsCapsAndNoFarPlane) {
  Scene scene = floor_scene(lamp({-3, 6, 2}));
  add_closed_bodies(scene), add_open_bodies(scene);
  const Seen seen = seen_of(scene);
  const auto wrong = [&](auto&& change) {
    ShadowVolumeOptions o = options(VolumeTest::z_fail);
    change(o);
    return wrong_pixels(scene, seen, o).all;
  };
  const double front = wrong([](auto& o) { o.volumes.front_caps = false; });
  const double back = wrong([](auto& o) { o.volumes.back_caps = false; });
  const double far = wrong([](auto& o) { o.far = 14; });
  std::printf("z-fail wrong: no front caps %.3f, no back caps %.3f, far plane %.3f, of shadowed %.3f\n",
              front, back, far, shadowed_share(seen));
  EXPECT_GT(front, 0.02);
  EXPECT_GT(back, 0.02);
  EXPECT_GT(far, 0.02);
  // z-pass sees neither cap, as long as what casts hides them.
  ShadowVolumeOptions o = options(VolumeTest::z_pass);
  o.volumes.front_caps = o.volumes.back_caps = false;
  EXPECT_EQ(wrong_pixels(scene, seen, o).far_from_borders, 0);
  // A far plane behind everything that is seen, and volumes that end between: open again at the back.
  o = options(VolumeTest::z_fail);
  o.volumes.extrusion = 40;
  EXPECT_EQ(wrong_pixels(scene, seen, o).far_from_borders, 0);
  o.volumes.extrusion = 1;
  EXPECT_GT(wrong_pixels(scene, seen, o).all, 0.02);
}

// One face missing of a ball: its part is open, so that all of it casts; the textbook's casters go wrong
// where light falls in.
TEST(ShadowVolumes, AFaceMissing) {
  Scene scene = floor_scene(sun());
  Mesh3f ball = accel::test::sphere<float>(1, {0.5f, 1.5f, 0}, 1.2f);
  const auto lights = [&](const auto& f) {
    const geometry::Triangle3d t{Vec3d(ball.vertices[f[0]]), Vec3d(ball.vertices[f[1]]),
                                 Vec3d(ball.vertices[f[2]])};
    return dot(normalized(t.area_normal()), scene.light.direction) < -0.9;
  };
  ball.faces.erase(std::find_if(ball.faces.begin(), ball.faces.end(), lights));
  append(scene.mesh, ball);
  const Seen seen = seen_of(scene);
  ShadowVolumeOptions o;
  EXPECT_EQ(wrong_pixels(scene, seen, o).far_from_borders, 0);
  o.volumes.casters = Casters::light_facing;
  EXPECT_GT(wrong_pixels(scene, seen, o).far_from_borders, 0.002);
}

// In how many volumes a point lies is how many casters are between it and the light.
TEST(ShadowVolumes, CountLayers) {
  for (const Light& light : {sun(), lamp({-3, 6, 2})})
    for (const Casters casters : {Casters::light_facing, Casters::all}) {
      Scene scene = floor_scene(light);
      add_closed_bodies(scene);
      if (casters == Casters::all) add_open_bodies(scene);
      const Tree tree(scene.mesh);
      ShadowVolumeOptions o;
      o.volumes.casters = casters;
      const ShadowVolumes volumes(scene, o);
      Pcg32 random(3);
      std::vector<accel::Hit<float>> hits;
      int deepest = 0;
      for (int i = 0; i < 3000; ++i) {
        const Receiver r{{random.uniform(-4.0, 4.0), random.uniform(-1.0, 4.0), random.uniform(-4.0, 4.0)},
                         {}};
        geometry::Rayf ray{Vec3f(r.position), {}};
        const Vec3d origin(ray.origin);
        ray.direction = Vec3f(light.kind == LightKind::point ? light.position - origin : -light.direction);
        if (light.kind == LightKind::point) ray.t_max = 1;
        tree.all_hits(ray, hits);
        int layers = 0;
        for (const auto& hit : hits) {
          const geometry::Triangle3d t(scene.mesh.triangle(hit.primitive));
          layers += casters == Casters::all || dot(t.area_normal(), Vec3d(ray.direction)) > 0 ? 1 : 0;
        }
        deepest = std::max(deepest, layers);
        const VolumeCounts<> c = volumes.count<int>({origin, {}});
        ASSERT_EQ(c.behind, layers) << i;
        ASSERT_EQ(c.before, layers) << i;  // the eye is lit
      }
      EXPECT_GT(deepest, 2);
    }
}

// Drawn or asked singly; in the image, beside it and behind the eye.
TEST(ShadowVolumes, BatchesAgreeWithSingleQueries) {
  for (const Light& light : {sun(), lamp({0.3, 3, 0.2})}) {
    Scene scene = floor_scene(light);
    add_closed_bodies(scene), add_open_bodies(scene);
    scene.camera.position = {0.4, 1.2, 2.5};
    const ShadowVolumes volumes(scene);
    Pcg32 random(8);
    std::vector<Receiver> receivers;
    for (int i = 0; i < 4000; ++i)
      receivers.push_back(
          {{random.uniform(-4.0, 4.0), random.uniform(-1.0, 4.0), random.uniform(-5.0, 5.0)}, {0, 1, 0}});
    std::vector<VolumeCounts<std::int16_t>> counts(receivers.size());
    volumes.count(receivers, std::span(counts));
    for (std::size_t i = 0; i < receivers.size(); ++i)
      ASSERT_EQ(counts[i], volumes.count<std::int16_t>(receivers[i])) << i;
  }
}

// A stencil buffer's 8 bits are full after 256 layers.
TEST(ShadowVolumes, EightBitsWrapAround) {
  for (const int layers : {255, 256}) {
    Scene scene = floor_scene(sun());
    for (int i = 0; i < layers; ++i) add_quad(scene.mesh, {0, 2 + 0.002 * i, 0}, {0, 0, 1}, {1, 0, 0});
    const ShadowVolumes volumes(scene);
    const Receiver r{Vec3d{0, 2, 0} + scene.light.direction * 1.5, {0, 1, 0}};
    float narrow, wide;
    volumes.visibility<std::int8_t>(std::span(&r, 1), std::span(&narrow, 1));
    volumes.visibility<std::int16_t>(std::span(&r, 1), std::span(&wide, 1));
    EXPECT_EQ(wide, 0);
    EXPECT_EQ(narrow, layers == 256 ? 1 : 0);
  }
}

// Silhouettes are cycles: at every vertex, as many edges come in as go out.
TEST(VolumeBoundary, SilhouettesAreCycles) {
  Scene scene = floor_scene(lamp({-3, 6, 2}));
  add_closed_bodies(scene), add_open_bodies(scene);
  VolumeOptions o;
  o.front_caps = o.back_caps = false;
  const VolumeBoundary boundary(scene, o);
  std::vector<int> balance(boundary.points().size());
  for (const auto& face : boundary.faces())
    balance[face.corners[0]] += face.multiplicity, balance[face.corners[1]] -= face.multiplicity;
  for (const int b : balance) EXPECT_EQ(b, 0);
  EXPECT_EQ(boundary.faces().size(), boundary.silhouette_edges());
}

// A convex body has one outline, a closed walk. Equilateral faces of a unit ball have sides of 5.39 / root of
// their number, and a straight walk around it some 1.17 roots of them; this one turns at every corner.
TEST(VolumeBoundary, ABallHasOneOutline) {
  for (const int levels : {3, 4, 5}) {
    Scene scene;
    scene.mesh = accel::test::sphere<float>(levels);
    scene.light = lamp({3, 7, 2});
    const VolumeBoundary boundary(scene);
    std::set<std::uint32_t> from;
    std::size_t sides = 0;
    for (const auto& face : boundary.faces())
      if (face.size == 4) {
        ++sides, from.insert(face.corners[0]);
        EXPECT_EQ(face.multiplicity, 1);
      }
    EXPECT_EQ(sides, boundary.silhouette_edges());
    EXPECT_EQ(from.size(), sides);
    EXPECT_NEAR(double(sides) / std::sqrt(double(scene.mesh.size())), 1.5, 0.3);
    EXPECT_NEAR(double(boundary.casters()) / double(scene.mesh.size()), 0.5, 0.1);
  }
}

TEST(VolumeBoundary, RefusesWhatIsNone) {
  Scene scene = floor_scene(sun());
  scene.light.direction = {};
  EXPECT_THROW(VolumeBoundary{scene}, InvalidScene);
  scene.light = lamp({NAN, 0, 0});
  EXPECT_THROW(VolumeBoundary{scene}, InvalidScene);
  scene.light = sun();
  VolumeOptions o;
  o.extrusion = 0;
  EXPECT_THROW(VolumeBoundary(scene, o), InvalidScene);
  scene.camera.target = scene.camera.position;
  EXPECT_THROW(ShadowVolumes{scene}, InvalidScene);
  scene.camera.target = {};
  scene.mesh.faces.push_back({0, 1, 77});
  EXPECT_THROW(ShadowVolumes{scene}, InvalidScene);
  scene.mesh.faces.pop_back();
  scene.mesh.vertices.push_back({NAN, 0, 0});
  scene.mesh.faces.push_back({0, 1, static_cast<std::uint32_t>(scene.mesh.vertices.size() - 1)});
  EXPECT_EQ(VolumeBoundary(scene).casters(), 2u);  // what is not finite casts nothing
}

}  // namespace
}  // namespace treeline::shading::shadow::test
