// Rays at a cube of twelve triangles, from outside: what a slab test of its box says must be what its surface
// says. The textbook's test misses where the ray enters no later than it leaves, which a ray that only
// touches does not.
#include "datasets_gen/hard/family.hpp"

namespace treeline::datasets::hard {

std::vector<HardCase> box_rays() {
  std::vector<HardCase> all;
  const auto add = [&](std::string name, std::string source) -> HardCase& {
    HardCase c;
    c.family = "box_rays", c.name = std::move(name), c.source = std::move(source);
    c.law = "a ray from outside meets the box exactly if it meets its surface; boxes are closed sets";
    c.mesh = cube(1);
    return all.emplace_back(std::move(c));
  };
  const auto along = [](int axis, float sign, float other) {
    Vec3f d = Vec3f::filled(other);
    d[axis] = sign;
    return d;
  };
  add("box_at_random", "Kay and Kajiya 1986: the slab test").rays = rays_from_around(141, 4000, 5);
  {
    HardCase& c =
        add("box_zero_components", "madmann91/bvh #9, #20, #60; tinybvh #282: zeros of either sign");
    for (std::size_t i = 0; i < 500; ++i) {
      Draws draws(142, i);
      const Vec3f at = rounded(draws.in_box({-1.5, -1.5, -1.5}, {1.5, 1.5, 1.5}));
      for (int axis = 0; axis < 3; ++axis)
        for (const float zero : {0.f, -0.f}) {
          Vec3f from = at;
          from[axis] = i % 2 == 0 ? -3.f : 3.f;
          c.rays.push_back({.origin = from, .direction = along(axis, i % 2 == 0 ? 1.f : -1.f, zero)});
        }
    }
  }
  {
    HardCase& c =
        add("box_in_face_planes", "Ize 2013: 0·∞ is not a number where the ray lies in a slab's plane");
    for (std::size_t i = 0; i < 100; ++i) {
      const float at = static_cast<float>(Draws(143, i).uniform(-0.99, 0.99));
      for (int axis = 0; axis < 3; ++axis)
        for (const float level : {1.f, -1.f})
          for (const float zero : {0.f, -0.f}) {
            Vec3f from;
            from[axis] = -3, from[(axis + 1) % 3] = level, from[(axis + 2) % 3] = at;
            c.rays.push_back({.origin = from, .direction = along(axis, 1, zero)});
          }
    }
  }
  {
    // Multiples of 2^-6: the ray passes through the edge without rounding, and beside the rest of the box.
    HardCase& c = add("box_touched_at_an_edge", "derivation: there the ray enters and leaves at one t");
    for (std::size_t i = 0; i < 200; ++i) {
      Draws draws(144, i);
      const float along_edge = static_cast<float>(std::floor(draws.uniform(-60, 60))) / 64;
      const float far = static_cast<float>(1 + std::floor(draws.uniform() * 128)) / 64;
      for (int axis = 0; axis < 3; ++axis)
        for (const float x : {1.f, -1.f})
          for (const float y : {1.f, -1.f}) {
            Vec3f edge, d;
            edge[axis] = along_edge, edge[(axis + 1) % 3] = x, edge[(axis + 2) % 3] = y;
            d[(axis + 1) % 3] = x, d[(axis + 2) % 3] = -y;
            c.rays.push_back({.origin = edge - d * far, .direction = d});
          }
    }
  }
  {
    HardCase& c =
        add("box_near_edges", "derivation: aimed at edges as exactly as float can: by an ulp in or out");
    for (std::size_t i = 0; i < 4000; ++i) {
      Draws draws(145, i);
      const Vec3f from = rounded(scaled(draws.direction(), 5));
      Vec3f edge;
      const int axis = static_cast<int>(i % 3);
      edge[axis] = static_cast<float>(draws.uniform(-1, 1));
      edge[(axis + 1) % 3] = i % 2 == 0 ? 1.f : -1.f, edge[(axis + 2) % 3] = i % 4 < 2 ? 1.f : -1.f;
      c.rays.push_back(ray_to(from, edge));
    }
  }
  return all;
}

}  // namespace treeline::datasets::hard
