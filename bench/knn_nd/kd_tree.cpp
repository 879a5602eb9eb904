// The KD tree over rows, exact, within (1 + epsilon), and stopped early.
#include "accel/kd_tree/rows.hpp"

#include "bench/knn_nd/rows_index.hpp"

namespace treeline::bench::knn_nd {
namespace {

using Tree = accel::KdTree<accel::Rows<float>>;

std::unique_ptr<Index> build(const Input& input, const Knobs& knobs) {
  return build_rows<Tree>(input, {}, knobs);
}

[[maybe_unused]] const bool registered[] = {
    Registry<Method>::instance().add({.info = {.name = "kd_tree",
                                               .family = "kd",
                                               .build_knobs = {{{"leaf_size", 32}}, {{"leaf_size", 64}}},
                                               .ladder = 14},
                                      .build = build}),
    Registry<Method>::instance().add({.info = {.name = "kd_tree_eps",
                                               .family = "kd",
                                               .claim = Claim::bounded,
                                               .build_knobs = {{{"leaf_size", 32}}},
                                               .query_knobs = {{{"epsilon", 0.2}}, {{"epsilon", 1.0}}},
                                               .ladder = 12},
                                      .build = build}),
    Registry<Method>::instance().add({.info = {.name = "kd_tree_visits",
                                               .family = "kd",
                                               .claim = Claim::approximate,
                                               .build_knobs = {{{"leaf_size", 32}}},
                                               .query_knobs = row_limits({64, 256, 1024, 2048}),
                                               .ladder = 10},
                                      .build = build})};

}  // namespace
}  // namespace treeline::bench::knn_nd
