// The exact predicates against a second witness: CGAL's exact kernel.
#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/intersections.h>
#include <CGAL/squared_distance_3.h>
#include <gtest/gtest.h>

#include "geometry/exact.hpp"
#include "tests/geometry/exact_numbers.hpp"

namespace treeline::test {
namespace {

using Kernel = CGAL::Exact_predicates_exact_constructions_kernel;
Kernel::Point_3 point(const Vec3d& p) { return {p[0], p[1], p[2]}; }
Kernel::Triangle_3 triangle(const Triangle3d& t) { return {point(t.a), point(t.b), point(t.c)}; }

template <class F>
void for_some_kinds(int cases, const F& check) {
  for (const Numbers kind : {Numbers::uniform, Numbers::whole, Numbers::last_place, Numbers::huge}) {
    Pcg32 random(23, static_cast<std::uint64_t>(kind));
    for (int i = 0; i < cases && !testing::Test::HasFailure(); ++i) check(kind, random);
  }
}

TEST(ExactCgal, Orientation) {
  for_some_kinds(2000, [](Numbers kind, Pcg32& random) {
    const Triangle3d t = hard_triangle(kind, random);
    const Vec3d d = hard_point(kind, random);
    ASSERT_EQ(orientation(t.a, t.b, t.c, d),
              int(CGAL::orientation(point(t.a), point(t.b), point(t.c), point(d))));
  });
}

// Where the line does not run in the triangle's plane; CGAL counts a segment in common as a hit.
TEST(ExactCgal, LineThroughTriangle) {
  int hits = 0;
  for_some_kinds(1000, [&](Numbers kind, Pcg32& random) {
    const Triangle3d t = hard_triangle(kind, random);
    const Vec3d o = hard_point(kind, random), d = hard_point(kind, random);
    if (d == Vec3d{} || triangle(t).is_degenerate()) return;
    const Kernel::Vector_3 along = point(d) - CGAL::ORIGIN;
    if (CGAL::scalar_product(triangle(t).supporting_plane().orthogonal_vector(), along) == 0) {
      ASSERT_EQ(line_meets({o, d}, t), 0);
      return;
    }
    const bool truth = CGAL::do_intersect(Kernel::Line_3(point(o), along), triangle(t));
    ASSERT_EQ(line_meets({o, d}, t) != 0, truth);
    hits += truth;
  });
  EXPECT_GT(hits, 300);
}

TEST(ExactCgal, TriangleBox) {
  for_some_kinds(1000, [](Numbers kind, Pcg32& random) {
    const Triangle3d t = hard_triangle(kind, random);
    const Vec3d p = hard_point(kind, random), q = hard_point(kind, random);
    if (triangle(t).is_degenerate()) return;  // outside CGAL's precondition
    const Kernel::Iso_cuboid_3 box(point(min(p, q)), point(max(p, q)));
    ASSERT_EQ(overlaps(t, {min(p, q), max(p, q)}), CGAL::do_intersect(triangle(t), box));
  });
}

TEST(ExactCgal, Distance) {
  for_some_kinds(500, [](Numbers kind, Pcg32& random) {
    const Triangle3d t = hard_triangle(kind, random), s = hard_triangle(kind, random);
    const Vec3d p = hard_point(kind, random);
    if (triangle(t).is_degenerate() || triangle(s).is_degenerate()) return;
    const Kernel::FT x = CGAL::squared_distance(point(p), triangle(t)),
                     y = CGAL::squared_distance(point(p), triangle(s));
    ASSERT_EQ(compare_distance(p, t, s), int(CGAL::compare(x, y)));
    const double found = exact_distance2(p, t);
    ASSERT_LE(Kernel::FT(std::nextafter(found, 0.0)), x);
    ASSERT_GE(Kernel::FT(std::nextafter(found, INFINITY)), x);
  });
}

}  // namespace
}  // namespace treeline::test
