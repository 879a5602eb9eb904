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
class TreeIndex final : public Index {
 public:
  explicit TreeIndex(Tree tree) : tree_(std::move(tree)) {}

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
  std::vector<accel::SliceCell> slice(int axis, double offset) const override {
    if constexpr (accel::Inspectable<Tree>)
      return tree_.slice(axis, offset);
    else
      return {};
  }

 private:
  Tree tree_;
};

/// Builds Tree<Triangles<float, Test>> with the leaf size that the knobs name.
template <template <class> class Tree, class Test>
std::unique_ptr<Index> build_tree(const geometry::Mesh3f& mesh, const Knobs& knobs, int /*threads*/) {
  using T = Tree<accel::Triangles<float, Test>>;
  typename T::Options options;
  // A user's mesh may hold a broken triangle; dropping it keeps the rest usable.
  options.non_finite = accel::NonFinite::drop;
  if (knobs.contains("leaf_size")) options.leaf_size = knobs.at("leaf_size").get<int>();
  return std::make_unique<TreeIndex<T>>(T(mesh, options));
}

/// Registers a tree twice: `name` with the watertight leaf test, and `name`_fast with Möller and Trumbore's
/// at the first of the build knobs.
///
/// The fast test leaks: it computes a shared edge differently for its two triangles (Möller and Trumbore
/// 1997), so rays aimed at edges and vertices slip through a closed mesh, at some vertices every fourth, and
/// t cancels for triangles seen edge-on. Hence its weaker claim.
template <template <class> class Tree>
bool register_tree(MethodInfo info) {
  const auto add = [](MethodInfo i, auto test) {
    return Registry<Method>::instance().add(
        {.info = std::move(i), .build = build_tree<Tree, decltype(test)>});
  };
  info.claim = Claim::bounded;
  MethodInfo fast = info;
  fast.name += "_fast";
  fast.claim = Claim::approximate;
  fast.build_knobs.resize(1);
  fast.largest_n = std::min(fast.largest_n, fast.sweep_up_to_n);  // where builds are dear, one is enough
  return add(std::move(info), geometry::Watertight{}) && add(std::move(fast), geometry::MollerTrumbore{});
}

inline std::vector<Knobs> leaf_size_knobs(std::initializer_list<int> leaf_sizes) {
  std::vector<Knobs> all;
  for (const int leaf_size : leaf_sizes) all.push_back(Knobs{{"leaf_size", leaf_size}});
  return all;
}

}  // namespace treeline::bench::ray
