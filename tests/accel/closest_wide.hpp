// Sets of triangles and queries that strain closest points, for tests of the wide tree.
#pragma once

#include "geometry/exact/triangle_distance.hpp"
#include "tests/accel/triangles_common.hpp"

namespace treeline::accel::test {

using V = Vec<float, 3>;
using D = geometry::Vec3d;

struct TriangleCase {
  std::string name;
  std::vector<Triangle<float>> triangles;
};

/// Long triangles whose third corner is beside an end (needles) or the middle (caps) of the side across.
inline std::vector<Triangle<float>> slivers(std::size_t n, bool caps, std::uint64_t seed) {
  Pcg32 random(seed);
  std::vector<Triangle<float>> triangles;
  while (triangles.size() < n) {
    const V a = in_cube(random, 1.0f), b = in_cube(random, 1.0f), aside = in_cube(random, 1.0f);
    float width = 0.1f;
    for (std::uint32_t i = random.below(6); i > 0; --i) width *= 0.1f;
    const V c = a + (b - a) * (caps ? random.uniform<float>(0.2f, 0.8f) : 1.0f) + aside * width;
    // Every corner takes its turn as the one that the test begins at.
    const std::size_t turn = triangles.size() % 3;
    triangles.push_back(turn == 0   ? Triangle<float>{a, b, c}
                        : turn == 1 ? Triangle<float>{b, c, a}
                                    : Triangle<float>{c, a, b});
  }
  return triangles;
}

inline std::vector<Triangle<float>> moved(std::vector<Triangle<float>> triangles, float scale, V by) {
  for (auto& t : triangles) t = {t.a * scale + by, t.b * scale + by, t.c * scale + by};
  return triangles;
}

inline std::vector<TriangleCase> triangle_cases() {
  std::vector<TriangleCase> cases;
  const auto add = [&](const char* name, std::vector<Triangle<float>> triangles) {
    cases.push_back({name, std::move(triangles)});
  };
  const auto small = soup<float>(400, 0.1f, 1);
  add("soup", small);
  add("large triangles", soup<float>(400, 1.0f, 2));
  add("sphere", triangles_of(sphere<float>(3)));
  add("needles", slivers(400, false, 3));
  add("caps", slivers(400, true, 4));
  add("far from the origin", moved(small, 1, {1e5f, -7e4f, 3e4f}));
  add("sphere far from the origin", triangles_of(sphere<float>(3, {1e3f, 2e3f, -5e2f}, 1.0f)));
  for (const float scale : {1e-30f, 1e-10f, 1e-5f, 1e5f, 1e10f, 1e30f})
    add("scaled", moved(small, scale, {}));
  add("needles, tiny", moved(slivers(300, false, 5), 1e-20f, {}));
  std::vector<Triangle<float>> grid;  // ties, duplicates, coplanar overlaps and triangles of no area
  Pcg32 random(6);
  for (int i = 0; i < 400; ++i) {
    const auto corner = [&] {
      const auto c = [&] { return static_cast<float>(random.below(4)); };
      const float x = c(), y = c();
      return V{x, y, c()};
    };
    const V a = corner(), b = corner();
    grid.push_back({a, b, corner()});
  }
  add("grid", grid);
  std::vector<Triangle<float>> boxes;
  Mesh<float> mesh;
  for (int i = 0; i < 40; ++i) {
    const V low = in_cube(random, 1.0f);
    add_box<float>(mesh, {low, low + V{0.3f, 0.01f, 0.5f}});
  }
  add("boxes", triangles_of(mesh));
  auto segments = small;  // and points among them, and far away
  for (std::size_t i = 0; i < segments.size(); i += 2) segments[i].c = (segments[i].a + segments[i].b) * 0.5f;
  for (std::size_t i = 0; i < segments.size(); i += 6) segments[i].b = segments[i].c = segments[i].a;
  for (std::size_t i = 4; i < segments.size(); i += 50) segments[i].a = segments[i].b = V{100, 200, 300};
  add("segments and points", segments);
  add("segments far from the origin", moved(segments, 1, {1e5f, 1e5f, 1e5f}));
  auto outlier = small;
  outlier.push_back({{1e12f, 0, 0}, {1e12f, 1e12f, 0}, {0, 0, 1e12f}});
  add("one large among small", outlier);
  auto mixed = small;
  for (std::size_t i = 0; i < mixed.size(); ++i) {
    const float s = std::ldexp(1.0f, -static_cast<int>(i % 60));
    const V a = mixed[i].a;
    mixed[i] = {a, a + (mixed[i].b - a) * s, a + (mixed[i].c - a) * s};
  }
  add("mixed sizes", mixed);
  return cases;
}

/// Near the surface, around, far away, in the middle, at corners, on edges.
inline std::vector<V> places(const std::vector<Triangle<float>>& triangles, std::size_t n,
                             std::uint64_t seed) {
  Pcg32 random(seed, 3);
  Box<float, 3> box;
  for (const auto& t : triangles) box.grow(t.box());
  V half = box.high * 0.5f - box.low * 0.5f;
  const V centre = box.centre();
  std::vector<V> out;
  for (std::size_t i = 0; i < n; ++i) {
    const auto& t = triangles[random.below(static_cast<std::uint32_t>(triangles.size()))];
    const V aside = in_cube(random, 1.0f);
    const V wide{aside[0] * half[0], aside[1] * half[1], aside[2] * half[2]};
    const float u = random.uniform<float>() * 0.5f, v = random.uniform<float>() * 0.5f;
    const V on = t.a + (t.b - t.a) * u + (t.c - t.a) * v;
    switch (i % 7) {
      case 0:
        out.push_back(on + wide * 1e-3f);
        break;
      case 1:
        out.push_back(centre + wide * 1.2f);
        break;
      case 2:
        out.push_back(centre + wide * 30.0f);
        break;
      case 3:
        out.push_back(centre + wide * 1e-3f);
        break;
      case 4:
        out.push_back(i % 2 ? t.b : (t.a + t.c) * 0.5f);
        break;
      case 5:
        out.push_back(on);
        break;
      default:
        out.push_back(t.a + (t.box().extent() + half * 1e-6f) * aside[0]);
    }
  }
  return out;
}

/// The nearest triangle by exact arithmetic, of equals the lowest id.
struct ExactNearest {
  Id id = no_id;
  double distance2 = std::numeric_limits<double>::infinity();  // rounded once
};
inline ExactNearest exact_nearest(const std::vector<Triangle<float>>& triangles, const V& query) {
  const D p(query);
  std::vector<double> d(triangles.size());
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < d.size(); ++i) {
    d[i] = geometry::distance_bracket(p, Triangle<double>(triangles[i])).low;
    least = std::min(least, geometry::distance_bracket(p, Triangle<double>(triangles[i])).high);
  }
  ExactNearest best;
  for (std::size_t i = 0; i < d.size(); ++i) {
    if (d[i] > least) continue;
    if (best.id != no_id && geometry::compare_distance(p, Triangle<double>(triangles[i]),
                                                       Triangle<double>(triangles[best.id])) >= 0)
      continue;
    best.id = static_cast<Id>(i);
  }
  best.distance2 = geometry::exact_distance2(p, Triangle<double>(triangles[best.id]));
  return best;
}

}  // namespace treeline::accel::test
