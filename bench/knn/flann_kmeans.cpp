// FLANN's KMeansIndex: a tree of k-means clusters, searched best cluster first (Muja and Lowe 2009).
//
// Approximate: a search stops after `checks` points. Its documented settings are the branching (32 by
// default), the iterations of each clustering (11 by default) and the checks (32 by default). Centres are
// drawn from std::random_device, which no seed reaches. Made for high dimensions, where planes part little;
// in three a small branching serves better than its default. Its build is the dearest here by far.
#include "bench/core/registry.hpp"
#include "bench/knn/flann_search.hpp"

namespace treeline::bench::knn {
namespace {

[[maybe_unused]] const bool registered = Registry<Method>::instance().add(
    {.info = {.name = "flann_kmeans",
              .family = "kmeans",
              .source = Source::peer,
              .claim = Claim::approximate,
              .peer_version = FLANN_VERSION_,
              .build_knobs = {{{"branching", 8}}, {{"branching", 32}}},
              .query_knobs = {{{"checks", 32}}, {{"checks", 128}}, {{"checks", 512}}},
              .ladder = 21,
              .keeps_no_copy = true,
              .quick_builds = 1,
              .scales = false},
     .build = [](const Input& input, const Knobs& knobs) -> std::unique_ptr<Index> {
       return std::make_unique<FlannApproximate<flann::KMeansIndex<flann::L2_3D<float>>>>(
           input, flann::KMeansIndexParams(knobs.at("branching").get<int>()));
     }});

}  // namespace
}  // namespace treeline::bench::knn
