#include "accel/kd_tree/points.hpp"

#include "bench/knn/tree_index.hpp"

namespace treeline::bench::knn {
namespace {

template <class T>
std::unique_ptr<IndexOf<T>> build(const InputOf<T>& input, const Knobs& knobs) {
  using Tree = accel::KdTree<accel::Points<T, 3>>;
  using Split = typename Tree::Options::Split;
  using Bounds = typename Tree::Options::Bounds;
  typename Tree::Options options;
  options.split = knobs.at("split") == "median" ? Split::median : Split::sliding_midpoint;
  options.bounds = knobs.at("bounds") == "tight_box" ? Bounds::tight_box : Bounds::planes;
  return build_tree<Tree>(input, options, knobs);
}

[[maybe_unused]] const bool registered = Registry<Method>::instance().add(
    {.info = {.name = "kd_tree",
              .family = "kd",
              .build_knobs = {{{"leaf_size", 16}, {"split", "sliding_midpoint"}, {"bounds", "tight_box"}},
                              {{"leaf_size", 16}, {"split", "sliding_midpoint"}, {"bounds", "planes"}},
                              {{"leaf_size", 16}, {"split", "median"}, {"bounds", "planes"}},
                              {{"leaf_size", 16}, {"split", "median"}, {"bounds", "tight_box"}}},
              .stress_builds = {0, 1},
              .ladder = 10,
              .sweep_up_to_n = 1'000'000,
              .quick_builds = 2},
     .build = build<float>});
[[maybe_unused]] const bool registered_double = Registry<Method>::instance().add(
    {.info = {.name = "kd_tree_double",
              .family = "kd",
              .build_knobs = {{{"leaf_size", 16}, {"split", "sliding_midpoint"}, {"bounds", "tight_box"}},
                              {{"leaf_size", 16}, {"split", "sliding_midpoint"}, {"bounds", "planes"}}},
              .ladder = 20,
              .scales = false},
     .build_double = build<double>});

}  // namespace
}  // namespace treeline::bench::knn
