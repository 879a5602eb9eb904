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

class FlannKmeans final : public Index {
 public:
  FlannKmeans(const Input& input, const Knobs& knobs)
      : index_(flann_matrix(input.points), flann::KMeansIndexParams(knobs.at("branching").get<int>())) {
    index_.buildIndex();
  }

  void nearest(std::span<const Vec3f> queries, std::size_t k, const Knobs& knobs, int threads,
               std::span<Id> ids) const override {
    flann_nearest(index_, queries, k, flann::SearchParams(knobs.at("checks").get<int>()), threads, ids);
  }
  void within(std::span<const Vec3f> queries, float radius, const Knobs& knobs, int threads,
              Lists<Id>& lists) const override {
    flann_within(index_, queries, radius, flann::SearchParams(knobs.at("checks").get<int>()), threads, lists);
  }

 private:
  flann::KMeansIndex<flann::L2_3D<float>> index_;
};

[[maybe_unused]] const bool registered = Registry<Method>::instance().add(
    {.info = {.name = "flann_kmeans",
              .family = "kmeans",
              .source = Source::peer,
              .claim = Claim::approximate,
              .peer_version = FLANN_VERSION_,
              .build_knobs = {{{"branching", 8}}, {{"branching", 32}}},
              .query_knobs = {{{"checks", 32}}, {{"checks", 128}}, {{"checks", 512}}},
              .ladder = 21,
              .quick_builds = 1},
     .build = [](const Input& input, const Knobs& knobs) -> std::unique_ptr<Index> {
       return std::make_unique<FlannKmeans>(input, knobs);
     }});

}  // namespace
}  // namespace treeline::bench::knn
