// FLANN's KDTreeIndex: a forest of randomised KD-trees searched together, best bin first (Muja and Lowe
// 2009), which its manual recommends for high dimension. Documented settings: the number of trees (4 by
// default) and the checks (32 by default). Trees differ from run to run: they are drawn from
// std::random_device.
#include "bench/knn_nd/flann_index.hpp"

namespace treeline::bench::knn_nd {
namespace {

[[maybe_unused]] const bool registered = Registry<Method>::instance().add(
    {.info = {.name = "flann_forest",
              .family = "forest",
              .source = Source::peer,
              .claim = Claim::approximate,
              .peer_version = FLANN_VERSION_,
              .build_knobs = {{{"trees", 4}}, {{"trees", 8}}, {{"trees", 16}}},
              .query_knobs = checks_to(512),
              .ladder = 32,
              .keeps_no_copy = true},
     .build = [](const Input& input, const Knobs& knobs) -> std::unique_ptr<Index> {
       return std::make_unique<FlannRows<flann::KDTreeIndex<flann::L2<float>>>>(
           input, flann::KDTreeIndexParams(knobs.at("trees").get<int>()));
     }});

}  // namespace
}  // namespace treeline::bench::knn_nd
