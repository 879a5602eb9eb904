// Pairs of faces that meet, against the exact predicate asked about all pairs, on meshes whose faces crowd
// around few corners; and how much of them is looked at.
#include "accel/near_faces.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <numbers>

#include "accel/bsp_solid/parts.hpp"
#include "accel/self_intersections.hpp"
#include "geometry/mesh_check.hpp"
#include "tests/geometry/meshes.hpp"

namespace treeline::test {
namespace {

using Pair = accel::SelfIntersections::Pair;

/// Around an apex above the rim of a disc, closed below around the disc's middle: 2 n faces.
Mesh3f cone(std::uint32_t n, float height) {
  Mesh3f m{{{0, 0, height}, {0, 0, 0}}, {}};
  for (std::uint32_t i = 0; i < n; ++i) {
    const double a = 2 * std::numbers::pi * i / n;
    m.vertices.push_back(Vec3f(Vec3d{std::cos(a), std::sin(a), 0}));
    const std::uint32_t here = 2 + i, next = 2 + (i + 1) % n;
    m.faces.push_back({0, here, next});
    m.faces.push_back({1, next, here});
  }
  return m;
}

/// Faces around a few corners, each with one, two or three of these, the others drawn by place().
template <class Place>
Mesh3f around_few(Pcg32& random, std::uint32_t few, std::uint32_t faces, const Place& place) {
  Mesh3f m;
  for (std::uint32_t i = 0; i < few + faces; ++i) m.vertices.push_back(place());
  const auto any = [&] { return few + random.below(faces); };
  for (std::uint32_t i = 0; i < faces; ++i) {
    std::array<std::uint32_t, 3> f{random.below(few), any(), any()};
    if (i % 8 == 0) f[1] = random.below(few);
    if (i % 64 == 0) f[2] = random.below(few);
    std::ranges::rotate(f, f.begin() + i % 3);
    m.faces.push_back(f);
  }
  return m;
}

/// Each face with corners of its own.
Mesh3f soup_of(const Mesh3f& mesh) {
  Mesh3f m;
  for (const auto& f : mesh.faces) {
    const auto n = static_cast<std::uint32_t>(m.vertices.size());
    for (const std::uint32_t v : f) m.vertices.push_back(mesh.vertices[v]);
    m.faces.push_back({n, n + 1, n + 2});
  }
  return m;
}

/// Of all faces that have an area; copies of a face stay in.
std::vector<std::uint32_t> with_area(const Mesh3f& mesh) {
  std::vector<std::uint32_t> r;
  for (std::uint32_t f = 0; f < mesh.size(); ++f)
    if (!is_degenerate(mesh.triangle(f))) r.push_back(f);
  return r;
}

/// Returns how many pairs cross.
std::size_t expect_all_found(const Mesh3f& mesh) {
  const auto faces = with_area(mesh);
  std::vector<Pair> expected;
  std::vector<bool> touched(faces.size());
  for (std::uint32_t i = 0; i < faces.size(); ++i)
    for (std::uint32_t j = i + 1; j < faces.size(); ++j) {
      const Triangle3f s = mesh.triangle(faces[i]), t = mesh.triangle(faces[j]);
      const bool crosses = cross_each_other(s, t);
      if (crosses) expected.push_back({faces[i], faces[j]});
      if (crosses || SharedCorners(s, t).count == 3) touched[i] = touched[j] = true;
    }
  for (const Mesh3f& m : {mesh, soup_of(mesh)}) {
    const auto found = accel::self_intersections(m, faces, {.kept = expected.size() + 1, .threads = 1});
    EXPECT_EQ(found.count, expected.size());
    EXPECT_EQ(found.pairs, expected);
    const auto shared_out = accel::self_intersections(m, faces, {.kept = 10, .threads = 3});
    EXPECT_EQ(shared_out.count, expected.size());
  }
  Mesh3d doubles;
  for (const std::uint32_t f : faces) {
    const auto n = static_cast<std::uint32_t>(doubles.vertices.size());
    const Triangle3d t(mesh.triangle(f));
    doubles.vertices.insert(doubles.vertices.end(), {t.a, t.b, t.c});
    doubles.faces.push_back({n, n + 1, n + 2});
  }
  const auto first = first_at_position(doubles.vertices);
  auto welded = doubles.faces;
  for (auto& f : welded)
    for (std::uint32_t& v : f) v = first[v];
  EXPECT_EQ(accel::solid::touched_faces(doubles, welded), touched);
  return expected.size();
}

TEST(NearFaces, LoseNoCrossingAroundCorners) {
  Pcg32 random(1);
  std::size_t crossings = 0;
  for (const std::uint32_t few : {1u, 2u, 5u})
    for (int i = 0; i < 4; ++i) {
      SCOPED_TRACE(std::to_string(few) + " corners, mesh " + std::to_string(i));
      crossings += expect_all_found(around_few(random, few, 200, [&] { return random_vec<float>(random); }));
      // On a coarse grid directions and planes coincide, and faces do; in a plane, too.
      const std::uint32_t side = 4 + static_cast<std::uint32_t>(i);
      const float flat = i % 2 == 0 ? 0.f : 1.f;
      crossings += expect_all_found(around_few(random, few, 200, [&] {
        return Vec3f{float(random.below(side)), float(random.below(side)), flat * float(random.below(side))};
      }));
    }
  EXPECT_GT(crossings, 10'000u);
}

TEST(NearFaces, LoseNoCrossingOfScrewsAndNarrowCones) {
  // Around an axis, more than once: the faces of each turn cross, or lie in, those of the others.
  for (const double turns : {1.0, 1.5, 2.0, 3.0})
    for (const double rise : {0.0, 1e-6, 0.1}) {
      Mesh3f screw{{{0, 0, 0}}, {}};
      constexpr std::uint32_t n = 127;
      for (std::uint32_t i = 0; i <= n; ++i) {
        const double a = 2 * std::numbers::pi * turns * i / n;
        screw.vertices.push_back(
            Vec3f(Vec3d{std::cos(a), std::sin(a), std::sin(3 * a) * rise + rise * i / n}));
        if (i > 0) screw.faces.push_back({0, i, i + 1});
      }
      const std::size_t found = expect_all_found(screw);
      if (rise == 0 && turns > 1) {
        EXPECT_GT(found, n / 2) << turns;
      }
    }
  for (const float scale : {0x1p-140f, 1.f, 0x1p100f})
    for (const float height : {1e-6f, 1.f, 1e6f}) {
      Mesh3f one = cone(64, height), other = cone(48, height);
      for (auto& p : other.vertices) p[0] *= 1.25f;
      for (const auto& f : other.faces)  // the same apex and middle
        one.faces.push_back(
            {f[0] < 2 ? f[0] : f[0] + 64, f[1] < 2 ? f[1] : f[1] + 64, f[2] < 2 ? f[2] : f[2] + 64});
      one.vertices.insert(one.vertices.end(), other.vertices.begin() + 2, other.vertices.end());
      for (auto& p : one.vertices) p = p * scale;
      EXPECT_GT(expect_all_found(one), 100u);
    }
}

// Arcs of nearly half a circle, and on both sides of it.
TEST(NearFaces, LoseNoCrossingOfFacesThatSeeACornerFromBothSides) {
  Pcg32 random(3);
  Mesh3f m{{{0, 0, 0}}, {}};
  for (std::uint32_t i = 0; i < 150; ++i) {
    const Vec3f p = random_vec<float>(random);
    const Vec3f aside = random_vec<float>(random) * std::ldexp(1.f, -static_cast<int>(random.below(24)));
    m.vertices.push_back(p), m.vertices.push_back(aside - p);
    m.faces.push_back({0, 2 * i + 1, 2 * i + 2});
  }
  EXPECT_GT(expect_all_found(m), 1000u);
}

// Work goes with the number of faces, not with its square, wherever they meet.
TEST(NearFaces, LookAtFewPairsAroundCorners) {
  const auto work = [](const Mesh3f& mesh) {
    const auto found = accel::self_intersections(mesh, with_area(mesh), {.kept = 0, .threads = 1});
    EXPECT_EQ(found.count, 0u);
    return found;
  };
  /// The base around one corner of the rim.
  const auto of_rim = [](std::uint32_t n) {
    Mesh3f m = cone(n, 0.5f);
    for (auto& f : m.faces)
      if (f[0] == 1) f[0] = 2;
    std::erase_if(m.faces, [](const auto& f) { return f[0] == 2 && (f[1] == 2 || f[2] == 2); });
    return m;
  };
  /// Spokes of random lengths: large boxes hold many small ones.
  const auto star = [](std::uint32_t n) {
    Mesh3f m = cone(n, 1);
    Pcg32 random(4);
    for (std::uint32_t i = 2; i < m.vertices.size(); ++i) {
      const float factor = random.uniform(0.01f, 1.f);
      m.vertices[i] = m.vertices[i] * factor + Vec3f{0, 0, 1 - factor};  // towards the apex
      m.vertices[i][2] = std::max(m.vertices[i][2], 1e-3f);
    }
    std::erase_if(m.faces, [](const auto& f) { return f[0] == 1; });
    return m;
  };
  /// Of a soup of many small cones: as many corners of many.
  const auto field = [](std::uint32_t n) {
    Mesh3f m;
    const Mesh3f one = cone(64, 1);
    for (std::uint32_t i = 0; 64 * i < n; ++i) {
      const auto first = static_cast<std::uint32_t>(m.vertices.size());
      for (const Vec3f& p : one.vertices)
        m.vertices.push_back(p + Vec3f{float(i % 16) * 3, float(i / 16) * 3, 0});
      for (const auto& f : one.faces) m.faces.push_back({f[0] + first, f[1] + first, f[2] + first});
    }
    return m;
  };
  int number = 0;
  for (const auto& made : std::vector<std::function<Mesh3f(std::uint32_t)>>{
           [](std::uint32_t n) { return cone(n, 1); }, [](std::uint32_t n) { return cone(n, 30); },
           [](std::uint32_t n) { return soup_of(cone(n, 0.01f)); }, of_rim, star, field}) {
    SCOPED_TRACE(number++);
    const auto few = work(made(1024)), many = work(made(4096));
    const double faces = static_cast<double>(made(4096).size());
    EXPECT_LT(many.examined, 20 * faces);
    EXPECT_LT(many.boxes, 150 * faces);
    EXPECT_LT(static_cast<double>(many.boxes), 6.0 * static_cast<double>(few.boxes));
  }
}

}  // namespace
}  // namespace treeline::test
