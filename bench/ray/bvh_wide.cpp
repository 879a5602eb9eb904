// Our wide bounding volume hierarchy, watertight. The knob builder: what makes the binary tree that is folded
// into wide nodes. The knobs width and leaf: children of a node and triangles of a leaf, 8 and 8 where they
// are not named.
#include "accel/bvh/build_ploc.hpp"
#include "accel/bvh/build_spatial.hpp"
#include "accel/bvh/build_sweep.hpp"
#include "accel/bvh/reinsertion.hpp"

#include "bench/ray/wide_index.hpp"

namespace treeline::bench::ray {

accel::BinaryTree build_binary(const std::string& builder,
                               std::span<const geometry::Triangle<float>> triangles,
                               const accel::BinaryBuildOptions& options) {
  if (builder == "sweep") return accel::build_sweep(triangles, options);
  if (builder == "spatial") return accel::build_spatial(triangles, {options});
  if (builder == "ploc") return accel::build_ploc(triangles, {options});
  if (builder == "reinsertion") {
    accel::BinaryTree tree = accel::build_binned(triangles, options);
    accel::reinsert(tree, {.threads = options.threads});
    return tree;
  }
  return accel::build_binned(triangles, options);
}

namespace {

std::unique_ptr<Index> build(const geometry::Mesh3f& mesh, const Knobs& knobs, int threads) {
  const int width = knobs.value("width", 8), leaf = knobs.value("leaf", 8);
  WideBuild* const builds[3][2] = {{build_wide_4_4, build_wide_4_8},
                                   {build_wide_8_4, build_wide<geometry::Watertight, accel::Wide>},
                                   {build_wide_16_4, build_wide_16_8}};
  return builds[width / 8][leaf / 8](mesh, knobs, threads);
}

std::vector<Knobs> builds() {
  std::vector<Knobs> all;
  const auto sized = [&](const char* builder, int width, int leaf) {
    all.push_back(Knobs{{"builder", builder}, {"width", width}, {"leaf", leaf}});
  };
  for (const char* builder : {"binned", "spatial"}) all.push_back(Knobs{{"builder", builder}});
  sized("binned", 16, 8), sized("spatial", 16, 8);
  for (const char* builder : {"sweep", "ploc", "reinsertion"}) all.push_back(Knobs{{"builder", builder}});
  sized("binned", 16, 4), sized("binned", 8, 4), sized("binned", 4, 8), sized("binned", 4, 4);
  return all;
}

[[maybe_unused]] const bool registered =
    Registry<Method>::instance().add({.info = {.name = "bvh_wide",
                                               .family = "bvh",
                                               .claim = Claim::bounded,
                                               .build_knobs = builds(),
                                               .query_knobs = wide_batches(),
                                               // Every builder, and every width.
                                               .stress_builds = {0, 1, 2, 4, 5, 6, 9},
                                               .ladder = 11,
                                               .quick_builds = 3},
                                      .build = build});

}  // namespace
}  // namespace treeline::bench::ray
