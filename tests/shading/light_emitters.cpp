// A scene's emitting faces as one light: densities, unbiased sums, and what is refused.
#include <gtest/gtest.h>

#include <limits>

#include "shading/light/emitters.hpp"
#include "tests/shading/chi_square.hpp"

namespace treeline::shading::light {
namespace {

using geometry::Pcg32;
using geometry::Vec2d;
using geometry::Vec3d;
using geometry::Vec3f;

/// Triangles of very different sizes, each at x = 10 i, facing up; face i is of material i % 4, and material
/// 3 does not emit.
LitScene lamps(int faces = 11) {
  LitScene scene;
  Pcg32 random(5);
  for (int m = 0; m < 4; ++m) {
    Material lamp;
    lamp.name = "lamp";
    if (m < 3) lamp.emission = {random.uniform(0.0f, 4.0f), random.uniform(0.0f, 9.0f), m == 1 ? 0.0f : 1.0f};
    scene.materials.push_back(lamp);
  }
  for (int i = 0; i < faces; ++i) {
    const float size = std::pow(10.0f, random.uniform(-2.0f, 0.5f)), x = 10.0f * static_cast<float>(i);
    const auto first = static_cast<std::uint32_t>(scene.mesh.vertices.size());
    scene.mesh.vertices.push_back({x, 0, 0});
    scene.mesh.vertices.push_back({x, 0, size});
    scene.mesh.vertices.push_back({x + size, 0, 0.3f * size});
    scene.mesh.faces.push_back({first, first + 1, first + 2});
    scene.face_materials.push_back(static_cast<std::uint32_t>(i % 4));
  }
  return scene;
}
Rgb emission_of(const LitScene& scene, std::size_t face) {
  return scene.materials[scene.face_materials[face]].emission;
}

TEST(Emitters, DensityIntegratesToOneAndPowerIsPiTimesAreaTimesRadiance) {
  const LitScene scene = lamps();
  const Emitters emitters(scene);
  EXPECT_EQ(emitters.size(), 9u);  // faces 3 and 7 are dark
  double mass = 0;
  Vec3d power;
  for (std::size_t i = 0; i < scene.mesh.size(); ++i) {
    const double area = scene.mesh.triangle(i).area();
    mass += area * emitters.pdf_area(static_cast<std::uint32_t>(i));
    power += Vec3d(emission_of(scene, i)) * area * std::numbers::pi;
  }
  EXPECT_NEAR(mass, 1, 1e-6);
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(emitters.power()[k], power[k], 1e-6 * power[k]);
  EXPECT_EQ(emitters.pdf_area(3), 0);
}

TEST(Emitters, SamplesLieOnTheirFacesAsOftenAsTheirDensitySays) {
  const LitScene scene = lamps();
  const Emitters emitters(scene);
  test::TestFamily family;
  constexpr int n = 200'000;
  std::vector<double> counts(scene.mesh.size()), expected(scene.mesh.size());
  Pcg32 random(1);
  Vec3d sum;
  for (int i = 0; i < n; ++i) {
    const double choice = random.uniform<double>();
    const float u = random.uniform<float>(), v = random.uniform<float>();
    const EmitterSample s = emitters.sample(choice, u, v);
    ++counts[s.face];
    EXPECT_EQ(s.pdf_area, emitters.pdf_area(s.face));
    EXPECT_EQ(s.emission, emission_of(scene, s.face));
    EXPECT_NEAR(s.normal[1], 1, 1e-6);
    EXPECT_EQ(s.point[1], 0);
    EXPECT_EQ(static_cast<int>(s.point[0] / 10), static_cast<int>(s.face));
    sum += Vec3d(s.emission) * (std::numbers::pi / s.pdf_area / n);
  }
  for (std::size_t i = 0; i < scene.mesh.size(); ++i)
    expected[i] = n * scene.mesh.triangle(i).area() * emitters.pdf_area(static_cast<std::uint32_t>(i));
  family.add("faces", test::chi_square(counts, expected));
  // Luminance over density is the same for every sample: the sum of luminances has no variance at all.
  EXPECT_NEAR(luminance(sum), luminance(emitters.power()), 1e-5 * luminance(sum));

  // Evenly within a face: by the two ratios of areas that a triangle's own map is inverted by.
  family.add("points", test::chi_square_square(
                           [&](Pcg32& r) -> std::optional<Vec2d> {
                             const float u = r.uniform<float>(), v = r.uniform<float>();
                             const EmitterSample s = emitters.sample(0, u, v);  // of the first face
                             const auto t = scene.mesh.triangle(s.face);
                             const double size = t.b[2];
                             const double x = (s.point[0] - t.a[0]) / size;  // weight of corner c
                             const double z = s.point[2] / size - 0.3 * x;   // of b
                             return Vec2d{1 - (1 - x) * (1 - x), z / (1 - x)};
                           },
                           [](const Vec2d&) { return 1.0; }));
}

TEST(Emitters, ManyFacesAreFoundFromTheTableOfGuesses) {
  const LitScene scene = lamps(5000);
  const Emitters emitters(scene);
  double before = 0;
  std::uint32_t last = 0;
  for (int i = 0; i < 100'000; ++i) {  // choices in order find faces in order, each as long as its share
    const EmitterSample s = emitters.sample((i + 0.5) / 100'000, 0.2f, 0.6f);
    ASSERT_GE(s.face, last);
    for (; last < s.face; ++last) before += scene.mesh.triangle(last).area() * emitters.pdf_area(last);
    ASSERT_GE((i + 0.5) / 100'000, before - 1e-5);
    ASSERT_LE((i + 0.5) / 100'000, before + scene.mesh.triangle(last).area() * s.pdf_area + 1e-5);
  }
}

TEST(Emitters, DarkAndFlatFacesAreNoLight) {
  LitScene scene = lamps();
  for (auto& v : scene.mesh.vertices) v[2] = 0;  // all flat now
  EXPECT_TRUE(Emitters(scene).empty());
  EXPECT_TRUE(Emitters(LitScene{}).empty());
  scene = lamps();
  for (Material& m : scene.materials) m.emission = {};
  EXPECT_TRUE(Emitters(scene).empty());
  EXPECT_EQ(Emitters(scene).pdf_area(0), 0);
}

std::string refusal(const LitScene& scene) {
  try {
    Emitters e(scene);
  } catch (const InvalidLight& e) {
    return e.what();
  }
  return "";
}

TEST(Emitters, RefusalsNameFaceAndMaterial) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  LitScene scene = lamps();
  scene.face_materials.pop_back();
  EXPECT_EQ(refusal(scene), "the scene has 11 faces, but materials for 10");
  scene = lamps(), scene.face_materials[4] = 9;
  EXPECT_EQ(refusal(scene), "face 4 is of material 9 of 4");
  for (const float bad : {-1.0f, nan, std::numeric_limits<float>::infinity()}) {
    scene = lamps(), scene.materials[2].emission[1] = bad;
    EXPECT_NE(refusal(scene).find("material 2 'lamp' emits"), std::string::npos) << refusal(scene);
  }
  scene = lamps(), scene.mesh.vertices[6][1] = nan;
  EXPECT_EQ(refusal(scene), "face 2 emits, but its vertex 6 is missing or not finite");
  scene = lamps(), scene.mesh.faces[2][1] = 1000;
  EXPECT_EQ(refusal(scene), "face 2 emits, but its vertex 1000 is missing or not finite");
}

}  // namespace
}  // namespace treeline::shading::light
