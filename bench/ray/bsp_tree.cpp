// Our BSP tree. Methods bsp_tree, bsp_tree_fast.
#include "accel/bsp_tree.hpp"

#include "bench/ray/tree_index.hpp"

namespace treeline::bench::ray {
namespace {

const bool registered = register_tree<accel::BspTree, sizeof(accel::BspTriangleNode<float>)>(
    {.name = "bsp_tree",
     .family = "bsp",
     .build_knobs = leaf_size_knobs({8}),
     .ladder = 30,
     .sweep_up_to_n = 500'000,  // at a million triangles one build takes nine to ten seconds
     .largest_n = 3'000'000,
     .quick_largest_n = 500'000});

}  // namespace
}  // namespace treeline::bench::ray
