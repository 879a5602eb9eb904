// CGAL's AABB_tree: a plain binary tree of boxes with CGAL's own predicates at its leaves, over a kernel of
// choice (cgal_aabb.cpp, cgal_aabb_epick.cpp).
//
// Its manual asks for
// triangles that have an area, so others, and those that are not finite, are left out here. Its ray queries
// start at the origin and have no far end: the origin is moved to t_min, a bounded any-hit query becomes a
// segment, and a bounded closest hit is cut off afterwards. CGAL reports a triangle in the ray's plane as met
// in a segment; this task does not count it. The search is repeated without such triangles only when one
// comes first, so that no other ray pays for the test.
#pragma once

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/version.h>

#include "accel/batch.hpp"
#include "bench/core/registry.hpp"
#include "bench/ray/method.hpp"

namespace treeline::bench::ray {

template <class Kernel>
class CgalAabb final : public Index {
  using Triangles = std::vector<typename Kernel::Triangle_3>;
  using Primitive = CGAL::AABB_triangle_primitive<Kernel, typename Triangles::const_iterator>;
  using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>>;
  using Point = typename Kernel::Point_3;
  using Vector = typename Kernel::Vector_3;
  using CgalRay = typename Kernel::Ray_3;
  using Rayf = geometry::Rayf;

 public:
  explicit CgalAabb(const geometry::Mesh3f& mesh) {
    triangles_.reserve(mesh.size()), faces_.reserve(mesh.size());
    for (std::size_t f = 0; f < mesh.size(); ++f) {
      const auto t = mesh.triangle(f);
      if (!geometry::is_finite(t)) continue;
      const typename Kernel::Triangle_3 triangle(point(geometry::Vec3d(t.a)), point(geometry::Vec3d(t.b)),
                                                 point(geometry::Vec3d(t.c)));
      if (triangle.is_degenerate()) continue;
      triangles_.push_back(triangle), faces_.push_back(static_cast<accel::Id>(f));
    }
    tree_.insert(triangles_.cbegin(), triangles_.cend());
    tree_.build();
  }

  void closest(std::span<const Rayf> rays, std::span<RayAnswer> out, const Knobs&,
               int threads) const override {
    accel::parallel_ranges(rays.size(), threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) check(rays[i]), out[i] = closest(rays[i]);
    });
  }
  void any(std::span<const Rayf> rays, std::span<std::uint8_t> out, const Knobs&,
           int threads) const override {
    accel::parallel_ranges(rays.size(), threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) check(rays[i]), out[i] = any(rays[i]);
    });
  }

 private:
  static Point point(const geometry::Vec3d& p) { return {p[0], p[1], p[2]}; }
  static Vector vector(const geometry::Vec3d& v) { return {v[0], v[1], v[2]}; }
  static void check(const Rayf& r) {
    if (!geometry::is_finite(r.origin) || !geometry::is_finite(r.direction) ||
        geometry::length2(r.direction) == 0 || std::isnan(r.t_min) || std::isnan(r.t_max))
      throw std::invalid_argument("CGAL has no ray that is not finite or has no direction");
  }

  RayAnswer closest(const Rayf& r) const {
    const geometry::Vec3d o(r.origin), d(r.direction);
    const CgalRay ray(point(o + d * double(r.t_min)), vector(d));
    RayAnswer answer;
    auto hit = tree_.first_intersection(ray);
    if (hit && !boost::get<Point>(&hit->first)) hit = first_across(ray);
    if (!hit) return answer;
    const auto* p = boost::get<Point>(&hit->first);
    if (!p) return answer;
    const double t = CGAL::scalar_product(*p - point(o), vector(d)) / geometry::length2(d);
    if (t > double(r.t_max)) return answer;
    answer.t = static_cast<float>(t);
    answer.primitive = faces_[static_cast<std::size_t>(hit->second - triangles_.cbegin())];
    return answer;
  }
  /// The first intersection with a triangle that is not in the ray's plane.
  auto first_across(const CgalRay& ray) const {
    const Vector along = ray.to_vector();
    return tree_.first_intersection(ray, [&](const typename Triangles::const_iterator& t) {
      return CGAL::scalar_product(CGAL::normal((*t)[0], (*t)[1], (*t)[2]), along) == 0;
    });
  }
  bool any(const Rayf& r) const {
    const geometry::Vec3d o(r.origin), d(r.direction);
    const auto from = point(o + d * double(r.t_min));
    if (!std::isfinite(r.t_max)) return tree_.do_intersect(CgalRay(from, vector(d)));
    if (r.t_max < r.t_min) return false;
    return tree_.do_intersect(typename Kernel::Segment_3(from, point(o + d * double(r.t_max))));
  }

  Triangles triangles_;
  std::vector<accel::Id> faces_;  // of each triangle
  Tree tree_;
};

template <class Kernel>
bool register_cgal_aabb(const char* name, Claim claim) {
  return Registry<Method>::instance().add(
      {.info = {.name = name,
                .family = "bvh",
                .source = Source::peer,
                .claim = claim,
                .peer_version = CGAL_VERSION_STR,
                .ladder = 50,
                .largest_n = 2'000'000,
                .quick_largest_n = 500'000,  // a random ray through a million thin triangles takes 1.2 ms
                .scales = false},            // would take as long as all the others
       .build = [](const geometry::Mesh3f& mesh, const Knobs&, int) -> std::unique_ptr<Index> {
         return std::make_unique<CgalAabb<Kernel>>(mesh);
       }});
}

}  // namespace treeline::bench::ray
