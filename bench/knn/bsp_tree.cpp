#include "accel/bsp_tree/points.hpp"

#include "bench/knn/tree_index.hpp"

namespace treeline::bench::knn {
namespace {

using Tree = accel::BspTree<accel::Points<float, 3>>;
using Split = Tree::Options::Split;

[[maybe_unused]] const bool registered = Registry<Method>::instance().add(
    {.info = {.name = "bsp_tree",
              .family = "bsp",
              .build_knobs = {{{"leaf_size", 8}, {"split", "principal_axis"}},
                              {{"leaf_size", 16}, {"split", "principal_axis"}},
                              {{"leaf_size", 16}, {"split", "random_projection"}}},
              .ladder = 12,
              .quick_builds = 2},
     .build = [](const Input& input, const Knobs& knobs) {
       Tree::Options options;
       options.split =
           knobs.at("split") == "random_projection" ? Split::random_projection : Split::principal_axis;
       return build_tree<Tree>(input, options, knobs);
     }});

}  // namespace
}  // namespace treeline::bench::knn
