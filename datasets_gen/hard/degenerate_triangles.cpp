// Triangles without area or nearly so, among good ones. A triangle of zero area has no inside and is never
// hit; it must neither hide what lies behind it nor spoil a split, a box or a cost.
#include "datasets_gen/hard/family.hpp"

namespace treeline::datasets::hard {

std::vector<HardCase> degenerate_triangles() {
  std::vector<HardCase> all;
  const auto add = [&](std::string name, std::string source, std::string law) -> HardCase& {
    HardCase c;
    c.family = "degenerate_triangles", c.name = std::move(name), c.source = std::move(source),
    c.law = std::move(law);
    return all.emplace_back(std::move(c));
  };
  const std::string unchanged = "hits are those of the sphere without the triangles of zero area";
  const auto rays = [] { return rays_from_around(31, 1000, 3); };

  {
    HardCase& c = add("points_as_triangles",
                      "derivation: three equal corners, the cross product is exactly zero", unchanged);
    c.mesh = snapped_sphere(8);
    for (const Vec3f& p : random_points(32, 1000, {-1.5, -1.5, -1.5}, {1.5, 1.5, 1.5}))
      add_triangle(c.mesh, p, p, p);
    c.rays = rays();
  }
  {
    HardCase& c = add("segments_as_triangles",
                      "measured: 4e4 needles of zero area make every BVH tried 100 times slower", unchanged);
    c.mesh = snapped_sphere(8);
    for (std::size_t i = 0; i < 1000; ++i) {
      // Multiples of 2^-6, and the third corner in the middle: collinear without rounding.
      Draws draws(33, i);
      const auto corner = [&] {
        const Vec3d p = draws.in_box({-96, -96, -96}, {96, 96, 96});
        return Vec3f{std::floor(float(p[0])) / 64, std::floor(float(p[1])) / 64,
                     std::floor(float(p[2])) / 64};
      };
      const Vec3f a = corner(), b = corner();
      add_triangle(c.mesh, a, b, (a + b) * 0.5f);
    }
    c.rays = rays();
  }
  {
    HardCase& c =
        add("repeated_corner_index",
            "derivation: welding close vertices leaves faces that name one vertex twice", unchanged);
    c.mesh = snapped_sphere(8);
    const std::size_t good = c.mesh.faces.size();
    for (std::size_t i = 0; i < good; i += 3) {
      const auto f = c.mesh.faces[i];
      c.mesh.faces.push_back({f[0], f[0], f[1]});
    }
    c.rays = rays();
  }
  {
    HardCase& c =
        add("needle_fan_wall", "Embree #387: long thin triangles; here a wall in strips 1/2048 wide",
            "a ray at the wall hits it, at the distance of its plane");
    for (std::uint32_t i = 0; i <= 2048; ++i) {
      const float y = static_cast<float>(i) / 2048;
      c.mesh.vertices.push_back({0, y, 0});
      c.mesh.vertices.push_back({0, y, 1});
      if (i == 0) continue;
      const std::uint32_t v = 2 * i;
      c.mesh.faces.push_back({v - 2, v, v - 1});
      c.mesh.faces.push_back({v, v + 1, v - 1});
    }
    for (std::size_t i = 0; i < 1000; ++i) {
      Draws draws(34, i);
      const Vec3f from = rounded(draws.in_box({1, -1, -1}, {2, 2, 2}));
      c.rays.push_back(ray_to(from, rounded(draws.in_box({0, 0.01, 0.01}, {0, 0.99, 0.99}))));
    }
  }
  {
    HardCase& c =
        add("caps", "Botsch and Kobbelt 2001: caps, triangles with one angle near 180°",
            "a ray square to a cap hits it on one side of its long edge and its neighbour on the other");
    // Pairs over one long edge: a cap of height 2^-8 and a good triangle, together without a gap.
    for (int i = 0; i < 200; ++i) {
      const float z = static_cast<float>(i) / 4;
      add_triangle(c.mesh, {-1, 0, z}, {1, 0, z}, {0, 1.f / 256, z});
      add_triangle(c.mesh, {1, 0, z}, {-1, 0, z}, {0, -1, z});
      for (const float y : {1.f / 1024, -1.f / 1024, 0.f, 1.f / 512})
        c.rays.push_back({.origin = {1.f / 64, y, z - 0.125f}, .direction = {0, 0, 1}});
    }
  }
  {
    HardCase& c = add("coincident_triangles",
                      "measured: tinybvh crashes on 2e5 copies of one triangle, others turn linear",
                      "the hit's distance is that of one triangle; which copy is returned is free");
    for (int copy = 0; copy < 2000; ++copy) add_triangle(c.mesh, {-1, -1, 0}, {1, -1, 0}, {0, 1, 0});
    c.rays = rays_from_around(35, 200, 3);
  }
  {
    HardCase& c =
        add("coincident_2e5", "measured: tinybvh crashes on 2e5 copies of one triangle, others turn linear",
            "the hit's distance is that of one triangle; which copy is returned is free");
    for (int copy = 0; copy < 200'000; ++copy) add_triangle(c.mesh, {-1, -1, 0}, {1, -1, 0}, {0, 1, 0});
    c.rays = rays_from_around(37, 10, 3);
  }
  {
    HardCase& c = add("needles_4e4",
                      "measured: 4e4 needles of zero area make every BVH tried 100 times slower", unchanged);
    c.mesh = snapped_sphere(8);
    for (std::size_t i = 0; i < 40'000; ++i) {
      // Across the whole scene, so that the box of each is as large: two corners equal, no area.
      Draws draws(38, i);
      const Vec3f a = rounded(draws.in_box({-1.5, -1.5, -1.5}, {1.5, 1.5, 1.5}));
      const Vec3f b = rounded(draws.in_box({-1.5, -1.5, -1.5}, {1.5, 1.5, 1.5}));
      add_triangle(c.mesh, a, b, b);
    }
    c.rays = rays_from_around(39, 200, 3);
  }
  {
    HardCase& c =
        add("nested_coplanar", "measured: tinybvh crashes on nested coplanar triangles of one centroid",
            "hits are at the one plane, where the largest triangle is hit");
    for (int i = 1; i <= 500; ++i) {
      const float s = static_cast<float>(i) / 256;
      add_triangle(c.mesh, {-s, -s, 0}, {s, -s, 0}, {0, 2 * s, 0});
    }
    c.rays = rays_from_around(36, 500, 3);
  }
  return all;
}

}  // namespace treeline::datasets::hard
