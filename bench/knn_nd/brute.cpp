#include "accel/brute_force/rows.hpp"

#include "bench/knn_nd/rows_index.hpp"

namespace treeline::bench::knn_nd {
namespace {

using Tree = accel::BruteForce<accel::Rows<float>>;

[[maybe_unused]] const bool registered = Registry<Method>::instance().add(
    {.info = {.name = "brute", .family = "brute", .ladder = 0},
     .build = [](const Input& input, const Knobs& knobs) { return build_rows<Tree>(input, {}, knobs); }});

}  // namespace
}  // namespace treeline::bench::knn_nd
