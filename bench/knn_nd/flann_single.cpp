// FLANN's KDTreeSingleIndex: one exact KD-tree, meant for low dimensions; reordered copy, leaves of 10, as by
// default, or 30.
#include "bench/knn_nd/flann_index.hpp"

namespace treeline::bench::knn_nd {
namespace {

[[maybe_unused]] const bool registered = Registry<Method>::instance().add(
    {.info = {.name = "flann_single",
              .family = "kd",
              .source = Source::peer,
              .peer_version = FLANN_VERSION_,
              .build_knobs = {{{"leaf_size", 10}}, {{"leaf_size", 30}}},
              .ladder = 31},
     .build = [](const Input& input, const Knobs& knobs) -> std::unique_ptr<Index> {
       return std::make_unique<FlannRows<flann::KDTreeSingleIndex<flann::L2<float>>>>(
           input, flann::KDTreeSingleIndexParams(knobs.at("leaf_size").get<int>()));
     }});

}  // namespace
}  // namespace treeline::bench::knn_nd
