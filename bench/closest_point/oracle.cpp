#include "bench/closest_point/oracle.hpp"

#include <CGAL/Exact_predicates_exact_constructions_kernel.h>

#include <optional>

namespace treeline::bench::closest_point {
namespace {

using Kernel = CGAL::Exact_predicates_exact_constructions_kernel;
using Number = Kernel::FT;

Kernel::Point_3 point(const geometry::Vec3f& p) { return {double(p[0]), double(p[1]), double(p[2])}; }

/// By the segments and points that a triangle of no area covers; its own projection has a mistake there.
Number squared_distance(const Kernel::Point_3& q, const geometry::Triangle3f& t) {
  const Kernel::Point_3 a = point(t.a), b = point(t.b), c = point(t.c);
  if (!CGAL::collinear(a, b, c)) return CGAL::squared_distance(q, Kernel::Triangle_3(a, b, c));
  std::optional<Number> least;
  const auto offer = [&](const Number& d) {
    if (!least || d < *least) least = d;
  };
  const Kernel::Point_3* corners[] = {&a, &b, &c};
  for (int i = 0; i < 3; ++i) {
    const Kernel::Point_3 &from = *corners[i], &to = *corners[(i + 1) % 3];
    offer(CGAL::squared_distance(q, from));
    if (from != to) offer(CGAL::squared_distance(q, Kernel::Segment_3(from, to)));
  }
  return *least;
}

}  // namespace

std::optional<std::vector<TrueClosest>> oracle_closest(const geometry::Mesh3f& mesh,
                                                       std::span<const geometry::Vec3f> queries) {
  std::vector<TrueClosest> out(queries.size());
  for (std::size_t i = 0; i < queries.size(); ++i) {
    if (!geometry::is_finite(queries[i])) continue;
    const Kernel::Point_3 q = point(queries[i]);
    std::optional<Number> least;
    for (std::size_t f = 0; f < mesh.size(); ++f) {
      const geometry::Triangle3f t = mesh.triangle(f);
      if (!geometry::is_finite(t)) continue;
      const Number distance2 = squared_distance(q, t);
      if (least && distance2 >= *least) continue;
      least = distance2, out[i].primitive = static_cast<accel::Id>(f);
    }
    if (least) out[i].distance2 = CGAL::to_double(least->exact());
  }
  return out;
}

}  // namespace treeline::bench::closest_point
