#include "bench/ray/oracle.hpp"

#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/intersections.h>

#include <optional>

namespace treeline::bench::ray {
namespace {

using Kernel = CGAL::Exact_predicates_exact_constructions_kernel;
using Number = Kernel::FT;

Kernel::Point_3 point(const geometry::Vec3f& p) { return {double(p[0]), double(p[1]), double(p[2])}; }

bool usable(const geometry::Rayf& r) {
  return geometry::is_finite(r.origin) && geometry::is_finite(r.direction) &&
         (r.direction[0] != 0 || r.direction[1] != 0 || r.direction[2] != 0) && !std::isnan(r.t_min) &&
         !std::isnan(r.t_max);
}

struct Face {
  Kernel::Triangle_3 triangle;
  accel::Id id;
};

TrueHit closest(std::span<const Face> faces, const geometry::Rayf& r) {
  const Kernel::Point_3 origin = point(r.origin);
  const Kernel::Vector_3 direction = point(r.direction) - CGAL::ORIGIN;
  const Kernel::Line_3 line(origin, direction);
  std::optional<Number> best;
  TrueHit hit;
  for (const Face& face : faces) {
    if (!CGAL::do_intersect(line, face.triangle)) continue;
    const auto met = CGAL::intersection(line, face.triangle);
    if (!met) continue;
    const auto* p = boost::get<Kernel::Point_3>(&*met);
    if (!p) continue;  // a segment: the line lies in the triangle's plane
    if (CGAL::scalar_product(face.triangle.supporting_plane().orthogonal_vector(), direction) == 0) continue;
    const Number t = CGAL::scalar_product(*p - origin, direction) / direction.squared_length();
    if (t < Number(double(r.t_min)) || (std::isfinite(r.t_max) ? t > Number(double(r.t_max)) : r.t_max < 0))
      continue;
    if (!best || t < *best) best = t, hit.primitive = face.id;
  }
  if (best) hit.t = CGAL::to_double(best->exact());
  return hit;
}

}  // namespace

std::optional<std::vector<TrueHit>> oracle_closest(const geometry::Mesh3f& mesh,
                                                   std::span<const geometry::Rayf> rays) {
  std::vector<Face> faces;
  for (std::size_t f = 0; f < mesh.size(); ++f) {
    const auto t = mesh.triangle(f);
    if (!geometry::is_finite(t)) continue;
    const Kernel::Triangle_3 triangle(point(t.a), point(t.b), point(t.c));
    if (!triangle.is_degenerate()) faces.push_back({triangle, static_cast<accel::Id>(f)});
  }
  std::vector<TrueHit> hits;
  for (const auto& ray : rays) hits.push_back(usable(ray) ? closest(faces, ray) : TrueHit{});
  return hits;
}

}  // namespace treeline::bench::ray
