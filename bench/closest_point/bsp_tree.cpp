// Our BSP tree. Methods bsp_tree, bsp_tree_double.
#include "accel/bsp_tree.hpp"

#include "bench/closest_point/tree_index.hpp"

namespace treeline::bench::closest_point {
namespace {

const bool registered = register_tree<accel::BspTree, accel::BspTriangleNode>(
    {.name = "bsp_tree",
     .family = "bsp",
     .build_knobs = leaf_size_knobs({8}),
     .ladder = 50,
     .sweep_up_to_n = 500'000,  // at a million triangles one build takes nine to ten seconds
     .largest_n = 3'000'000,
     .quick_largest_n = 50'000});

}  // namespace
}  // namespace treeline::bench::closest_point
