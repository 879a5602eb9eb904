// Points whose side is hard to tell: rays from them meet vertices and edges, sheets lie one float apart,
// faces are thin or have no area. Every mesh is closed, oriented and does not cross itself, and every point's
// side is known exactly.
#include "datasets_gen/hard/hard_insides.hpp"

#include <limits>

#include "datasets_gen/hard/family.hpp"
#include "datasets_gen/meshes/damage.hpp"

namespace treeline::datasets {
namespace {

using geometry::Mesh3f;
using geometry::Vec3f;

constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr const char* exact_law = "answers are those of exact arithmetic; points on the surface are inside";

Mesh3f mapped(Mesh3f mesh, const auto& f) {
  for (Vec3f& p : mesh.vertices) p = f(p);
  return mesh;
}
void turn_around(Mesh3f& mesh) {
  for (auto& f : mesh.faces) std::swap(f[1], f[2]);
}
void append(Mesh3f& mesh, const Mesh3f& other) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (auto f : other.faces) {
    for (std::uint32_t& v : f) v += first;
    mesh.faces.push_back(f);
  }
}
Mesh3f box(const Vec3f& low, const Vec3f& high) {
  return mapped(hard::cube(1), [&](const Vec3f& p) {
    Vec3f q;
    for (int k = 0; k < 3; ++k) q[k] = p[k] < 0 ? low[k] : high[k];
    return q;
  });
}

/// Points that share two coordinates with a vertex, by axes in turn.
std::vector<Vec3f> beside_vertices(const Mesh3f& mesh, std::size_t n, std::uint64_t seed) {
  const auto box = mesh.box();
  std::vector<Vec3f> points;
  for (std::size_t i = 0; i < n; ++i) {
    Draws draws(seed, i);
    Vec3f p = mesh.vertices[i * 7 % mesh.vertices.size()];
    const int axis = static_cast<int>(i % 3);
    p[axis] = static_cast<float>(draws.uniform(double(box.low[axis]), double(box.high[axis])));
    points.push_back(p);
  }
  return points;
}
/// Points of a few floats' distance from corners and from the middles of faces.
std::vector<Vec3f> ulps_off(const Mesh3f& mesh, std::size_t n, std::uint64_t seed) {
  std::vector<Vec3f> points;
  for (std::size_t i = 0; i < n; ++i) {
    Draws draws(seed, i);
    const auto t = mesh.triangle(i * 11 % mesh.size());
    Vec3f p = i % 2 == 0 ? t.a : t.a * 0.5f + (t.b * 0.25f + t.c * 0.25f);
    for (int k = 0; k < 3; ++k)
      for (int steps = static_cast<int>(draws.uniform(-3, 4)); steps != 0; steps += steps < 0 ? 1 : -1)
        p[k] = std::nextafter(p[k], steps < 0 ? -infinity : infinity);
    points.push_back(p);
  }
  return points;
}
std::vector<Vec3f> in_box(const Mesh3f& mesh, std::size_t n, std::uint64_t seed) {
  const auto box = mesh.box();
  return hard::random_points(seed, n, Vec3d{box.low[0], box.low[1], box.low[2]},
                             Vec3d{box.high[0], box.high[1], box.high[2]});
}
std::vector<Vec3f> joined(std::vector<Vec3f> a, const std::vector<Vec3f>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

HardInside named(std::string name, std::string source, Mesh3f mesh, std::vector<Vec3f> points) {
  HardInside c;
  c.name = std::move(name), c.source = std::move(source), c.law = exact_law;
  c.mesh = std::move(mesh), c.points = std::move(points);
  return c;
}

void add_aligned(std::vector<HardInside>& all) {
  const Mesh3f sphere = hard::snapped_sphere(12);
  all.push_back(
      named("rays_through_vertices",
            "fcpw #14: rays along the axes miss the hits on edges; measured: one sign in twenty wrong",
            sphere, beside_vertices(sphere, 2000, 171)));
  std::vector<Vec3f> lattice;
  for (int x = -5; x <= 5; ++x)
    for (int y = -5; y <= 5; ++y)
      for (int z = -5; z <= 5; ++z)
        lattice.push_back({static_cast<float>(x) / 4, static_cast<float>(y) / 4, static_cast<float>(z) / 4});
  all.push_back(named("points_on_a_lattice",
                      "derivation: every ray along an axis or a diagonal runs in faces and through vertices",
                      hard::cube(8), lattice));
}

void add_close(std::vector<HardInside>& all) {
  const Mesh3f sphere = hard::snapped_sphere(12);
  all.push_back(named("ulps_off_the_surface",
                      "derivation: the plane of a face is nearer than the rounding of its own normal",
                      mapped(sphere, [](const Vec3f& p) { return p * 0.7331f; }),
                      ulps_off(mapped(sphere, [](const Vec3f& p) { return p * 0.7331f; }), 2000, 172)));
  const float next = std::nextafter(1.0f, 2.0f);
  std::vector<Vec3f> points;
  for (int i = 0; i < 500; ++i) {
    Draws draws(173, static_cast<std::uint64_t>(i));
    const float z = i % 4 == 0   ? 1
                    : i % 4 == 1 ? next
                    : i % 4 == 2 ? std::nextafter(1.f, 0.f)
                                 : std::nextafter(next, 2.f);
    points.push_back({static_cast<float>(draws.uniform(-1, 1)), static_cast<float>(draws.uniform(-1, 1)), z});
  }
  all.push_back(named("sheet_one_float_thick", "derivation: times of both its sides round to one float",
                      box({-1, -1, 1}, {1, 1, next}), points));
  Mesh3f walls = box({0, 0, 0}, {1, 1, 1});
  append(walls, box({1, 0, 0}, {2, 1, 1}));
  all.push_back(named("wall_that_is_there_twice",
                      "Zhou, Grinspun, Zorin and Jacobson 2016: coincident faces that look both ways", walls,
                      hard::random_points(174, 1000, {-0.25, -0.25, -0.25}, {2.25, 1.25, 1.25})));
  all.back().coincident = true;
  Mesh3f shells;
  for (int i = 0; i < 6; ++i) {
    Mesh3f shell = mapped(hard::snapped_sphere(6),
                          [&](const Vec3f& p) { return p * (1 - 0.0625f * static_cast<float>(i)); });
    if (i % 2 == 1) turn_around(shell);
    append(shells, shell);
  }
  all.push_back(named("six_close_shells",
                      "OpenVDB #111, #903: nested shells filled, wrong signs between close sheets", shells,
                      joined(in_box(shells, 1000, 175), beside_vertices(shells, 1000, 176))));
}

void add_thin(std::vector<HardInside>& all) {
  const Mesh3f sphere = hard::snapped_sphere(12);
  const Mesh3f needles = mapped(sphere, [](const Vec3f& p) {
    return Vec3f{p[0] * 0x1p-12f, p[1] * 64, p[2]};
  });
  all.push_back(named("closed_needles", "TriangleMeshDistance: signs fail on meshes of thin triangles",
                      needles, joined(in_box(needles, 1000, 177), beside_vertices(needles, 1000, 178))));
  // Every face is cut in three at a point almost on its first side: two needles and a cap.
  Mesh3f caps = sphere;
  for (std::size_t f = 0; f < sphere.size(); ++f) {
    const auto [a, b, c] = sphere.faces[f];
    const auto m = static_cast<std::uint32_t>(caps.vertices.size());
    caps.vertices.push_back(caps.vertices[a] * 0.5f + caps.vertices[b] * 0.499755859375f +
                            caps.vertices[c] * 0.000244140625f);
    caps.faces[f] = {a, b, m};
    caps.faces.push_back({b, c, m}), caps.faces.push_back({c, a, m});
  }
  all.push_back(named(
      "closed_caps", "Botsch and Kobbelt 2001: caps, triangles with one angle near 180°", caps,
      joined(ulps_off(caps, 500, 179), joined(in_box(caps, 700, 180), beside_vertices(caps, 700, 181)))));
  const Mesh3f slits = damaged(sphere, {DamageKind::degenerate, 0.1}, 182);
  all.push_back(named("faces_without_area",
                      "libigl #905; measured: ten such faces make one sign in 400 of pseudonormals wrong",
                      slits, joined(in_box(slits, 1000, 183), beside_vertices(slits, 1000, 184))));
  // Every face drawn out to a spike of 16 times its size.
  Mesh3f spikes = hard::snapped_sphere(4);
  for (std::size_t f = 0, n = spikes.size(); f < n; ++f) {
    const auto [a, b, c] = spikes.faces[f];
    const auto t = spikes.triangle(f);
    const auto m = static_cast<std::uint32_t>(spikes.vertices.size());
    const Vec3f middle = (t.a + t.b + t.c) / 3.0f;
    spikes.vertices.push_back(middle * 3.0f);
    spikes.faces[f] = {a, b, m};
    spikes.faces.push_back({b, c, m}), spikes.faces.push_back({c, a, m});
  }
  all.push_back(named("spikes",
                      "Baerentzen and Aanaes 2005: beyond a sharp corner the planes of its faces disagree",
                      spikes, joined(in_box(spikes, 1500, 185), ulps_off(spikes, 500, 186))));
}

void add_ranges(std::vector<HardInside>& all) {
  const Mesh3f sphere = hard::snapped_sphere(8);
  for (const auto& [name, scale] :
       {std::pair("inside_at_1e-30", 0x1p-100f), std::pair("inside_at_1e18", 0x1p60f)}) {
    const Mesh3f mesh = mapped(sphere, [s = scale](const Vec3f& p) { return p * s; });
    all.push_back(named(name, "derivation: products of four lengths leave the range of float", mesh,
                        joined(in_box(mesh, 500, 187), beside_vertices(mesh, 500, 188))));
  }
  const Mesh3f far = mapped(sphere, [](const Vec3f& p) { return p + Vec3f{2048, -1024, 4096}; });
  all.push_back(
      named("inside_far_from_the_origin", "derivation: the place takes twelve of float's digits", far,
            joined(in_box(far, 500, 189), joined(beside_vertices(far, 500, 190), ulps_off(far, 500, 191)))));
}

void add_bad(std::vector<HardInside>& all) {
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  const Mesh3f cube = hard::cube(2);
  HardInside& queries =
      all.emplace_back(named("points_not_finite", "a caller's NaN and infinity", cube,
                             {{0, 0, 0}, {nan, 0, 0}, {0, infinity, 0}, {2, 0, 0}, {0, 0, -infinity}}));
  queries.expect = Expect::answers_or_refuses;
  queries.law = "a point that is not finite is refused by its index; or the others are told right";
  HardInside& corner = all.emplace_back(named("corner_not_finite", "files hold NaN corners", cube,
                                              {{0, 0, 0}, {0.5f, 0.25f, 0}, {2, 0, 0}, {0, -3, 0}}));
  corner.expect = Expect::answers_or_refuses;
  corner.law =
      "a mesh with a corner that is not finite is refused by its index; or told right without the face";
  hard::add_triangle(corner.mesh, {nan, 0, 0}, {0, 1, 0}, {0, 0, 1});
  all.push_back(named("no_faces", "derivation: nothing has no inside", {}, {{0, 0, 0}, {1, 2, 3}}));
}

}  // namespace

std::vector<HardInside> hard_insides() {
  std::vector<HardInside> all;
  add_aligned(all), add_close(all), add_thin(all), add_ranges(all), add_bad(all);
  return all;
}

}  // namespace treeline::datasets
