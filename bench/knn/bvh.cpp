#include "accel/bvh/points.hpp"

#include "bench/knn/tree_index.hpp"

namespace treeline::bench::knn {
namespace {

using Tree = accel::Bvh<accel::Points<float, 3>>;
using Split = Tree::Options::Split;
using Bounds = Tree::Options::Bounds;

[[maybe_unused]] const bool registered = Registry<Method>::instance().add(
    {.info = {.name = "bvh",
              .family = "bvh",
              .build_knobs = {{{"leaf_size", 16}, {"split", "rank"}, {"bounds", "box"}},
                              {{"leaf_size", 16}, {"split", "sah"}, {"bounds", "box"}},
                              {{"leaf_size", 16}, {"split", "rank"}, {"bounds", "ball"}},
                              {{"leaf_size", 16}, {"split", "sah"}, {"bounds", "ball"}}},
              .stress_builds = {0, 2},
              .ladder = 11,
              .sweep_up_to_n = 1'000'000,
              .quick_builds = 2},
     .build = [](const Input& input, const Knobs& knobs) {
       Tree::Options options;
       options.split = knobs.at("split") == "sah" ? Split::sah : Split::rank;
       options.bounds = knobs.at("bounds") == "ball" ? Bounds::ball : Bounds::box;
       return build_tree<Tree>(input, options, knobs);
     }});

}  // namespace
}  // namespace treeline::bench::knn
