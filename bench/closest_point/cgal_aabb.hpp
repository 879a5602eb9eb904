// CGAL's AABB_tree: a plain binary tree of boxes that starts each search from a hint, over a kernel of choice
// (cgal_aabb.cpp, cgal_aabb_epick.cpp).
//
// The hint is the nearest of a KD tree over one point of each triangle (knob hint, which its manual advises
// for many queries); without it every search starts from the first triangle. Triangles that are not finite
// are left out. Those of no area stay in: its manual asks for none, but its projection has a branch for them.
#pragma once

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/version.h>

#include "accel/batch.hpp"
#include "bench/closest_point/method.hpp"
#include "bench/core/registry.hpp"

namespace treeline::bench::closest_point {

template <class Kernel>
class CgalAabb final : public Index {
  using Triangles = std::vector<typename Kernel::Triangle_3>;
  using Primitive = CGAL::AABB_triangle_primitive<Kernel, typename Triangles::const_iterator>;
  using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>>;
  using Point = typename Kernel::Point_3;

 public:
  CgalAabb(const geometry::Mesh3f& mesh, bool hint) {
    triangles_.reserve(mesh.size()), faces_.reserve(mesh.size());
    for (std::size_t f = 0; f < mesh.size(); ++f) {
      const geometry::Triangle3f t = mesh.triangle(f);
      if (!geometry::is_finite(t)) continue;
      triangles_.emplace_back(point(geometry::Vec3d(t.a)), point(geometry::Vec3d(t.b)),
                              point(geometry::Vec3d(t.c)));
      faces_.push_back(static_cast<accel::Id>(f));
    }
    tree_.insert(triangles_.cbegin(), triangles_.cend());
    tree_.do_not_accelerate_distance_queries();
    tree_.build();
    if (hint && !triangles_.empty()) tree_.accelerate_distance_queries();
  }

  void closest(const Queries& queries, Answers& out, const Knobs&, int threads) const override {
    const auto answers = out.fill<double>(queries.size());
    accel::parallel_ranges(queries.size(), threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) answers[i] = closest(queries.doubles[i], i);
    });
  }

 private:
  static Point point(const geometry::Vec3d& p) { return {p[0], p[1], p[2]}; }

  Answer closest(const geometry::Vec3d& q, std::size_t number) const {
    if (!geometry::is_finite(q))
      throw std::invalid_argument("CGAL has no points that are not finite, such as query " +
                                  std::to_string(number));
    if (triangles_.empty()) return {};  // it asks for a tree that is not empty
    const auto found = tree_.closest_point_and_primitive(point(q));
    Answer answer;
    answer.point = {found.first.x(), found.first.y(), found.first.z()};
    answer.distance2 = geometry::length2(q - answer.point);
    answer.primitive = faces_[static_cast<std::size_t>(found.second - triangles_.cbegin())];
    return answer;
  }

  Triangles triangles_;
  std::vector<accel::Id> faces_;  // of each triangle
  Tree tree_;
};

template <class Kernel>
bool register_cgal_aabb(const char* name, Claim claim, std::size_t quick_largest_n) {
  return Registry<Method>::instance().add(
      {.info = {.name = name,
                .family = "bvh",
                .source = Source::peer,
                .claim = claim,
                .peer_version = CGAL_VERSION_STR,
                .build_knobs = {Knobs{{"hint", true}}, Knobs{{"hint", false}}},
                .ladder = 70,
                .quick_builds = 1,
                .quick_largest_n = quick_largest_n,
                .scales = false},  // would take as long as all the others
       .build = [](const geometry::Mesh3f& mesh, const Knobs& knobs, int) -> std::unique_ptr<Index> {
         return std::make_unique<CgalAabb<Kernel>>(mesh, knobs.at("hint").get<bool>());
       },
       .roundoff = geometry::tolerance::unit_roundoff<double>});
}

}  // namespace treeline::bench::closest_point
