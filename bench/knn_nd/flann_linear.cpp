// FLANN's LinearIndex: its brute force.
#include "bench/knn_nd/flann_index.hpp"

namespace treeline::bench::knn_nd {
namespace {

[[maybe_unused]] const bool registered = Registry<Method>::instance().add(
    {.info = {.name = "flann_linear",
              .family = "brute",
              .source = Source::peer,
              .peer_version = FLANN_VERSION_,
              .ladder = 30,
              .keeps_no_copy = true},
     .build = [](const Input& input, const Knobs&) -> std::unique_ptr<Index> {
       return std::make_unique<FlannRows<flann::LinearIndex<flann::L2<float>>>>(input,
                                                                                flann::LinearIndexParams());
     }});

}  // namespace
}  // namespace treeline::bench::knn_nd
