// Our KD tree. Methods kd_tree, kd_tree_fast.
#include "accel/kd_tree.hpp"

#include "bench/ray/tree_index.hpp"

namespace treeline::bench::ray {
namespace {

const bool registered = register_tree<accel::KdTree, sizeof(accel::KdTriangleNode<float>)>(
    {.name = "kd_tree",
     .family = "kd",
     .build_knobs = leaf_size_knobs({8, 4}),
     .ladder = 20,
     .sweep_up_to_n = 500'000,  // at a million triangles one build takes three seconds
     .quick_builds = 1,
     .largest_n = 3'000'000,
     .quick_largest_n = 500'000});

}  // namespace
}  // namespace treeline::bench::ray
