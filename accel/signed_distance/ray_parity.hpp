// Inside or outside by the number of crossings of one ray: odd is inside.
//
// Method: Shimrat 1962, "Algorithm 112: position of point relative to polygon", in space: all crossings of
// one ray are counted, each decided exactly (bvh/wide_crossing.hpp) for the triangles that the tree keeps,
// which in meshes of mixed scale are not quite the user's (first_hit.hpp). A ray that meets an edge, a corner
// or runs in a triangle's plane says nothing, and another direction is tried. Orientation does not matter:
// faces turned around, and meshes inside out, are answered as if they were right. Needs a closed mesh: with
// others, each ray that passes a hole or a doubled face an odd number of times is wrong. Where shells lie in
// one another, every second layer is inside, whichever way they face. Cost: one ray through the whole mesh;
// more than FirstHit by the number of surfaces in its way.
#pragma once

#include "accel/signed_distance/first_hit.hpp"

namespace treeline::accel {

struct RayParity {
  struct Options {};

  template <class Tree>
  class Rule {
    static_assert(ExactCrossings<Tree>, "RayParity needs the wide tree over triangles of float");

   public:
    using Point = typename Tree::Point;
    using Mesh = geometry::Mesh<float>;

    Rule(const Mesh&, const Tree& tree, const Options&, int /*threads*/)
        : box_(tree.bounds()), directions_(box_.empty() ? Point{} : box_.centre()) {}
    static constexpr std::size_t bytes() { return 0; }

    bool inside(const Tree& tree, const Point& q) const {
      if (!box_.contains(q)) return false;
      const wide::Crossings<Tree> crossings(tree);
      CrossingCount count;
      for (int attempt = 0; attempt < ProbeDirections::most; ++attempt) {
        count = crossings.count({q, directions_(q, attempt)});
        if (count.surface || !count.unclear) break;
      }
      return count.surface || (count.inward + count.outward) % 2 == 1;
    }
    void inside(const Tree& tree, std::span<const Point> queries, std::span<std::uint8_t> out,
                int threads) const {
      each_query(queries, threads, [&](std::size_t i) { out[i] = inside(tree, queries[i]) ? 1 : 0; });
    }

   private:
    geometry::Box<float, 3> box_;
    ProbeDirections directions_;
  };
};

}  // namespace treeline::accel
