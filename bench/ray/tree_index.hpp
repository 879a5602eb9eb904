// Our trees as ray methods: one adapter for all of them, brute force included.
#pragma once

#include <string>

#include "bench/core/registry.hpp"
#include "bench/ray/method.hpp"

namespace treeline::bench::ray {

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
    accel::Work work;
    for (const auto& ray : rays)
      if (any)
        tree_.any_hit(ray, work);
      else
        tree_.closest_hit(ray, work);
    const double n = static_cast<double>(std::max<std::size_t>(rays.size(), 1));
    return std::pair(static_cast<double>(work.nodes) / n, static_cast<double>(work.primitives) / n);
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

/// Builds Tree<Triangles<float, Test>> with the leaf test and the leaf size that the knobs name.
template <template <class> class Tree>
std::unique_ptr<Index> build_tree(const geometry::Mesh3f& mesh, const Knobs& knobs, int /*threads*/) {
  const auto with_test = [&]<class Test>(Test) -> std::unique_ptr<Index> {
    using T = Tree<accel::Triangles<float, Test>>;
    typename T::Options options;
    // A user's mesh may hold a broken triangle; dropping it keeps the rest usable.
    options.non_finite = accel::NonFinite::drop;
    if (knobs.contains("leaf_size")) options.leaf_size = knobs.at("leaf_size").template get<int>();
    return std::make_unique<TreeIndex<T>>(T(mesh, options));
  };
  const std::string test = knobs.at("test").get<std::string>();
  if (test == "watertight") return with_test(geometry::Watertight{});
  if (test == "moller_trumbore") return with_test(geometry::MollerTrumbore{});
  throw std::invalid_argument("knob test is '" + test + "'; it must be watertight or moller_trumbore");
}

/// {test, leaf_size} of a tree: both tests at the default leaf size, the other sizes with the watertight one.
inline std::vector<Knobs> tree_knobs(std::initializer_list<int> leaf_sizes) {
  std::vector<Knobs> all;
  for (const int leaf_size : leaf_sizes)
    all.push_back(Knobs{{"test", "watertight"}, {"leaf_size", leaf_size}});
  all.push_back(Knobs{{"test", "moller_trumbore"}, {"leaf_size", *leaf_sizes.begin()}});
  return all;
}

}  // namespace treeline::bench::ray
