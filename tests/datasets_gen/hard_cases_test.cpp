// Hard cases are what they say: exactly tied, exactly aimed, exactly flat, closed where rays start inside.
#include <gtest/gtest.h>

#include <cstring>
#include <map>
#include <set>

#include "datasets_gen/hard/hard_case.hpp"
#include "datasets_gen/hard/hard_insides.hpp"
#include "datasets_gen/hard/hard_rows.hpp"
#include "geometry/adjacency.hpp"
#include "geometry/intersect_triangle.hpp"

namespace treeline::datasets {
namespace {

using geometry::Vec3d, geometry::Vec3f;

const std::vector<HardCase>& cases() {
  static const std::vector<HardCase> all = hard_cases();
  return all;
}
const HardCase& named(const std::string& name) {
  for (const HardCase& c : cases())
    if (c.name == name) return c;
  throw std::out_of_range(name);
}

TEST(HardCases, SayWhatTheyAreAndStaySmall) {
  std::set<std::string> names;
  std::map<std::string, int> families;
  for (const HardCase& c : cases()) {
    EXPECT_TRUE(names.insert(c.name).second) << "twice: " << c.name;
    ++families[c.family];
    EXPECT_FALSE(c.source.empty() || c.law.empty() || c.family.empty()) << c.name;
    const std::size_t most = c.name == "equal_points_1e6"   ? 1'000'000
                             : c.name == "equal_points_1e5" ? 100'000
                                                            : 20'000;
    EXPECT_LE(c.cloud.size(), most) << c.name;
    const bool many_faces = c.name == "coincident_2e5" || c.name == "needles_4e4";
    EXPECT_LE(c.mesh.size(), many_faces ? 201'280u : 20'000u) << c.name;
    EXPECT_LE(c.queries.size(), 2000u) << c.name;
    EXPECT_LE(c.rays.size(), 20'000u) << c.name;
    EXPECT_LE(c.probes.size(), 2000u) << c.name;
    EXPECT_GT(c.queries.size() + c.rays.size() + c.outward.size() + c.probes.size(), 0u) << c.name;
    EXPECT_EQ(c.for_points() + c.for_rays() + c.for_closest_points(), 1) << c.name;
    for (const auto& f : c.mesh.faces)
      for (const auto v : f) ASSERT_LT(v, c.mesh.vertices.size()) << c.name;
  }
  for (const char* family : {"ties_duplicates", "degenerate_triangles", "far_from_origin", "edge_vertex_rays",
                             "axis_parallel_rays", "nan_infinity", "empty_one_kn", "lines_planes_outliers",
                             "float_range", "radius_borders", "box_rays", "closest_points"})
    EXPECT_GT(families[family], 3) << family;
  for (const char* family : {"grazing_rays", "self_intersection"}) EXPECT_EQ(families[family], 1) << family;
}

TEST(HardCases, AreTheSameEveryTime) {
  const std::vector<HardCase> again = hard_cases();
  ASSERT_EQ(again.size(), cases().size());
  const auto same = [](const auto& a, const auto& b) {  // bit by bit: NaN equals itself here
    return a.size() == b.size() &&
           (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof a[0]) == 0);
  };
  for (std::size_t i = 0; i < again.size(); ++i) {
    EXPECT_TRUE(same(again[i].cloud.points, cases()[i].cloud.points)) << again[i].name;
    EXPECT_TRUE(same(again[i].mesh.vertices, cases()[i].mesh.vertices)) << again[i].name;
    EXPECT_TRUE(same(again[i].rays, cases()[i].rays)) << again[i].name;
    EXPECT_TRUE(same(again[i].queries, cases()[i].queries)) << again[i].name;
    EXPECT_TRUE(same(again[i].probes, cases()[i].probes)) << again[i].name;
  }
}

TEST(HardCases, OnlyThoseThatAreNotFiniteOrAskForNothingMayBeRefused) {
  for (const HardCase& c : cases()) {
    bool finite = true;
    for (const auto& p : c.cloud.points) finite &= is_finite(p);
    for (const auto& p : c.queries) finite &= is_finite(p);
    for (const auto& p : c.mesh.vertices) finite &= is_finite(p);
    for (const auto& r : c.rays) finite &= is_finite(r.origin) && is_finite(r.direction);
    for (const auto& p : c.probes) finite &= is_finite(p);
    const bool asks = c.k > 0 && c.radius.value_or(0) >= 0;
    EXPECT_EQ(finite && asks, c.expect == Expect::answers) << c.name;
    if (!finite) continue;
    for (const auto& r : c.rays) EXPECT_NE(r.direction, Vec3f()) << c.name;
  }
}

TEST(HardRows, SayWhatTheyAreAndOnlyThoseThatAreNotFiniteMayBeRefused) {
  std::set<std::string> names;
  for (const HardCase& c : cases()) names.insert(c.name);
  for (const HardRows& c : hard_rows()) {
    EXPECT_TRUE(names.insert(c.name).second) << "twice: " << c.name;
    EXPECT_FALSE(c.source.empty() || c.law.empty()) << c.name;
    EXPECT_EQ(c.rows.columns, c.queries.columns) << c.name;
    EXPECT_GT(c.queries.size(), 0u) << c.name;
    EXPECT_LE(c.rows.size(), 20'000u) << c.name;
    const auto finite = [](const Vectors& v) {
      return std::ranges::all_of(v.scalars, [](float x) { return std::isfinite(x); });
    };
    EXPECT_EQ(finite(c.rows) && finite(c.queries), c.expect == Expect::answers) << c.name;
  }
}

TEST(HardInsides, SayWhatTheyAreAndOnlyThoseThatAreNotFiniteMayBeRefused) {
  std::set<std::string> names;
  for (const HardCase& c : cases()) names.insert(c.name);
  for (const HardRows& c : hard_rows()) names.insert(c.name);
  for (const HardInside& c : hard_insides()) {
    EXPECT_TRUE(names.insert(c.name).second) << "twice: " << c.name;
    EXPECT_FALSE(c.source.empty() || c.law.empty()) << c.name;
    EXPECT_GT(c.points.size(), 0u) << c.name;
    bool finite = true;
    for (const auto& p : c.points) finite &= is_finite(p);
    for (const auto& p : c.mesh.vertices) finite &= is_finite(p);
    EXPECT_EQ(finite, c.expect == Expect::answers) << c.name;
  }
}

/// How often the mesh winds around a point: solid angles (Van Oosterom and Strackee 1983) over 4π.
double winding(const geometry::Mesh3f& mesh, const Vec3f& at) {
  double sum = 0;
  for (std::size_t i = 0; i < mesh.size(); ++i) {
    const auto t = geometry::Triangle3d(mesh.triangle(i));
    const Vec3d a = t.a - Vec3d(at), b = t.b - Vec3d(at), c = t.c - Vec3d(at);
    const double la = length(a), lb = length(b), lc = length(c);
    sum +=
        2 * std::atan2(dot(a, cross(b, c)), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
  }
  return sum / (4 * 3.14159265358979);
}

TEST(HardCases, RaysFromInsideStartInsideAClosedMesh) {
  for (const HardCase& c : cases()) {
    if (!c.from_inside) continue;
    const geometry::Adjacency adjacency(c.mesh);
    EXPECT_TRUE(adjacency.closed() && adjacency.oriented()) << c.name;
    EXPECT_EQ(adjacency.repeated_vertex_faces(), 0u) << c.name;
    for (std::size_t i = 0; i < c.rays.size(); i += 29)
      EXPECT_NEAR(winding(c.mesh, c.rays[i].origin), 1, 1e-6) << c.name << ", ray " << i;
  }
}

TEST(HardCases, RaysFromInsideHitByTheWatertightTestInDouble) {
  for (const HardCase& c : cases()) {
    if (!c.from_inside) continue;
    const auto triangles = geometry::triangles_of(c.mesh);
    for (std::size_t i = 0; i < c.rays.size(); i += 11) {
      const auto& r = c.rays[i];
      const geometry::Rayd ray{Vec3d(r.origin), Vec3d(r.direction), r.t_min, r.t_max};
      const geometry::Watertight::Prepared<double> test(ray);
      bool hit = false;
      for (std::size_t k = 0; k < triangles.size() && !hit; ++k)
        hit = test(geometry::Triangle3d(triangles[k]), ray.t_min, ray.t_max).has_value();
      EXPECT_TRUE(hit) << c.name << ", ray " << i;
    }
  }
}

using Key = std::array<double, 3>;
Key key(const Vec3d& p) { return {p[0], p[1], p[2]}; }

TEST(HardCases, VertexRaysPassExactlyThroughVertices) {
  for (const char* name : {"at_vertices", "at_cube_corners", "ends_on_the_surface"}) {
    const HardCase& c = named(name);
    std::set<Key> vertices;
    for (const auto& v : c.mesh.vertices) vertices.insert(key(Vec3d(v)));
    // Doubles hold the sum of these floats exactly.
    for (const auto& r : c.rays)
      EXPECT_TRUE(vertices.contains(key(Vec3d(r.origin) + Vec3d(r.direction)))) << name;
  }
}

TEST(HardCases, MidpointRaysPassExactlyThroughEdges) {
  const HardCase& c = named("at_edge_midpoints");
  std::set<Key> middles;
  for (const auto& f : c.mesh.faces)
    for (int k = 0; k < 3; ++k)
      middles.insert(key(Vec3d(c.mesh.vertices[f[k]]) * 0.5 + Vec3d(c.mesh.vertices[f[(k + 1) % 3]]) * 0.5));
  for (const auto& r : c.rays) EXPECT_TRUE(middles.contains(key(Vec3d(r.origin) + Vec3d(r.direction))));
}

TEST(HardCases, FlatTrianglesHaveNoAreaAtAll) {
  for (const char* name : {"points_as_triangles", "segments_as_triangles", "repeated_corner_index"}) {
    const HardCase& c = named(name);
    std::size_t flat = 0;
    for (std::size_t i = 0; i < c.mesh.size(); ++i)
      flat += geometry::Triangle3d(c.mesh.triangle(i)).area_normal() == Vec3d();
    EXPECT_EQ(flat, c.mesh.size() - 20 * 8 * 8) << name;  // all but those of the sphere
    EXPECT_GT(flat, 400u) << name;
  }
}

TEST(HardCases, GridQueriesTieAtTheLastNeighbour) {
  const HardCase& c = named("grid_ties");
  std::size_t ties = 0;
  for (const auto& q : c.queries) {
    std::vector<double> d;
    for (const auto& p : c.cloud.points) d.push_back(distance2(Vec3d(p), Vec3d(q)));
    std::ranges::sort(d);
    ties += d[c.k - 1] == d[c.k];
  }
  EXPECT_GT(ties, c.queries.size() / 2);
}

TEST(HardCases, SquaresLeaveTheRangeOfFloats) {
  for (const Vec3f& p : named("squares_overflow").cloud.points) EXPECT_GT(length(Vec3d(p)), 1.8e19);
  std::size_t vanished = 0;
  const auto& tiny = named("squares_underflow").cloud.points;
  for (const Vec3f& p : tiny) vanished += p[0] * p[0] + p[1] * p[1] + p[2] * p[2] == 0;
  EXPECT_GT(vanished, tiny.size() / 100);
}

TEST(HardCases, PointsLieExactlyAtTheRadius) {
  const HardCase& c = named("points_exactly_at_the_radius");
  std::size_t at = 0;
  for (const Vec3f& p : c.cloud.points) at += distance2(Vec3d(p), Vec3d(c.queries[0])) == 25;
  EXPECT_EQ(at, 30u);  // 24 of (0, ±3, ±4) and 6 of (±5, 0, 0)
}

TEST(HardCases, AxisRaysHaveTheComponentsInTheirNames) {
  for (const auto& r : named("from_inside_negative_zero").rays) {
    int zeros = 0;
    for (int k = 0; k < 3; ++k) zeros += r.direction[k] == 0 && std::signbit(r.direction[k]);
    EXPECT_EQ(zeros, 2);
  }
  for (const auto& r : named("from_inside_denormal").rays) {
    int tiny = 0;
    for (int k = 0; k < 3; ++k) tiny += std::fpclassify(r.direction[k]) == FP_SUBNORMAL;
    EXPECT_EQ(tiny, 2);
  }
}

}  // namespace
}  // namespace treeline::datasets
