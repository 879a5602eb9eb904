#include "accel/bsp_tree/spill_points.hpp"

#include "bench/knn/tree_index.hpp"

namespace treeline::bench::knn {
namespace {

using Tree = accel::SpillTree<accel::Points<float, 3>>;

[[maybe_unused]] const bool registered =
    Registry<Method>::instance().add({.info = {.name = "bsp_spill",
                                               .family = "bsp",
                                               .claim = Claim::approximate,
                                               .build_knobs = {{{"leaf_size", 16}, {"tau", 2.0}},
                                                               {{"leaf_size", 16}, {"tau", 1.0}},
                                                               {{"leaf_size", 16}, {"tau", 0.5}}},
                                               .ladder = 13,
                                               .sweep_up_to_n = 100'000,
                                               .scales = false},
                                      .build = [](const Input& input, const Knobs& knobs) {
                                        Tree::Options options;
                                        options.tau = knobs.at("tau").get<double>();
                                        return build_tree<Tree>(input, options, knobs);
                                      }});

}  // namespace
}  // namespace treeline::bench::knn
