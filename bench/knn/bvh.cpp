#include "accel/bvh/points.hpp"

#include "bench/knn/tree_index.hpp"

namespace treeline::bench::knn {
namespace {

using Tree = accel::Bvh<accel::Points<float, 3>>;
using Split = Tree::Options::Split;

[[maybe_unused]] const bool registered =
    Registry<Method>::instance().add({.info = {.name = "bvh",
                                               .family = "bvh",
                                               .build_knobs = {{{"leaf_size", 8}, {"split", "rank"}},
                                                               {{"leaf_size", 16}, {"split", "rank"}},
                                                               {{"leaf_size", 16}, {"split", "sah"}}},
                                               .ladder = 11},
                                      .build = [](const Input& input, const Knobs& knobs) {
                                        Tree::Options options;
                                        options.split = knobs.at("split") == "sah" ? Split::sah : Split::rank;
                                        return build_tree<Tree>(input, options, knobs);
                                      }});

}  // namespace
}  // namespace treeline::bench::knn
