#include "accel/bsp_tree/points.hpp"

#include "bench/knn/tree_index.hpp"

namespace treeline::bench::knn {
namespace {

using Tree = accel::BspTree<accel::Points<float, 3>>;
using Split = Tree::Options::Split;
using Bounds = Tree::Options::Bounds;

[[maybe_unused]] const bool registered = Registry<Method>::instance().add(
    {.info =
         {.name = "bsp_tree",
          .family = "bsp",
          .build_knobs = {{{"leaf_size", 16}, {"split", "principal_axis"}, {"bounds", "box_and_plane"}},
                          {{"leaf_size", 16}, {"split", "principal_axis"}, {"bounds", "planes"}},
                          {{"leaf_size", 16}, {"split", "random_projection"}, {"bounds", "planes"}},
                          {{"leaf_size", 16}, {"split", "random_projection"}, {"bounds", "box_and_plane"}}},
          .stress_builds = {0, 1},
          .ladder = 12,
          .sweep_up_to_n = 100'000,
          .quick_builds = 2},
     .build = [](const Input& input, const Knobs& knobs) {
       Tree::Options options;
       options.split =
           knobs.at("split") == "random_projection" ? Split::random_projection : Split::principal_axis;
       options.bounds = knobs.at("bounds") == "box_and_plane" ? Bounds::box_and_plane : Bounds::planes;
       return build_tree<Tree>(input, options, knobs);
     }});

}  // namespace
}  // namespace treeline::bench::knn
