// Our bounding volume hierarchy. Methods bvh, bvh_fast.
#include "accel/bvh.hpp"

#include "bench/ray/tree_index.hpp"

namespace treeline::bench::ray {
namespace {

const bool registered =
    register_tree<accel::Bvh, sizeof(accel::BvhNode<float>)>({.name = "bvh",
                                                              .family = "bvh",
                                                              .build_knobs = leaf_size_knobs({8, 2, 4}),
                                                              .ladder = 10,
                                                              .quick_builds = 1});

}  // namespace
}  // namespace treeline::bench::ray
