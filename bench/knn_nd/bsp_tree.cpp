// The BSP tree over rows, exact, within (1 + epsilon), and stopped early; and with overlaps, as a spill tree.
#include "accel/bsp_tree/rows.hpp"

#include "bench/knn_nd/rows_index.hpp"

namespace treeline::bench::knn_nd {
namespace {

using Tree = accel::BspTree<accel::Rows<float>>;
using Split = Tree::Options::Split;

std::unique_ptr<Index> build(const Input& input, const Knobs& knobs) {
  Tree::Options options;
  options.split = knobs.at("split") == "random_projection" ? Split::random_projection : Split::principal_axis;
  if (knobs.contains("overlap")) options.overlap = knobs.at("overlap").get<double>();
  return build_rows<Tree>(input, options, knobs);
}

const Knobs principal{{"leaf_size", 32}, {"split", "principal_axis"}};
const Knobs principal_large{{"leaf_size", 64}, {"split", "principal_axis"}};
const Knobs random{{"leaf_size", 32}, {"split", "random_projection"}};
const Knobs spilling{{"leaf_size", 32}, {"split", "principal_axis"}, {"overlap", 0.1}};

[[maybe_unused]] const bool registered[] = {
    Registry<Method>::instance().add({.info = {.name = "bsp_tree",
                                               .family = "bsp",
                                               .build_knobs = {principal, principal_large, random},
                                               .ladder = 15},
                                      .build = build}),
    Registry<Method>::instance().add({.info = {.name = "bsp_tree_eps",
                                               .family = "bsp",
                                               .claim = Claim::bounded,
                                               .build_knobs = {principal},
                                               .query_knobs = {{{"epsilon", 0.2}}, {{"epsilon", 1.0}}},
                                               .ladder = 13},
                                      .build = build}),
    Registry<Method>::instance().add({.info = {.name = "bsp_tree_visits",
                                               .family = "bsp",
                                               .claim = Claim::approximate,
                                               .build_knobs = {principal, random},
                                               .query_knobs = row_limits({64, 128, 256, 512, 1024, 2048}),
                                               .ladder = 11},
                                      .build = build}),
    Registry<Method>::instance().add({.info = {.name = "spill_tree",
                                               .family = "bsp",
                                               .claim = Claim::approximate,
                                               .build_knobs = {spilling},
                                               .query_knobs = row_limits({64, 256, 1024}),
                                               .ladder = 16},
                                      .build = build})};

}  // namespace
}  // namespace treeline::bench::knn_nd
