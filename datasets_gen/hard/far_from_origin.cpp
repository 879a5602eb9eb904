// Geometry far from the origin, where floats are coarse: 6e-5 apart at 1e3, 8e-3 at 1e5. The input is what
// the floats say; answers must be right for them, though differences of large numbers lose digits.
#include "datasets_gen/hard/family.hpp"

namespace treeline::datasets::hard {
namespace {

geometry::Mesh3f shifted(geometry::Mesh3f mesh, const Vec3f& by) {
  for (Vec3f& p : mesh.vertices) p = p + by;
  return mesh;
}

}  // namespace

std::vector<HardCase> far_from_origin() {
  std::vector<HardCase> all;
  const auto add = [&](std::string name, std::string source, std::string law) -> HardCase& {
    HardCase c;
    c.family = "far_from_origin", c.name = std::move(name), c.source = std::move(source),
    c.law = std::move(law);
    return all.emplace_back(std::move(c));
  };
  const std::string neighbours = "the k distances equal those of brute force over the same floats";
  struct Place {
    const char* name;
    float x;
  };
  for (const Place at : {Place{"1e3", 1e3f}, Place{"1e5", 1e5f}, Place{"1e7", 1e7f}}) {
    HardCase& c = add(std::string("cloud_at_") + at.name,
                      "faiss #297 and #3245: |a|² - 2ab + |b|² cancels far from the origin", neighbours);
    const Vec3d low{at.x, -at.x, at.x}, high{at.x + 100.0, -at.x + 100.0, at.x + 100.0};
    c.cloud.points = random_points(41, 4000, low, high);
    c.queries = random_points(42, 200, low, high);
    for (const Vec3f& q : every(c.cloud.points, 20)) c.queries.push_back(q);
    c.radius = 8;
  }
  {
    HardCase& c = add("survey_grid_at_1e6",
                      "derivation: a georeferenced scan, its 1/16 m grid a million metres out, where floats "
                      "are that coarse",
                      neighbours);
    for (int j = 0; j < 60; ++j)
      for (int i = 0; i < 60; ++i) c.cloud.points.push_back({1e6f + i / 16.f, 2e6f + j / 8.f, 100.f});
    c.queries = every(c.cloud.points, 11);
    c.k = 4;
  }
  for (const Place at : {Place{"1e3", 1e3f}, Place{"1e5", 1e5f}}) {
    const Vec3f centre{at.x, at.x, -at.x};
    {
      HardCase& c =
          add(std::string("closed_sphere_at_") + at.name,
              "measured: Embree's fast mode loses 39,196 of 1e6 such rays at 1e5, others up to 58,497",
              "no ray from inside a closed mesh escapes");
      c.mesh = shifted(snapped_sphere(16), centre);
      c.from_inside = true;
      c.judged = 1000;
      for (std::size_t i = 0; i < 10'000; ++i) {
        Draws draws(43, i);
        const Vec3d shift = scaled(draws.direction(), 0.3 * draws.uniform());
        c.rays.push_back({.origin = centre + rounded(shift), .direction = rounded(draws.direction())});
      }
    }
    HardCase& c = add(std::string("ray_origin_at_") + at.name,
                      "measured: at 1e5 radii Embree fast loses 6,297 of 1e6 rays, tinybvh 37,557",
                      "a ray aimed into a closed mesh hits it; hits are those in exact arithmetic");
    c.mesh = snapped_sphere(16);
    for (std::size_t i = 0; i < 1000; ++i) {
      Draws draws(44, i);
      const Vec3f from = rounded(scaled(draws.direction(), at.x));
      // The direction's rounding moves the ray by up to 1e-7 of the way: 0.01 at 1e5, well inside the sphere.
      c.rays.push_back(ray_to(from, rounded(draws.in_box({-0.3, -0.3, -0.3}, {0.3, 0.3, 0.3}))));
    }
  }
  {
    // Multiples of 2^-12 around 1024, where floats are 2^-13 apart: origin and target are still exact, and so
    // is their difference.
    const Vec3f centre{1024, 1024, -1024};
    HardCase& c = add("edge_points_at_1e3",
                      "measured: Embree's fast mode loses 1,393 of 1e6 such rays, ROBUST 31, tinybvh 2,561",
                      "no ray from inside a closed mesh escapes");
    const geometry::Mesh3f sphere = snapped_sphere(30);
    c.mesh = shifted(sphere, centre);
    c.from_inside = true;
    c.judged = 1000;
    for (std::size_t i = 0; i < 10'000; ++i) {
      const auto& f = c.mesh.faces[i * 7 % c.mesh.faces.size()];
      Draws draws(45, i);
      const Vec3f from = centre + rounded(draws.in_box({-0.25, -0.25, -0.25}, {0.25, 0.25, 0.25}));
      const float s = static_cast<float>(draws.uniform());
      const Vec3f target = c.mesh.vertices[f[i % 3]] * (1 - s) + c.mesh.vertices[f[(i + 1) % 3]] * s;
      c.rays.push_back(ray_to(from, target));
    }
  }
  return all;
}

}  // namespace treeline::datasets::hard
