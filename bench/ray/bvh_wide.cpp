// Our wide bounding volume hierarchy, two ways: watertight and exact. The knob batch: streams,
// several rays in flight, or singly, one after the other. The knob builder: what makes the binary tree that
// is folded into wide nodes.
#include "accel/bvh/build_ploc.hpp"
#include "accel/bvh/build_spatial.hpp"
#include "accel/bvh/build_sweep.hpp"
#include "accel/bvh/reinsertion.hpp"
#include "accel/bvh/wide_triangles.hpp"

#include "bench/ray/tree_index.hpp"

namespace treeline::bench::ray {
namespace {

template <class Tree>
class WideIndex final : public Index {
 public:
  explicit WideIndex(Tree tree) : tree_(std::move(tree)) {}

  void closest(std::span<const geometry::Rayf> rays, std::span<RayAnswer> out, const Knobs& knobs,
               int threads) const override {
    tree_.closest_hit(rays, out, threads, batch(knobs));
  }
  void any(std::span<const geometry::Rayf> rays, std::span<std::uint8_t> out, const Knobs& knobs,
           int threads) const override {
    tree_.any_hit(rays, out, threads, batch(knobs));
  }
  std::optional<std::pair<double, double>> work(std::span<const geometry::Rayf> rays,
                                                bool any) const override {
    return work_of(tree_, rays, any);
  }
  std::vector<accel::SliceCell> slice(int axis, double offset) const override {
    return tree_.slice(axis, offset);
  }

 private:
  static accel::RayBatch batch(const Knobs& knobs) {
    if (!knobs.contains("batch")) return accel::RayBatch::automatic;
    return knobs.at("batch") == "singly" ? accel::RayBatch::singly : accel::RayBatch::streams;
  }

  Tree tree_;
};

using accel::BinaryBuildOptions;
using accel::BinaryTree;
using Triangles = std::span<const geometry::Triangle<float>>;

BinaryTree build_binary(const std::string& builder, Triangles triangles, const BinaryBuildOptions& options) {
  if (builder == "sweep") return accel::build_sweep(triangles, options);
  if (builder == "spatial") return accel::build_spatial(triangles, {options});
  if (builder == "ploc") return accel::build_ploc(triangles, {options});
  if (builder == "reinsertion") {
    BinaryTree tree = accel::build_binned(triangles, options);
    accel::reinsert(tree, {.threads = options.threads});
    return tree;
  }
  return accel::build_binned(triangles, options);
}

template <class Policy>
std::unique_ptr<Index> build(const geometry::Mesh3f& mesh, const Knobs& knobs, int threads) {
  using Tree = accel::Bvh<accel::Triangles<float, Policy>, accel::Wide>;
  const auto builder = knobs.at("builder").get<std::string>();
  const auto binary = [&](Triangles triangles, const BinaryBuildOptions& options) {
    return build_binary(builder, triangles, options);
  };
  return std::make_unique<WideIndex<Tree>>(
      Tree(mesh, {.non_finite = accel::NonFinite::drop, .threads = threads}, binary));
}

std::vector<Knobs> builders(std::initializer_list<const char*> names) {
  std::vector<Knobs> all;
  for (const char* name : names) all.push_back(Knobs{{"builder", name}});
  return all;
}

template <class Policy>
bool add(const char* name, Claim claim, int ladder, std::vector<Knobs> build_knobs) {
  return Registry<Method>::instance().add(
      {.info = {.name = name,
                .family = "bvh",
                .claim = claim,
                .build_knobs = std::move(build_knobs),
                .query_knobs = {{{"batch", "streams"}}, {{"batch", "singly"}}},
                .ladder = ladder,
                .quick_builds = 2},
       .build = build<Policy>});
}

[[maybe_unused]] const bool registered =
    add<geometry::Watertight>("bvh_wide", Claim::bounded, 11,
                              builders({"binned", "spatial", "sweep", "ploc", "reinsertion"})) &&
    add<geometry::Exact>("bvh_wide_exact", Claim::exact, 12, builders({"binned"}));

}  // namespace
}  // namespace treeline::bench::ray
