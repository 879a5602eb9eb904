// Inside or outside by the winding number: more than one half is inside.
//
// For broken meshes: holes, missing and doubled faces, shells that face the same way, soups of triangles.
// Where the surface is whole the number is a whole one, and the sign is right whatever the approximation, but
// for points nearer to an edge, in lengths of its face, than a hundred millionth; where it is not, the border
// runs across the gap about as a soap film would. Sources and cost: winding_tree.hpp. Known weakness: needs
// most faces to be oriented; a mesh inside out has no inside at all. Points on a face are inside.
#pragma once

#include "accel/signed_distance/each_query.hpp"
#include "accel/signed_distance/winding_tree.hpp"

namespace treeline::accel {

struct Winding {
  struct Options {
    /// From how many radii on a group of faces counts by its moments: at least 1; infinite for the exact sum,
    /// which looks at every face.
    double reach = 2;
  };

  template <class Tree>
  class Rule {
   public:
    using T = typename Tree::Scalar;
    using Point = typename Tree::Point;
    using Mesh = geometry::Mesh<T>;

    Rule(const Mesh& mesh, const Tree&, const Options& options, int threads)
        : winding_(mesh, options.reach, threads, NonFinite::drop) {}  // as the tree has, or it had thrown
    std::size_t bytes() const { return winding_.bytes(); }
    const WindingTree<T>& winding() const { return winding_; }

    bool inside(const Tree&, const Point& q) const {
      const WindingNumber w = winding_(q);
      return w.on_surface || w.value > 0.5;
    }
    void inside(const Tree& tree, std::span<const Point> queries, std::span<std::uint8_t> out,
                int threads) const {
      each_query(queries, threads, [&](std::size_t i) { out[i] = inside(tree, queries[i]) ? 1 : 0; });
    }

   private:
    WindingTree<T> winding_;
  };
};

}  // namespace treeline::accel
