// Rays that come in almost in the plane of a skinny triangle, from far away. The determinant that t is
// divided by cancels there: t leaves the triangle, and rays beside it hit while rays across it miss.
#include "datasets_gen/hard/family.hpp"

namespace treeline::datasets::hard {
namespace {

constexpr std::size_t triangles = 2000, rays = 4000;
constexpr double spacing = 4;  // of the triangles, each about a unit long

}  // namespace

std::vector<HardCase> grazing_rays() {
  HardCase c;
  c.family = "grazing_rays", c.name = "skinny_triangles_edge_on";
  c.source = "Embree #387; measured, of 1e6: Embree fast 10,672 false hits, ROBUST 16,572, tinybvh 13,317";
  c.law =
      "a ray hits a triangle if exact arithmetic says so, at a t within the triangle's own stretch of the "
      "ray";
  for (std::size_t i = 0; i < triangles; ++i) {
    Draws draws(121, i);
    // On a grid of 13 a side, so that most rays meet the one triangle that they are aimed at.
    const Vec3d place = scaled({double(i % 13), double(i / 13 % 13), double(i / 169)}, spacing);
    const Vec3d along = draws.direction(), aside = unit_portable(cross_portable(along, draws.direction()));
    const double width = (i % 2 == 0 ? 1e-3 : 1e-2) * draws.uniform(1, 10);
    add_triangle(c.mesh, rounded(place), rounded(sum(place, along)),
                 rounded(sum(place, sum(scaled(along, draws.uniform()), scaled(aside, width)))));
  }
  for (std::size_t i = 0; i < rays; ++i) {
    Draws draws(122, i);
    const auto t = c.mesh.triangle(i / 2);
    double u = draws.uniform(), v = draws.uniform();
    if (u + v > 1) u = 1 - u, v = 1 - v;
    const Vec3d a(t.a), ab = Vec3d(t.b) - a, ac = Vec3d(t.c) - a;
    const Vec3d point = sum(a, sum(scaled(ab, u), scaled(ac, v)));
    const Vec3d normal = unit_portable(cross_portable(ab, ac)), x = unit_portable(ab);
    const Vec3d y = cross_portable(normal, x);
    const SinCos turn = sincos_turns(draws.uniform());
    constexpr double decades[] = {1e-5, 1e-4, 1e-3, 1e-2};
    const double angle = decades[i % 4] * draws.uniform(1, 10);  // the ray's slope, in effect
    const Vec3d way = sum(sum(scaled(x, turn.cos), scaled(y, turn.sin)), scaled(normal, angle));
    const Vec3f from = rounded(sum(point, scaled(way, 50 + 500 * draws.uniform())));
    c.rays.push_back({.origin = from, .direction = rounded(unit_portable(point - Vec3d(from)))});
  }
  return {std::move(c)};
}

}  // namespace treeline::datasets::hard
