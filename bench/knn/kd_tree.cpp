#include "accel/kd_tree/points.hpp"

#include "bench/knn/tree_index.hpp"

namespace treeline::bench::knn {
namespace {

using Tree = accel::KdTree<accel::Points<float, 3>>;
using Split = Tree::Options::Split;

[[maybe_unused]] const bool registered = Registry<Method>::instance().add(
    {.info = {.name = "kd_tree",
              .family = "kd",
              .build_knobs = {{{"leaf_size", 8}, {"split", "sliding_midpoint"}},
                              {{"leaf_size", 16}, {"split", "sliding_midpoint"}},
                              {{"leaf_size", 16}, {"split", "median"}}},
              .ladder = 10},
     .build = [](const Input& input, const Knobs& knobs) {
       Tree::Options options;
       options.split = knobs.at("split") == "median" ? Split::median : Split::sliding_midpoint;
       return build_tree<Tree>(input, options, knobs);
     }});

}  // namespace
}  // namespace treeline::bench::knn
