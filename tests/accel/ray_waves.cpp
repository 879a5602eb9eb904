// Rays in waves answer bit by bit what the wide tree answers.
#include "accel/bvh/ray_waves.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "geometry/random.hpp"
#include "geometry/sampling.hpp"

namespace treeline::accel {
namespace {

using geometry::Mesh3f, geometry::Pcg32, geometry::Rayf, geometry::Vec3f;

Mesh3f soup(std::size_t n, float size, std::uint64_t seed) {
  Pcg32 random(seed);
  const auto point = [&](float s) {
    return Vec3f{s * random.uniform(-1.0f, 1.0f), s * random.uniform(-1.0f, 1.0f),
                 s * random.uniform(-1.0f, 1.0f)};
  };
  Mesh3f mesh;
  for (std::uint32_t i = 0; i < n; ++i) {
    const Vec3f at = point(1);
    for (int k = 0; k < 3; ++k) mesh.vertices.push_back(at + point(size));
    mesh.faces.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  return mesh;
}
/// A closed box of n × n squares a side, split in two, moved from the origin.
Mesh3f box(std::uint32_t n, float away) {
  Mesh3f mesh;
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side)
      for (std::uint32_t i = 0; i < n; ++i)
        for (std::uint32_t j = 0; j < n; ++j) {
          const auto base = static_cast<std::uint32_t>(mesh.vertices.size());
          for (const auto& [a, b] : {std::pair{0u, 0u}, {1u, 0u}, {1u, 1u}, {0u, 1u}}) {
            Vec3f p = Vec3f::filled(away);
            p[axis] += side ? 1.0f : -1.0f;
            p[(axis + 1) % 3] += 2 * static_cast<float>(i + a) / static_cast<float>(n) - 1;
            p[(axis + 2) % 3] += 2 * static_cast<float>(j + b) / static_cast<float>(n) - 1;
            mesh.vertices.push_back(p);
          }
          mesh.faces.push_back({base, base + 1, base + 2}), mesh.faces.push_back({base, base + 2, base + 3});
        }
  return mesh;
}

/// From about the mesh in all directions; some along axes, at corners and edges, in short ranges, of other
/// lengths, and with ranges that do not begin at 0.
std::vector<Rayf> rays_about(const Mesh3f& mesh, std::size_t n, std::uint64_t seed) {
  Pcg32 random(seed);
  const Vec3f centre = mesh.box().centre();
  std::vector<Rayf> rays;
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3f origin =
        centre + Vec3f{random.uniform(-1.5f, 1.5f), random.uniform(-1.5f, 1.5f), random.uniform(-1.5f, 1.5f)};
    Vec3f way = geometry::sample_sphere(random.uniform<float>(), random.uniform<float>());
    const Vec3f corner = mesh.vertices[random.below(static_cast<std::uint32_t>(mesh.vertices.size()))];
    switch (random.below(10)) {
      case 0:
        way[static_cast<int>(random.below(3))] = 0;
        break;
      case 1:
        way = {}, way[static_cast<int>(random.below(3))] = -1;
        break;
      case 2:
        way = corner - origin;
        break;
      case 3: {
        const auto f = mesh.faces[random.below(static_cast<std::uint32_t>(mesh.size()))];
        way = (mesh.vertices[f[0]] + mesh.vertices[f[1]]) * 0.5f - origin;
        break;
      }
      case 4:
        way = way * 1e9f;
        break;
      case 5:
        way[1] = way[0];
        break;
      default:
        break;
    }
    if (way == Vec3f{}) way = {1, 0, 0};
    Rayf ray{origin, way};
    if (random.below(4) == 0) ray.t_max = random.uniform(0.0f, 2.0f);
    if (random.below(16) == 0) ray.t_min = random.uniform(-1.0f, 1.0f);
    rays.push_back(ray);
  }
  return rays;
}

void expect_same(const Mesh3f& mesh, const std::vector<Rayf>& rays, const char* what) {
  const RayWaves waves(mesh);
  const RayWaves::Tree tree(mesh);
  std::vector<Hit<float>> hits(rays.size()), truth(rays.size());
  std::vector<std::uint8_t> any(rays.size()), any_truth(rays.size());
  tree.closest_hit(rays, truth, 1, RayBatch::singly), tree.any_hit(rays, any_truth, 1, RayBatch::singly);
  for (const int threads : {1, 3}) {
    waves.closest_hit(rays, hits, threads), waves.any_hit(rays, any, threads);
    std::size_t hit = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      ASSERT_EQ(hits[i], truth[i]) << what << ", ray " << i;
      ASSERT_EQ(any[i], any_truth[i]) << what << ", ray " << i;
      hit += any[i];
    }
    waves.closest_face(rays, hits, threads);
    for (std::size_t i = 0; i < rays.size(); ++i)
      ASSERT_EQ(hits[i], (Hit<float>{truth[i].t, truth[i].primitive})) << what << ", ray " << i;
    EXPECT_GT(hit, 0u) << what;
  }
}

