// Rays from inside a closed mesh aimed exactly at its vertices and edges. Each must hit one of the triangles
// there; tests that compute a shared edge differently for its two triangles let it through.
//
// Exactly: all coordinates are multiples of 2^-12 below 2, so that target - origin is a float without
// rounding and the ray passes through the target at t = 1.
#include "datasets_gen/hard/family.hpp"

namespace treeline::datasets::hard {
namespace {

constexpr std::size_t many = 5'000;   // rays where leaks are counted: one is two hundred in a million
constexpr std::size_t judged = 1000;  // of those

/// Points well inside the rough sphere (its radius is above 0.8), on the same grid.
Vec3f inside_point(std::uint64_t i) {
  const Vec3d p = scaled(Draws(51, i).in_box({-0.25, -0.25, -0.25}, {0.25, 0.25, 0.25}), 1 / snap);
  return rounded(scaled({std::floor(p[0]), std::floor(p[1]), std::floor(p[2])}, snap));
}

}  // namespace

std::vector<HardCase> edge_vertex_rays() {
  std::vector<HardCase> all;
  const auto add = [&](std::string name, std::string source) -> HardCase& {
    HardCase c;
    c.family = "edge_vertex_rays", c.name = std::move(name), c.source = std::move(source);
    c.law = "no ray from inside a closed mesh escapes";
    c.from_inside = true;
    return all.emplace_back(std::move(c));
  };
  const std::string woop = "Woop, Benthin and Wald 2013; Embree #174, #181, #387; ";
  const geometry::Mesh3f sphere = snapped_sphere(30);
  {
    HardCase& c = add("at_vertices", woop + "measured: Embree ROBUST loses 16,503 of 1e6, fast 192,774");
    c.mesh = sphere;
    c.judged = judged;
    for (std::size_t i = 0; i < many; ++i)
      c.rays.push_back(ray_to(inside_point(i), sphere.vertices[i * 4 % sphere.vertices.size()]));
  }
  {
    HardCase& c =
        add("at_rounded_vertices",
            woop + "coordinates of all 24 bits, so that the way to a vertex is rounded, as in any scene");
    c.mesh = sphere;
    for (auto& v : c.mesh.vertices) v = v * 0.7331f;
    c.judged = judged;
    for (std::size_t i = 0; i < many; ++i) {
      const Vec3f from = rounded(Draws(53, i).in_box({-0.2, -0.2, -0.2}, {0.2, 0.2, 0.2}));
      c.rays.push_back(ray_to(from, c.mesh.vertices[i * 4 % sphere.vertices.size()]));
    }
  }
  {
    HardCase& c =
        add("at_edge_midpoints", woop + "measured: Embree fast loses 31,793 of 1e6, tinybvh 185,935");
    c.mesh = sphere;
    for (std::size_t i = 0; i < 2000; ++i) {
      const auto& f = sphere.faces[i * 9 % sphere.faces.size()];
      const Vec3f middle = sphere.vertices[f[i % 3]] * 0.5f + sphere.vertices[f[(i + 1) % 3]] * 0.5f;
      c.rays.push_back(ray_to(inside_point(i), middle));
    }
  }
  {
    HardCase& c = add("at_random_edge_points",
                      woop + "the target is rounded, so the ray passes within an ulp of the edge");
    c.mesh = sphere;
    c.judged = judged;
    for (std::size_t i = 0; i < many; ++i) {
      const auto& f = sphere.faces[i * 7 % sphere.faces.size()];
      const float s = static_cast<float>(Draws(52, i).uniform());
      const Vec3f target = sphere.vertices[f[i % 3]] * (1 - s) + sphere.vertices[f[(i + 1) % 3]] * s;
      c.rays.push_back(ray_to(inside_point(i), target));
    }
  }
  {
    HardCase& c =
        add("at_cube_corners", "derivation: origin at the centre, directions with equal components");
    c.mesh = cube(8);
    for (const Vec3f& v : c.mesh.vertices) c.rays.push_back(ray_to({0, 0, 0}, v));
    for (const Vec3f& v : c.mesh.vertices) c.rays.push_back(ray_to({0.5f, -0.25f, 0.125f}, v));
  }
  {
    HardCase& c = add("ends_on_the_surface",
                      "derivation: t_max at the target makes the closed interval end on the surface");
    c.mesh = cube(4);
    c.from_inside = true;
    c.law = "a ray that ends exactly on a face, edge or vertex hits it: intervals are closed";
    for (const Vec3f& v : c.mesh.vertices) {
      geometry::Rayf r = ray_to({0, 0, 0}, v);
      r.t_max = 1;
      c.rays.push_back(r);
    }
  }
  return all;
}

}  // namespace treeline::datasets::hard
