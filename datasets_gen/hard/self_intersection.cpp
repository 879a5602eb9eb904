// Rays that leave a convex surface and must not hit it: bounced and shadow rays start at a point that was
// computed in float, which lies inside as often as outside. An offset along the normal cures that; too large
// a one loses contacts. How small may it be?
#include <bit>

#include "datasets_gen/hard/family.hpp"
#include "datasets_gen/meshes/geodesic.hpp"

namespace treeline::datasets::hard {
namespace {

constexpr std::size_t rays_leaving = 5000;

Vec3f cross(const Vec3f& a, const Vec3f& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Vec3f unit(const Vec3f& v) { return v * (1 / std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2])); }

/// A sphere about (3, 4, 5), as an object in a scene has it: round, so that its faces make a convex body.
geometry::Mesh3f ball(std::size_t f) {
  const Progress none;
  Ticker ticker(none);
  const Job job{Geodesic::faces(f), 1, ticker};
  geometry::Mesh3f mesh;
  mesh.vertices.resize(Geodesic::vertices(f));
  mesh.faces.resize(Geodesic::faces(f));
  Geodesic(f).write(job, mesh, 0, 0, false, 1, [&](const Vec3d& d) { return sum(d, {3, 4, 5}); });
  return mesh;
}

/// Wächter and Binder 2019, "A fast and robust method for avoiding self-intersection" (Ray Tracing Gems, ch.
/// 6): steps in units of the last place, or an absolute one near the origin.
Vec3f waechter_binder(const Vec3f& p, const Vec3f& n) {
  Vec3f out;
  for (int i = 0; i < 3; ++i) {
    const auto steps = static_cast<std::int32_t>(256.0f * n[i]);
    const auto bits = std::bit_cast<std::int32_t>(p[i]);
    const float moved = std::bit_cast<float>(bits + (p[i] < 0 ? -steps : steps));
    out[i] = std::abs(p[i]) < 1.0f / 32 ? p[i] + n[i] / 65536 : moved;
  }
  return out;
}

}  // namespace

std::vector<HardCase> self_intersection() {
  HardCase c;
  c.family = "self_intersection", c.name = "outward_from_a_convex_sphere";
  c.source = "Wächter and Binder 2019; measured: without an offset every second ray hits the surface it left";
  c.law = "answers are those of exact arithmetic; from far enough off the surface no ray hits it";
  c.mesh = ball(12);
  c.judged = 500;
  const auto add = [&](std::string name, const auto& move) {
    RaysOut& out = c.outward.emplace_back();
    out.name = std::move(name);
    for (std::size_t i = 0; i < rays_leaving; ++i) {
      Draws draws(131, i);
      const auto t = c.mesh.triangle(i % c.mesh.size());
      float u = static_cast<float>(draws.uniform()), v = static_cast<float>(draws.uniform());
      if (u + v > 1) u = 1 - u, v = 1 - v;
      const Vec3f p = t.a * (1 - u - v) + t.b * u + t.c * v;  // as a renderer finds it: in float
      const Vec3f n = unit(cross(t.b - t.a, t.c - t.a));
      // Cosine-distributed about the normal: the normal and a point of the unit sphere.
      const Vec3f d = unit(n + rounded(scaled(draws.direction(), 0.999)));
      out.rays.push_back({.origin = move(p, n), .direction = d});
    }
  };
  struct Offset {
    const char* name;
    float relative;
  };
  for (const Offset o :
       {Offset{"offset_0", 0}, Offset{"offset_1e-8", 1e-8f}, Offset{"offset_3e-8", 3e-8f},
        Offset{"offset_1e-7", 1e-7f}, Offset{"offset_3e-7", 3e-7f}, Offset{"offset_1e-6", 1e-6f},
        Offset{"offset_3e-6", 3e-6f}, Offset{"offset_1e-5", 1e-5f}})
    add(o.name, [&](const Vec3f& p, const Vec3f& n) {
      return p + n * (o.relative * std::max({std::abs(p[0]), std::abs(p[1]), std::abs(p[2])}));
    });
  add("waechter_binder", [](const Vec3f& p, const Vec3f& n) { return waechter_binder(p, n); });
  return {std::move(c)};
}

}  // namespace treeline::datasets::hard