TEST(RayWaves, AnswerAsTheWideTree) {
  for (const std::size_t n : {1, 2, 17, 300, 501})
    for (const float size : {0.02f, 0.5f}) {
      const Mesh3f mesh = soup(n, size, n);
      expect_same(mesh, rays_about(mesh, 5000, n + 1), "soup");
    }
}

TEST(RayWaves, AnswerAsTheWideTreeInBoxes) {
  for (const std::uint32_t n : {1u, 3u, 6u})
    for (const float away : {0.0f, 3.0f, 1000.0f}) {
      const Mesh3f mesh = box(n, away);
      expect_same(mesh, rays_about(mesh, 5000, n), "box");
    }
}

// Equal distances: the lowest id.
TEST(RayWaves, AnswerAsTheWideTreeAmongCopies) {
  Mesh3f mesh = box(2, 0);
  const std::vector<Mesh3f::Face> faces = mesh.faces;
  for (int copies = 0; copies < 3; ++copies)
    mesh.faces.insert(mesh.faces.begin(), faces.rbegin(), faces.rend());
  expect_same(mesh, rays_about(mesh, 5000, 9), "copies");
}

TEST(RayWaves, AnswerAsTheWideTreeAtOddScales) {
  for (const float scale : {1e-30f, 1e-12f, 1e12f, 1e30f}) {
    Mesh3f mesh = soup(100, 0.5f, 4);
    std::vector<Rayf> rays = rays_about(mesh, 2000, 5);
    for (Vec3f& p : mesh.vertices) p = p * scale;
    for (Rayf& r : rays) r.origin = r.origin * scale, r.direction = r.direction * std::min(scale, 1e20f);
    expect_same(mesh, rays, "scaled");
  }
}

TEST(RayWaves, BatchesOfAllSizes) {
  const Mesh3f mesh = box(2, 0);
  const std::vector<Rayf> rays = rays_about(mesh, 200, 6);
  const RayWaves waves(mesh);
  for (std::size_t n = 0; n <= rays.size(); ++n) {
    std::vector<Hit<float>> hits(n);
    waves.closest_hit(std::span(rays).first(n), hits, 1);
    for (std::size_t i = 0; i < n; ++i) ASSERT_EQ(hits[i], waves.closest_hit(rays[i])) << n << ", " << i;
  }
}

TEST(RayWaves, RefusesWhatIsNoRay) {
  const Mesh3f mesh = box(1, 0);
  const RayWaves waves(mesh), none((Mesh3f()));
  std::vector<Rayf> rays(100, Rayf{{0, 0, 0}, {1, 2, 3}});
  std::vector<Hit<float>> hits(100);
  std::vector<std::uint8_t> any(100);
  none.closest_hit(rays, hits, 1);
  EXPECT_FALSE(hits[5]);
  EXPECT_THROW(waves.closest_hit(rays, std::span(hits).first(99), 1), InvalidInput);
  EXPECT_THROW(waves.closest_hit(rays, hits, 0), InvalidInput);
  rays[70].direction[1] = NAN;
  EXPECT_THROW(waves.closest_hit(rays, hits, 1), InvalidInput);
  EXPECT_THROW(waves.any_hit(rays, any, 1), InvalidInput);
}

}  // namespace
}  // namespace treeline::accel
