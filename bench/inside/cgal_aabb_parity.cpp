// CGAL's AABB_tree with exact predicates: how many triangles one ray in a fixed direction meets, as many a
// program does it. A ray through an edge meets both triangles, one along an axis runs through vertices often.
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/version.h>

#include "accel/batch.hpp"
#include "bench/core/registry.hpp"
#include "bench/inside/method.hpp"

namespace treeline::bench::inside {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Triangles = std::vector<Kernel::Triangle_3>;
using Tree = CGAL::AABB_tree<
    CGAL::AABB_traits<Kernel, CGAL::AABB_triangle_primitive<Kernel, Triangles::const_iterator>>>;

class AabbParity final : public Index {
 public:
  AabbParity(const geometry::Mesh3f& mesh, bool along_axis)
      : direction_(along_axis ? Kernel::Vector_3(0, 0, 1) : Kernel::Vector_3(0.4813, 0.3607, 0.7989)) {
    for (std::size_t f = 0; f < mesh.size(); ++f) {
      const auto t = mesh.triangle(f);
      if (!geometry::is_finite(t)) continue;
      const Kernel::Triangle_3 triangle(point(t.a), point(t.b), point(t.c));
      if (!triangle.is_degenerate()) triangles_.push_back(triangle);
    }
    tree_.insert(triangles_.cbegin(), triangles_.cend());
    tree_.build();
  }

  void inside(std::span<const geometry::Vec3f> points, std::span<std::uint8_t> out, const Knobs&,
              int threads) const override {
    accel::parallel_ranges(points.size(), threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        if (!geometry::is_finite(points[i]))
          throw std::invalid_argument("CGAL has no points that are not finite, such as query " +
                                      std::to_string(i));
        const Kernel::Ray_3 ray(point(points[i]), direction_);
        out[i] = triangles_.empty() ? 0 : tree_.number_of_intersected_primitives(ray) % 2;
      }
    });
  }

 private:
  static Kernel::Point_3 point(const geometry::Vec3f& p) {
    return {double(p[0]), double(p[1]), double(p[2])};
  }

  Kernel::Vector_3 direction_;
  Triangles triangles_;
  Tree tree_;
};

[[maybe_unused]] const bool registered = Registry<Method>::instance().add(
    {.info = {.name = "cgal_aabb_parity",
              .family = "bvh",
              .source = Source::peer,
              .claim = Claim::approximate,
              .peer_version = CGAL_VERSION_STR,
              .build_knobs = {Knobs{{"ray", "skew"}}, Knobs{{"ray", "axis"}}},
              .stress_builds = {1},
              .ladder = 71,
              .quick_builds = 1,
              .largest_n = 2'000'000,
              .scales = false},
     .build = [](const geometry::Mesh3f& mesh, const Knobs& knobs, int) -> std::unique_ptr<Index> {
       return std::make_unique<AabbParity>(mesh, knobs.at("ray") == "axis");
     }});

}  // namespace
}  // namespace treeline::bench::inside
