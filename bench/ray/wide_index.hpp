// Our wide bounding volume hierarchies as ray methods: what their files share. Each layout is compiled in a
// file of its own.
#pragma once

#include "accel/bvh/wide_triangles.hpp"
#include "bench/ray/tree_index.hpp"

namespace treeline::bench::ray {

/// The knob batch: streams, several rays in flight; singly, one after the other; or packets, neighbours
/// together.
template <class Tree>
class WideIndex final : public TreeIndex<Tree> {
 public:
  using TreeIndex<Tree>::TreeIndex;

  void closest(std::span<const geometry::Rayf> rays, std::span<RayAnswer> out, const Knobs& knobs,
               int threads) const override {
    this->tree().closest_hit(rays, out, threads, batch(knobs));
  }
  void any(std::span<const geometry::Rayf> rays, std::span<std::uint8_t> out, const Knobs& knobs,
           int threads) const override {
    this->tree().any_hit(rays, out, threads, batch(knobs));
  }

 private:
  static accel::RayBatch batch(const Knobs& knobs) {
    if (!knobs.contains("batch")) return accel::RayBatch::automatic;
    const auto& name = knobs.at("batch");
    return name == "singly"    ? accel::RayBatch::singly
           : name == "packets" ? accel::RayBatch::packets
                               : accel::RayBatch::streams;
  }
};

inline std::vector<Knobs> wide_batches() {
  return {{{"batch", "streams"}}, {{"batch", "singly"}}, {{"batch", "packets"}}};
}

/// By the builder that the knob of that name names: binned, sweep, spatial, ploc or reinsertion.
accel::BinaryTree build_binary(const std::string& builder,
                               std::span<const geometry::Triangle<float>> triangles,
                               const accel::BinaryBuildOptions& options);

template <class Policy, class Layout>
std::unique_ptr<Index> build_wide(const geometry::Mesh3f& mesh, const Knobs& knobs, int threads) {
  using Tree = accel::Bvh<accel::Triangles<float, Policy>, Layout>;
  const auto builder = knobs.at("builder").get<std::string>();
  const auto binary = [&](std::span<const geometry::Triangle<float>> triangles,
                          const accel::BinaryBuildOptions& options) {
    return build_binary(builder, triangles, options);
  };
  return std::make_unique<WideIndex<Tree>>(
      Tree(mesh, {.non_finite = accel::NonFinite::drop, .threads = threads}, binary));
}

using WideBuild = std::unique_ptr<Index>(const geometry::Mesh3f& mesh, const Knobs& knobs, int threads);
/// With other numbers of children a node and triangles a leaf.
WideBuild build_wide_4_4, build_wide_4_8, build_wide_8_4, build_wide_16_4, build_wide_16_8;

}  // namespace treeline::bench::ray
