#include "accel/bvh/wide_points.hpp"

#include "bench/knn/tree_index.hpp"

namespace treeline::bench::knn {
namespace {

using Tree = accel::Bvh<accel::Points<float, 3>, accel::Wide>;

[[maybe_unused]] const bool registered =
    Registry<Method>::instance().add({.info = {.name = "bvh_wide", .family = "bvh", .ladder = 12},
                                      .build = [](const Input& input, const Knobs& knobs) {
                                        Tree::Options options;
                                        options.threads = input.threads;
                                        return build_tree<Tree>(input, options, knobs);
                                      }});

}  // namespace
}  // namespace treeline::bench::knn
