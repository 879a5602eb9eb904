// FLANN's KMeansIndex: hierarchical k-means, its other recommendation for high dimension (Muja and Lowe
// 2009). Documented settings: branching (32 by default; 16 was as fast or faster in most cells measured), 11
// iterations, random centres, cluster boundary index 0.2, and the checks.
#include "bench/knn_nd/flann_index.hpp"

namespace treeline::bench::knn_nd {
namespace {

[[maybe_unused]] const bool registered = Registry<Method>::instance().add(
    {.info = {.name = "flann_kmeans",
              .family = "kmeans",
              .source = Source::peer,
              .claim = Claim::approximate,
              .peer_version = FLANN_VERSION_,
              .build_knobs = {{{"branching", 32}}, {{"branching", 16}}},
              .query_knobs = checks_to(2048),
              .ladder = 33,
              .keeps_no_copy = true},
     .build = [](const Input& input, const Knobs& knobs) -> std::unique_ptr<Index> {
       return std::make_unique<FlannRows<flann::KMeansIndex<flann::L2<float>>>>(
           input, flann::KMeansIndexParams(knobs.at("branching").get<int>()));
     }});

}  // namespace
}  // namespace treeline::bench::knn_nd
