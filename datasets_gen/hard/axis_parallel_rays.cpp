// Rays with zero, negative zero or denormal direction components, and rays that run within a plane of a box.
// The slab test multiplies 0 by infinity there.
#include "datasets_gen/hard/family.hpp"

namespace treeline::datasets::hard {

std::vector<HardCase> axis_parallel_rays() {
  std::vector<HardCase> all;
  const auto add = [&](std::string name, std::string source, std::string law) -> HardCase& {
    HardCase c;
    c.family = "axis_parallel_rays", c.name = std::move(name), c.source = std::move(source),
    c.law = std::move(law);
    return all.emplace_back(std::move(c));
  };
  const std::string escapes = "no ray from inside a closed mesh escapes";
  const auto along = [](int axis, float sign, float other) {
    Vec3f d = Vec3f::filled(other);
    d[axis] = sign;
    return d;
  };
  struct Component {
    const char* name;
    float value;
    const char* source;
  };
  for (const Component o :
       {Component{"zero", 0.f, "madmann91/bvh #9, #20, #60: zero direction components"},
        Component{"negative_zero", -0.f, "tinybvh #282: -0.0 turns the sign of the reciprocal"},
        Component{"tiny_1e-38", 1e-38f,
                  "measured: (1e-38, 0, -1) loses 104,216 of 1e6 rays in tinybvh, 999,996 in bvh"},
        Component{"denormal", 1e-42f,
                  "derivation: the reciprocal of a denormal is infinite, or zero under flush to zero"}}) {
    HardCase& c = add(std::string("from_inside_") + o.name, o.source, escapes);
    c.mesh = cube(8);
    c.from_inside = true;
    for (std::size_t i = 0; i < 200; ++i) {
      // Half of the origins on planes of the grid, where rays run along edges of the far side.
      Draws draws(61, i);
      Vec3f from = rounded(draws.in_box({-0.74, -0.74, -0.74}, {0.9, 0.9, 0.9}));
      if (i % 2 == 0)
        for (int k = 0; k < 3; ++k) from[k] = std::floor(from[k] * 4) / 4;
      for (int axis = 0; axis < 3; ++axis)
        for (const float sign : {1.f, -1.f})
          c.rays.push_back({.origin = from, .direction = along(axis, sign, o.value)});
    }
  }
  {
    HardCase& c =
        add("in_bounding_plane",
            "Ize 2013; measured: Embree, ROBUST too, loses 500,488 of 1e6 axis rays in a bounding plane",
            "a ray square to a wall, level with its rim, hits the rim: triangles are closed sets");
    c.mesh = wall(16);
    for (int i = 0; i <= 16; ++i)
      for (const float rim : {0.f, 1.f})
        for (const float zero : {0.f, -0.f})
          for (const float sign : {1.f, -1.f}) {
            const float s = static_cast<float>(i) / 16;
            c.rays.push_back({.origin = {-2 * sign, rim, s}, .direction = {sign, zero, zero}});
            c.rays.push_back({.origin = {-2 * sign, s, rim}, .direction = {sign, zero, zero}});
            c.rays.push_back({.origin = {-2 * sign, s + 1.f / 64, rim}, .direction = {sign, zero, -zero}});
          }
    std::erase_if(c.rays, [](const geometry::Rayf& r) { return r.origin[1] > 1; });
  }
  {
    HardCase& c =
        add("in_face_plane", "Ize 2013: NaN slabs, here with the ray in the plane of a cube's side",
            "the ray hits the near side of the cube where it enters the plane's square, or grazes past it");
    c.mesh = cube(4);
    for (int axis = 0; axis < 3; ++axis)
      for (int i = -8; i <= 8; ++i)
        for (const float level : {1.f, -1.f})
          for (const float zero : {0.f, -0.f}) {
            Vec3f from, d = Vec3f::filled(zero);
            from[axis] = -3, d[axis] = 1;
            from[(axis + 1) % 3] = level;
            from[(axis + 2) % 3] = static_cast<float>(i) / 7;  // the last ones pass beside the cube
            c.rays.push_back({.origin = from, .direction = d});
          }
  }
  {
    HardCase& c = add("origin_on_box_plane", "Ize 2013: (plane - origin)·(1/0) is 0·infinity = NaN", escapes);
    c.mesh = snapped_sphere(16);
    c.from_inside = true;
    for (std::size_t i = 0; i < 600; ++i) {
      // An origin that shares a coordinate with a vertex lies on the plane of some node's box.
      const Vec3f v = c.mesh.vertices[i * 3 % c.mesh.vertices.size()];
      Vec3f from{0, 0, 0};
      const int axis = static_cast<int>(i % 3);
      if (std::abs(v[axis]) > 0.5f) continue;
      from[axis] = v[axis];
      for (const float sign : {1.f, -1.f})
        c.rays.push_back({.origin = from, .direction = along((axis + 1) % 3, sign, i % 2 == 0 ? 0.f : -0.f)});
    }
  }
  return all;
}

}  // namespace treeline::datasets::hard
