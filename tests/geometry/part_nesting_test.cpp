// Parts that look the wrong way, against what follows from how they were put into one another.
#include "geometry/part_nesting.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "geometry/mesh_check.hpp"
#include "tests/geometry/meshes.hpp"

namespace treeline::test {
namespace {

void add(Mesh3f& mesh, Mesh3f part, bool inward) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), part.vertices.begin(), part.vertices.end());
  for (auto f : part.faces) {
    if (inward) std::swap(f[0], f[1]);
    mesh.faces.push_back({f[0] + first, f[1] + first, f[2] + first});
  }
}

// Shells around common centres, each looking either way: what is around one is the sum of those outside of
// it.
TEST(PartNesting, IsWhatTheShellsAroundSay) {
  Pcg32 random(1);
  std::size_t wrong = 0, right = 0;
  for (int trial = 0; trial < 40; ++trial) {
    Mesh3f mesh;
    std::vector<std::uint32_t> expected;  // first faces
    for (std::uint32_t cluster = 0; cluster < 6; ++cluster) {
      // Beside each other in x, y and z, so that columns pass other clusters.
      const Vec3f centre = Vec3f{float(cluster % 2), float(cluster / 2 % 2), float(cluster / 4)} * 2.5f;
      struct Shell {
        std::uint32_t first_face;
        float radius;
        bool inward;
      };
      std::vector<Shell> shells;
      const std::uint32_t count = 1 + random.below(6);
      for (std::uint32_t s = 0; s < count; ++s) {
        const Shell shell{static_cast<std::uint32_t>(mesh.size()),
                          1.f / static_cast<float>(1 + (s * 5 + trial) % 7), random.below(2) == 1};
        shells.push_back(shell);
        // Convex shapes of different faces, one well within the other.
        add(mesh,
            moved(random.below(2) == 0 ? octahedron<float>() : sphere<float>(1), centre,
                  std::pow(0.5f, 1 / shell.radius)),
            shell.inward);
      }
      for (const Shell& s : shells) {
        int around = 0;
        for (const Shell& other : shells)
          if (other.radius > s.radius) around += other.inward ? -1 : 1;
        if (around != (s.inward ? 1 : 0)) expected.push_back(s.first_face);
      }
      wrong += expected.size(), right += shells.size();
    }
    const MeshCheck check = check_mesh(mesh, 100);
    ASSERT_TRUE(check.closed && check.oriented);
    std::vector<std::uint32_t> found;
    for (const auto& e : check.misnested_components.first) found.push_back(e.faces.at(0));
    EXPECT_EQ(found, expected);
    EXPECT_EQ(check.misnested_components.count, expected.size());
  }
  EXPECT_GT(wrong, 100u);
  EXPECT_GT(right, 100u);
}

// What is not finite leaves a part open: nothing is told of what lies within its box.
TEST(PartNesting, SaysNothingBesidePartsThatAreNotWhole) {
  const auto misnested = [](bool broken) {
    Mesh3f mesh = sphere<float>(2);
    if (broken) mesh.vertices[20] = Vec3f::filled(std::numeric_limits<float>::quiet_NaN());
    add(mesh, moved(octahedron<float>(), {}, 0.5f), false);
    add(mesh, moved(octahedron<float>(), {5, 0, 0}), true);
    return check_mesh(mesh).misnested_components.count;
  };
  EXPECT_EQ(misnested(false), 2u);
  EXPECT_EQ(misnested(true), 1u);
}

// Each part asks for the few whose boxes hold a point of it.
TEST(PartNesting, LooksAtFewBoxesAPart) {
  const Mesh3f one = octahedron<float>();
  const auto boxes = [&](std::uint32_t n, const auto& place, bool in_a_large_one) {
    Mesh3f mesh;
    std::vector<PartNesting::Part> parts;
    const auto part = [&](const Mesh3f& m, bool inward) {
      PartNesting::Part p;
      for (std::uint32_t f = 0; f < m.size(); ++f)
        p.faces.push_back(static_cast<std::uint32_t>(mesh.size()) + f);
      p.volume = inward ? -1 : 1;
      add(mesh, m, inward);
      parts.push_back(std::move(p));
    };
    for (std::uint32_t i = 0; i < n; ++i) part(moved(one, place(i)), in_a_large_one);
    if (in_a_large_one) part(moved(one, {}, 0x1p20f), false);
    PartNesting nesting(mesh, parts);
    for (std::size_t i = 0; i < parts.size(); ++i) EXPECT_FALSE(nesting.looks_the_wrong_way(i)) << i;
    return static_cast<double>(nesting.boxes());
  };
  const auto in_a_block = [](std::uint32_t i) {
    return Vec3f{float(i % 16), float(i / 16 % 16), float(i / 256)} * 3.f;
  };
  const auto in_a_row = [](std::uint32_t i) { return Vec3f{0, 0, float(i) * 3}; };
  for (const bool in_a_large_one : {false, true}) {
    EXPECT_LT(boxes(4096, in_a_block, in_a_large_one), 100 * 4096);
    EXPECT_LT(boxes(4096, in_a_row, in_a_large_one), 100 * 4096);
  }
}

}  // namespace
}  // namespace treeline::test
