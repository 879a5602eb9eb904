// Our binary bounding volume hierarchy. Methods bvh, bvh_double.
#include "accel/bvh.hpp"

#include "bench/closest_point/tree_index.hpp"

namespace treeline::bench::closest_point {
namespace {

const bool registered = register_tree<accel::Bvh, accel::BvhNode>({.name = "bvh",
                                                                   .family = "bvh",
                                                                   .build_knobs = leaf_size_knobs({8, 2, 4}),
                                                                   .ladder = 20,
                                                                   .quick_builds = 1});

}  // namespace
}  // namespace treeline::bench::closest_point
