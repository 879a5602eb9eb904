// Queries for the nearest point of a mesh on which methods are known to break. A triangle is a closed set,
// and one of no area is the segment or point that it covers: it may be nearest like any other.
#include <limits>

#include "datasets_gen/hard/family.hpp"
#include "datasets_gen/meshes/geodesic.hpp"

namespace treeline::datasets::hard {
namespace {

using geometry::Mesh3f;

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Near the surface, at it and between: points moved off random corners and middles, then points of the box.
std::vector<Vec3f> around(const Mesh3f& mesh, std::uint64_t seed, std::size_t count, double offset) {
  std::vector<Vec3f> out;
  Vec3d low{infinity, infinity, infinity}, high = scaled(low, -1);
  for (const Vec3f& p : mesh.vertices)
    for (int k = 0; k < 3; ++k)
      low[k] = std::min(low[k], double(p[k])), high[k] = std::max(high[k], double(p[k]));
  for (std::size_t i = 0; i < count; ++i) {
    Draws draws(seed, i);
    const auto t = mesh.triangle(draws.below(mesh.size()));
    const double u = draws.uniform(), v = draws.uniform() * (1 - u);
    Vec3d p = sum(scaled(Vec3d(t.a), 1 - u - v), sum(scaled(Vec3d(t.b), u), scaled(Vec3d(t.c), v)));
    if (i % 4 == 3) p = draws.in_box(low, high);
    out.push_back(rounded(i % 4 == 0 ? p : sum(p, scaled(draws.direction(), offset))));
  }
  return out;
}

Mesh3f mapped(Mesh3f mesh, const auto& map) {
  for (Vec3f& p : mesh.vertices) p = map(p);
  return mesh;
}

Mesh3f made(Mesh3f (*recipe)(const Job&), std::size_t n) {
  const Progress none;
  Ticker ticker(none);
  return recipe(Job{n, 1, ticker});
}

/// Round to the last digit of float, about (0, 0, 0).
Mesh3f ball(std::size_t f, float radius) {
  const Progress none;
  Ticker ticker(none);
  const Job job{Geodesic::faces(f), 1, ticker};
  Mesh3f mesh;
  mesh.vertices.resize(Geodesic::vertices(f));
  mesh.faces.resize(Geodesic::faces(f));
  Geodesic(f).write(job, mesh, 0, 0, false, 1, [&](const Vec3d& d) { return scaled(d, radius); });
  return mesh;
}

void append(Mesh3f& mesh, const Mesh3f& other) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (const auto& f : other.faces) mesh.faces.push_back({first + f[0], first + f[1], first + f[2]});
}

class Cases {
 public:
  HardCase& add(std::string name, std::string source, std::string law) {
    HardCase c;
    c.family = "closest_points", c.name = "closest_" + std::move(name), c.source = std::move(source),
    c.law = std::move(law);
    return all.emplace_back(std::move(c));
  }
  std::vector<HardCase> all;
};

const char* const law = "the distances are those of exact arithmetic";

void scales(Cases& cases) {
  for (const auto& [name, at] : {std::pair("at_1e3", 1e3f), std::pair("at_1e5", 1e5f)}) {
    HardCase& c = cases.add(name, "derivation: differences of large numbers lose digits, and so do answers",
                            "the distances are right to the rounding of the coordinates");
    const Vec3f centre{at, at, -at};
    c.mesh = mapped(snapped_sphere(16), [&](const Vec3f& p) { return p + centre; });
    c.probes = around(c.mesh, 141, 400, 0.05);
  }
  {
    HardCase& c = cases.add("query_far_away",
                            "derivation: to a query at 1e5 to 1e30 radii all of a mesh is about as far", law);
    c.mesh = snapped_sphere(8);
    for (std::size_t i = 0; i < 100; ++i) {
      Draws draws(142, i);
      double distance = 1e5;
      for (std::size_t k = 0; k < i % 6; ++k) distance *= 1e5;
      c.probes.push_back(rounded(scaled(draws.direction(), distance)));
    }
  }
  struct Scale {
    const char* name;
    float factor;
    const char* source;
  };
  for (const Scale& s :
       {Scale{"huge_1e15", 1e15f, "derivation: a squared area overflows float beyond 1e9"},
        Scale{"huge_1e25", 1e25f, "derivation: squared distances overflow float beyond 1e19"},
        Scale{"tiny_1e-15", 1e-15f, "derivation: a squared area vanishes in float below 1e-11"},
        Scale{"tiny_1e-25", 1e-25f, "derivation: squared distances vanish in float below 1e-23"}}) {
    HardCase& c = cases.add(s.name, s.source, law);
    c.mesh = mapped(snapped_sphere(8), [&](const Vec3f& p) { return p * s.factor; });
    c.probes = around(c.mesh, 143, 200, 0.1 * double(s.factor));
  }
  {
    HardCase& c =
        cases.add("mixed_scale", "derivation: one sphere a million times as large as the other", law);
    c.mesh = snapped_sphere(6);
    append(c.mesh, mapped(snapped_sphere(6), [](const Vec3f& p) { return p * 1e6f + Vec3f{3e6f, 0, 0}; }));
    c.probes = around(snapped_sphere(6), 144, 200, 0.1);
    for (const Vec3f& p : around(c.mesh, 145, 200, 1e5)) c.probes.push_back(p);
  }
  {
    HardCase& c = cases.add("vertex_at_1e25", "measured: tinybvh crashes on vertices at 1e25", law);
    c.mesh = snapped_sphere(8);
    c.mesh.vertices[100] = {1e25f, 0, 0};
    c.probes = around(snapped_sphere(8), 146, 200, 0.1);
  }
}

void slivers(Cases& cases) {
  struct Soup {
    const char* name;
    Mesh3f (*recipe)(const Job&);
  };
  for (const Soup& s : {Soup{"needles", needles}, Soup{"caps", caps}}) {
    HardCase& c =
        cases.add(s.name,
                  "measured: of 2e4 such triangles Embree with the textbook kernel and fcpw err by up "
                  "to 0.1, mostly by a wrong triangle",
                  law);
    c.mesh = made(s.recipe, 2000);
    c.probes = around(c.mesh, 147, 1000, 0.003);
  }
  {
    HardCase& c = cases.add(
        "sliver_alone", "measured: of a single triangle of aspect 1e5 a float plane test errs by 5e-2", law);
    // Far apart, so that a query sees its own: aspects from ten to a million.
    for (int i = 0; i < 240; ++i) {
      Draws draws(148, static_cast<std::uint64_t>(i));
      double aspect = draws.uniform(1, 10);
      for (int k = 0; k < 1 + i % 6; ++k) aspect *= 10;
      const Vec3d at{8.0 * (i % 16), 8.0 * (i / 16), 0};
      const Vec3d along = draws.direction(), side = unit_portable(cross_portable(along, draws.direction()));
      const Vec3d a = sum(at, along), b = sum(at, scaled(along, -1));
      const Vec3d foot = sum(at, scaled(along, draws.uniform(-0.9, 0.9)));
      add_triangle(c.mesh, rounded(a), rounded(b), rounded(sum(foot, scaled(side, 2 / aspect))));
      for (int q = 0; q < 3; ++q)
        c.probes.push_back(rounded(sum(foot, scaled(draws.direction(), q == 0 ? 1e-3 : q == 1 ? 0.1 : 1.0))));
    }
  }
}

void no_area(Cases& cases) {
  {
    HardCase& c =
        cases.add("points_as_triangles", "derivation: three equal corners are a point of the surface", law);
    c.mesh = snapped_sphere(8);
    for (const Vec3f& p : random_points(149, 500, {-1.5, -1.5, -1.5}, {1.5, 1.5, 1.5}))
      add_triangle(c.mesh, p, p, p);
    c.probes = around(c.mesh, 150, 400, 0.05);
  }
  {
    HardCase& c = cases.add("segments_as_triangles",
                            "CGAL 5.5: of a triangle without area the longest side is chosen by signed "
                            "coordinates, which takes a wrong one where they are negative",
                            law);
    for (std::size_t i = 0; i < 500; ++i) {
      // Multiples of 2^-6, and the third corner in the middle: collinear without rounding.
      Draws draws(151, i);
      const auto corner = [&] {
        const Vec3d p = draws.in_box({-96, -96, -96}, {96, 96, 96});
        return Vec3f{std::floor(float(p[0])) / 64, std::floor(float(p[1])) / 64,
                     std::floor(float(p[2])) / 64};
      };
      Vec3f t[3] = {corner(), corner(), {}};
      t[2] = (t[0] + t[1]) * 0.5f;
      add_triangle(c.mesh, t[i % 3], t[(i + 1) % 3], t[(i + 2) % 3]);
    }
    c.probes = around(c.mesh, 152, 400, 0.05);
  }
  {
    HardCase& c =
        cases.add("repeated_corner_index",
                  "derivation: welding close vertices leaves faces that name one vertex twice", law);
    c.mesh = snapped_sphere(8);
    const std::size_t good = c.mesh.faces.size();
    for (std::size_t i = 0; i < good; i += 3) {
      const auto f = c.mesh.faces[i];
      c.mesh.faces.push_back({f[0], f[0], f[1]});
    }
    c.probes = around(c.mesh, 153, 400, 0.05);
  }
  {
    HardCase& c = cases.add("one_point_mesh", "derivation: a mesh whose box has no extent", law);
    add_triangle(c.mesh, {0.1f, 0.2f, 0.3f}, {0.1f, 0.2f, 0.3f}, {0.1f, 0.2f, 0.3f});
    c.probes = random_points(154, 20);
    c.probes.push_back({0.1f, 0.2f, 0.3f});
  }
}

void piles(Cases& cases) {
  {
    HardCase& c = cases.add("coincident_triangles",
                            "measured: tinybvh crashes on 2e5 copies of one triangle, others turn linear",
                            "the distance is that of one triangle; which copy is returned is free");
    for (int copy = 0; copy < 2000; ++copy) add_triangle(c.mesh, {-1, -1, 0}, {1, -1, 0}, {0, 1, 0});
    c.probes = random_points(155, 100, {-2, -2, -2}, {2, 2, 2});
  }
  {
    HardCase& c = cases.add("nested_coplanar",
                            "measured: tinybvh crashes on nested coplanar triangles of one centroid", law);
    for (int i = 1; i <= 500; ++i) {
      const float s = static_cast<float>(i) / 256;
      add_triangle(c.mesh, {-s, -s, 0}, {s, -s, 0}, {0, 2 * s, 0});
    }
    c.probes = random_points(156, 200, {-4, -4, -1}, {4, 4, 1});
  }
  {
    HardCase& c =
        cases.add("middle_of_a_ball",
                  "derivation: from its centre every triangle of a ball is as far, so no box can be "
                  "left out",
                  law);
    c.mesh = ball(16, 1);
    c.probes = random_points(157, 20, {-1e-3, -1e-3, -1e-3}, {1e-3, 1e-3, 1e-3});
    c.probes.push_back({0, 0, 0});
  }
  {
    HardCase& c =
        cases.add("nested_shells", "measured: libraries fall to 3 % of their speed between shells", law);
    for (int i = 0; i < 4; ++i) append(c.mesh, ball(10, 1 + 0.25f * static_cast<float>(i)));
    // Half-way between two shells, where both are as near.
    for (std::size_t i = 0; i < 200; ++i) {
      Draws draws(158, i);
      const double radius = 1.125 + 0.25 * static_cast<double>(i % 3);
      c.probes.push_back(rounded(scaled(draws.direction(), radius)));
    }
  }
  {
    HardCase& c = cases.add("on_corners_and_edges",
                            "derivation: at a vertex six triangles are at distance 0, at an edge two",
                            "the distance is 0 at a corner; answers are those of exact arithmetic");
    c.mesh = snapped_sphere(8);
    for (std::size_t f = 0; f < c.mesh.size(); f += 4) {
      const auto t = c.mesh.triangle(f);
      c.probes.push_back(t.a);
      c.probes.push_back((t.b + t.c) * 0.5f);
    }
  }
  {
    HardCase& c =
        cases.add("flat_wall", "derivation: boxes without thickness, and queries in their plane", law);
    c.mesh = wall(16);
    for (std::size_t i = 0; i < 200; ++i) {
      Vec3f p = rounded(Draws(159, i).in_box({-0.5, -0.5, -0.5}, {0.5, 1.5, 1.5}));
      if (i % 2 == 0) p[0] = 0;
      c.probes.push_back(p);
    }
  }
}

void refusable(Cases& cases) {
  constexpr float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  const auto add = [&](const char* name, const char* source, const char* what) -> HardCase& {
    HardCase& c = cases.add(name, source, what);
    c.expect = Expect::answers_or_refuses;
    c.mesh = snapped_sphere(8);
    return c;
  };
  add("nan_queries", "derivation: every comparison with NaN is false",
      "refused with a clear error, or no answer")
      .probes = {{nan, 0, 0}, {0, nan, 0}, {nan, nan, nan}};
  add("infinite_queries", "derivation: every distance is infinite, so all triangles tie",
      "refused with a clear error, no answer, or an infinite distance")
      .probes = {{inf, 0, 0}, {0, -inf, inf}};
  {
    HardCase& c = add("nan_vertices", "derivation: a box that starts from NaN never grows",
                      "refused with a clear error, or the distances to the finite triangles");
    c.mesh.vertices[0][0] = nan;
    c.mesh.vertices[300] = {nan, nan, nan};
    c.probes = around(snapped_sphere(8), 160, 200, 0.05);
  }
  {
    HardCase& c = add("infinite_vertices", "measured: tinybvh crashes on infinite vertices",
                      "refused with a clear error, or the distances to the finite triangles");
    c.mesh.vertices[100] = {inf, 0, 0};
    c.mesh.vertices[200] = {0, -inf, inf};
    c.probes = around(snapped_sphere(8), 161, 200, 0.05);
  }
}

void few(Cases& cases) {
  {
    HardCase& c = cases.add("empty_mesh", "derivation: a root box that is empty must not be entered",
                            "there is no answer");
    c.probes = random_points(162, 20);
  }
  {
    HardCase& c =
        cases.add("vertices_without_faces", "derivation: a cloud saved as a mesh", "there is no answer");
    c.mesh.vertices = random_points(163, 50);
    c.probes = random_points(164, 20);
  }
  {
    HardCase& c = cases.add("one_triangle", "derivation: a root that is a leaf", law);
    add_triangle(c.mesh, {-1, -1, 0}, {1, -1, 0}, {0, 1, 0});
    c.probes = random_points(165, 200, {-3, -3, -3}, {3, 3, 3});
  }
}

}  // namespace

std::vector<HardCase> closest_points() {
  Cases cases;
  scales(cases), slivers(cases), no_area(cases), piles(cases), refusable(cases), few(cases);
  return std::move(cases.all);
}

}  // namespace treeline::datasets::hard
