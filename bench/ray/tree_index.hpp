// Our trees as ray methods: one adapter for all of them, brute force included.
#pragma once

#include <algorithm>
#include <string>

#include "bench/core/registry.hpp"
#include "bench/ray/method.hpp"

namespace treeline::bench::ray {

/// Nodes and primitives touched per ray.
template <accel::RayIndex Tree>
std::pair<double, double> work_of(const Tree& tree, std::span<const geometry::Rayf> rays, bool any) {
  accel::Work work;
  for (const auto& ray : rays)
    if (any)
      tree.any_hit(ray, work);
    else
      tree.closest_hit(ray, work);
  const double n = static_cast<double>(std::max<std::size_t>(rays.size(), 1));
  return std::pair(static_cast<double>(work.nodes) / n, static_cast<double>(work.primitives) / n);
}

template <accel::RayIndex Tree>
class TreeIndex : public Index {
 public:
  /// node_bytes: of an inner node; 0 where there is none.
  explicit TreeIndex(Tree tree, std::size_t node_bytes = 0)
      : tree_(std::move(tree)), node_bytes_(node_bytes) {}

  void closest(std::span<const geometry::Rayf> rays, std::span<RayAnswer> out, const Knobs&,
               int threads) const override {
    tree_.closest_hit(rays, out, threads);
  }
  void any(std::span<const geometry::Rayf> rays, std::span<std::uint8_t> out, const Knobs&,
           int threads) const override {
    tree_.any_hit(rays, out, threads);
  }
  std::optional<std::pair<double, double>> work(std::span<const geometry::Rayf> rays,
                                                bool any) const override {
    return work_of(tree_, rays, any);
  }
  std::vector<accel::Work> work_of_each(std::span<const geometry::Rayf> rays) const override {
    std::vector<accel::Work> work(rays.size());
    for (std::size_t i = 0; i < rays.size(); ++i) tree_.closest_hit(rays[i], work[i]);
    return work;
  }
  /// Trees that can be refitted offer refit(mesh).
  bool refit(const geometry::Mesh3f& mesh) override {
    if constexpr (requires { tree_.refit(mesh); }) {
      tree_.refit(mesh);
      return true;
    } else {
      return false;
    }
  }
  Knobs facts() const override {
    Knobs out = Knobs::object();
    if (node_bytes_ > 0) out["ray_node_bytes"] = node_bytes_;
    if constexpr (requires { tree_.stats(); }) {
      const accel::TreeStats s = tree_.stats();
      out["ray_references"] = s.references, out["ray_inner_nodes"] = s.inner_nodes;
      out["ray_leaf_count"] = s.leaves, out["ray_depth"] = s.depth;
      if (s.sah_cost > 0) out["ray_sah_cost"] = s.sah_cost;
    }
    return out;
  }
  std::vector<accel::SliceCell> slice(int axis, double offset) const override {
    if constexpr (accel::Inspectable<Tree>)
      return tree_.slice(axis, offset);
    else
      return {};
  }

 protected:
  const Tree& tree() const { return tree_; }

 private:
  Tree tree_;
  std::size_t node_bytes_;
};

/// Builds Tree<Triangles<float, Test>> with the leaf size that the knobs name.
template <template <class> class Tree, class Test, std::size_t node_bytes>
std::unique_ptr<Index> build_tree(const geometry::Mesh3f& mesh, const Knobs& knobs, int threads) {
  using T = Tree<accel::Triangles<float, Test>>;
  typename T::Options options;
  // A user's mesh may hold a broken triangle; dropping it keeps the rest usable.
  options.non_finite = accel::NonFinite::drop;
  if constexpr (requires { options.threads; }) options.threads = threads;
  if (knobs.contains("leaf_size")) options.leaf_size = knobs.at("leaf_size").get<int>();
  return std::make_unique<TreeIndex<T>>(T(mesh, options), node_bytes);
}

/// Registers a tree twice: `name` with the watertight leaf test, and `name`_fast with Möller and Trumbore's
/// at the first of the build knobs.
///
/// The fast test leaks: it computes a shared edge differently for its two triangles (Möller and Trumbore
/// 1997), so rays aimed at edges and vertices slip through a closed mesh, at some vertices every fourth, and
/// t cancels for triangles seen edge-on. Hence its weaker claim.
/// node_bytes: sizeof an inner node, of which the claims ledger speaks.
template <template <class> class Tree, std::size_t node_bytes = 0>
bool register_tree(MethodInfo info) {
  const auto add = [](MethodInfo i, auto test) {
    return Registry<Method>::instance().add(
        {.info = std::move(i), .build = build_tree<Tree, decltype(test), node_bytes>});
  };
  info.claim = Claim::bounded;
  MethodInfo fast = info;
  fast.name += "_fast";
  fast.claim = Claim::approximate;
  fast.build_knobs.resize(1);
  fast.scales = false;  // as the other does
  // Where builds are dear, one is enough.
  fast.largest_n = std::min(fast.largest_n, fast.sweep_up_to_n);
  if (fast.sweep_up_to_n != SIZE_MAX)
    fast.quick_largest_n = std::min<std::size_t>(fast.quick_largest_n, 50'000);
  return add(std::move(info), geometry::Watertight{}) && add(std::move(fast), geometry::MollerTrumbore{});
}

inline std::vector<Knobs> leaf_size_knobs(std::initializer_list<int> leaf_sizes) {
  std::vector<Knobs> all;
  for (const int leaf_size : leaf_sizes) all.push_back(Knobs{{"leaf_size", leaf_size}});
  return all;
}

}  // namespace treeline::bench::ray
