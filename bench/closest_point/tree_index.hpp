// Our trees as methods: one adapter for all of them, brute force included.
#pragma once

#include <algorithm>
#include <string>

#include "bench/closest_point/method.hpp"
#include "bench/core/registry.hpp"

namespace treeline::bench::closest_point {

/// The batch in the scalar of the tree.
template <class T>
std::span<const geometry::Vec<T, 3>> points_of(const Queries& queries) {
  if constexpr (std::is_same_v<T, float>)
    return queries.floats;
  else
    return queries.doubles;
}

template <accel::ClosestPointIndex Tree>
class TreeIndex : public Index {
 public:
  using Scalar = typename Tree::Scalar;

  /// node_bytes: of an inner node; 0 where there is none.
  explicit TreeIndex(Tree tree, std::size_t node_bytes = 0)
      : tree_(std::move(tree)), node_bytes_(node_bytes) {}

  void closest(const Queries& queries, Answers& out, const Knobs&, int threads) const override {
    tree_.closest_point(points_of<Scalar>(queries), infinity, out.template fill<Scalar>(queries.size()),
                        threads);
  }
  std::optional<std::pair<double, double>> work(const Queries& queries) const override {
    double nodes = 0, primitives = 0;
    for (const accel::Work& w : work_of_each(queries))
      nodes += static_cast<double>(w.nodes), primitives += static_cast<double>(w.primitives);
    const double n = static_cast<double>(std::max<std::size_t>(queries.size(), 1));
    return std::pair(nodes / n, primitives / n);
  }
  std::vector<accel::Work> work_of_each(const Queries& queries) const override {
    std::vector<accel::Work> work(queries.size());
    const auto points = points_of<Scalar>(queries);
    for (std::size_t i = 0; i < work.size(); ++i) tree_.closest_point(points[i], infinity, work[i]);
    return work;
  }
  Knobs facts() const override {
    Knobs out = Knobs::object();
    if (node_bytes_ > 0) out["closest_point_node_bytes"] = node_bytes_;
    if constexpr (requires { tree_.stats(); }) {
      const accel::TreeStats s = tree_.stats();
      out["closest_point_references"] = s.references, out["closest_point_inner_nodes"] = s.inner_nodes;
      out["closest_point_leaf_count"] = s.leaves, out["closest_point_depth"] = s.depth;
    }
    return out;
  }

 protected:
  static constexpr Scalar infinity = std::numeric_limits<Scalar>::infinity();
  const Tree& tree() const { return tree_; }

 private:
  Tree tree_;
  std::size_t node_bytes_;
};

inline std::vector<geometry::Triangle3d> triangles_in_double(const geometry::Mesh3f& mesh) {
  std::vector<geometry::Triangle3d> out;
  out.reserve(mesh.size());
  for (std::size_t f = 0; f < mesh.size(); ++f) out.emplace_back(mesh.triangle(f));
  return out;
}

/// Builds Tree<Triangles<T>> with the leaf size that the knobs name.
template <template <class> class Tree, class T, template <class> class Node>
std::unique_ptr<Index> build_tree(const geometry::Mesh3f& mesh, const Knobs& knobs, int threads) {
  using Of = Tree<accel::Triangles<T>>;
  typename Of::Options options;
  // A user's mesh may hold a broken triangle; dropping it keeps the rest usable.
  options.non_finite = accel::NonFinite::drop;
  if constexpr (requires { options.threads; }) options.threads = threads;
  if (knobs.contains("leaf_size")) options.leaf_size = knobs.at("leaf_size").get<int>();
  std::size_t node_bytes = 0;
  if constexpr (!std::is_void_v<Node<T>>) node_bytes = sizeof(Node<T>);
  if constexpr (std::is_same_v<T, float>)
    return std::make_unique<TreeIndex<Of>>(Of(mesh, options), node_bytes);
  else
    return std::make_unique<TreeIndex<Of>>(Of(triangles_in_double(mesh), options), node_bytes);
}

template <class>
using NoNode = void;

/// Registers a tree twice: `name` in float, and `name`_double at the first of the build knobs, whose answers
/// are off by the rounding of double only.
/// Node: of an inner node, whose size the claims ledger speaks of.
template <template <class> class Tree, template <class> class Node = NoNode>
bool register_tree(MethodInfo info) {
  info.claim = Claim::bounded;
  MethodInfo in_double = info;
  in_double.name += "_double";
  in_double.build_knobs.resize(1);
  in_double.scales = false;                                                      // as the other does
  in_double.largest_n = std::min(in_double.largest_n, in_double.sweep_up_to_n);  // where builds are dear
  if (in_double.quick_largest_n < SIZE_MAX)
    in_double.quick_largest_n = 20'000;  // the same, where time is short
  in_double.ladder += 1;
  Registry<Method>& registry = Registry<Method>::instance();
  return registry.add({.info = std::move(info), .build = build_tree<Tree, float, Node>}) &&
         registry.add({.info = std::move(in_double),
                       .build = build_tree<Tree, double, Node>,
                       .roundoff = geometry::tolerance::unit_roundoff<double>});
}

inline std::vector<Knobs> leaf_size_knobs(std::initializer_list<int> leaf_sizes) {
  std::vector<Knobs> all;
  for (const int leaf_size : leaf_sizes) all.push_back(Knobs{{"leaf_size", leaf_size}});
  return all;
}

}  // namespace treeline::bench::closest_point
