// Forests over rows: randomised KD trees, and random projections, both stopped early.
#include "accel/forest/rows.hpp"

#include "bench/knn_nd/rows_index.hpp"

namespace treeline::bench::knn_nd {
namespace {

using Tree = accel::Forest<accel::Rows<float>>;
using Split = Tree::Options::Split;

template <Split split>
std::unique_ptr<Index> build(const Input& input, const Knobs& knobs) {
  Tree::Options options;
  options.split = split, options.trees = knobs.at("trees").get<int>();
  return build_rows<Tree>(input, options, knobs);
}

[[maybe_unused]] const bool registered[] = {
    Registry<Method>::instance().add({.info = {.name = "kd_forest",
                                               .family = "forest",
                                               .claim = Claim::approximate,
                                               .build_knobs = {{{"trees", 4}, {"leaf_size", 8}}},
                                               .query_knobs = row_limits({64, 256, 1024}),
                                               .ladder = 20},
                                      .build = build<Split::random_axis>}),
    Registry<Method>::instance().add({.info = {.name = "rp_forest",
                                               .family = "forest",
                                               .claim = Claim::approximate,
                                               .build_knobs = {{{"trees", 4}, {"leaf_size", 8}}},
                                               .query_knobs = row_limits({64, 256, 1024}),
                                               .ladder = 21},
                                      .build = build<Split::random_projection>})};

}  // namespace
}  // namespace treeline::bench::knn_nd
