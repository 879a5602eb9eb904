// CGAL's Side_of_triangle_mesh, with exact predicates: a ray along an axis, random ones where it meets an
// edge.
//
// It is given an AABB tree over triangles, not a half-edge mesh, which could not hold faces that are doubled
// or turned around. Its manual asks for triangles that have an area and a closed mesh; faces without area,
// and those that are not finite, are left out.
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Side_of_triangle_mesh.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/version.h>

#include "accel/batch.hpp"
#include "bench/core/registry.hpp"
#include "bench/inside/method.hpp"

namespace treeline::bench::inside {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Triangles = std::vector<Kernel::Triangle_3>;
using OfTriangles = CGAL::AABB_triangle_primitive<Kernel, Triangles::const_iterator>;
/// Side_of_triangle_mesh is compiled with a way to fill a tree from a half-edge mesh, which a tree that is
/// given to it never takes.
struct Primitive : OfTriangles {
  using OfTriangles::OfTriangles;
  template <class Face, class Mesh, class Points>
  Primitive(const Face&, const Mesh&, const Points&) : OfTriangles(Triangles::const_iterator()) {}
};
using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>>;
using Side = CGAL::Side_of_triangle_mesh<CGAL::Surface_mesh<Point>, Kernel, CGAL::Default, Tree>;

Point point(const geometry::Vec3f& p) { return {double(p[0]), double(p[1]), double(p[2])}; }

class SideOfMesh final : public Index {
 public:
  explicit SideOfMesh(const geometry::Mesh3f& mesh) {
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
    if (triangles_.empty()) return std::fill(out.begin(), out.end(), std::uint8_t{0});
    accel::parallel_ranges(points.size(), threads, [&](std::size_t begin, std::size_t end) {
      const Side side(tree_);
      for (std::size_t i = begin; i < end; ++i) {
        if (!geometry::is_finite(points[i]))
          throw std::invalid_argument("CGAL has no points that are not finite, such as query " +
                                      std::to_string(i));
        out[i] = side(point(points[i])) != CGAL::ON_UNBOUNDED_SIDE;
      }
    });
  }

 private:
  Triangles triangles_;
  Tree tree_;
};

[[maybe_unused]] const bool registered = Registry<Method>::instance().add(
    {.info = {.name = "cgal_side_of_mesh",
              .family = "bvh",
              .source = Source::peer,
              .claim = Claim::exact,
              .peer_version = CGAL_VERSION_STR,
              .ladder = 70,
              .largest_n = 2'000'000},
     .build = [](const geometry::Mesh3f& mesh, const Knobs&, int) -> std::unique_ptr<Index> {
       return std::make_unique<SideOfMesh>(mesh);
     }});

}  // namespace
}  // namespace treeline::bench::inside
