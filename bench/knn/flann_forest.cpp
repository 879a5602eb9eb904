// FLANN's KDTreeIndex: a forest of randomised KD-trees searched together, best bin first (Muja and Lowe
// 2009).
//
// Approximate: a search stops after `checks` points. Its documented settings are the number of trees (4 by
// default) and the checks (32 by default). Trees differ from run to run: FLANN draws them from
// std::random_device, which no seed reaches. Made for high dimensions; in three it shows what approximation
// costs and buys.
#include "bench/core/registry.hpp"
#include "bench/knn/flann_search.hpp"

namespace treeline::bench::knn {
namespace {

[[maybe_unused]] const bool registered = Registry<Method>::instance().add(
    {.info = {.name = "flann_forest",
              .family = "forest",
              .source = Source::peer,
              .claim = Claim::approximate,
              .peer_version = FLANN_VERSION_,
              .build_knobs = {{{"trees", 4}}, {{"trees", 8}}},
              .query_knobs = {{{"checks", 32}}, {{"checks", 128}}, {{"checks", 512}}},
              .ladder = 20,
              .keeps_no_copy = true,
              .quick_builds = 1,
              .scales = false},
     .build = [](const Input& input, const Knobs& knobs) -> std::unique_ptr<Index> {
       return std::make_unique<FlannApproximate<flann::KDTreeIndex<flann::L2_3D<float>>>>(
           input, flann::KDTreeIndexParams(knobs.at("trees").get<int>()));
     }});

}  // namespace
}  // namespace treeline::bench::knn
