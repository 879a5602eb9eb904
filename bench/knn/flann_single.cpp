// FLANN's KDTreeSingleIndex: one exact KD-tree, meant for low dimensions.
//
// Its documented settings: reorder (a copy of the points in leaf order, its default) and the leaf size, 10 by
// default; L2_3D is its unrolled distance for three dimensions. Checks are unlimited, which makes it exact.
#include "bench/core/registry.hpp"
#include "bench/knn/flann_search.hpp"

namespace treeline::bench::knn {
namespace {

class FlannSingle final : public Index {
 public:
  FlannSingle(const Input& input, const Knobs& knobs)
      : index_(flann_matrix(input.points),
               flann::KDTreeSingleIndexParams(knobs.at("leaf_size").get<int>(), /*reorder=*/true)) {
    index_.buildIndex();
  }

  void nearest(std::span<const Vec3f> queries, std::size_t k, const Knobs&, int threads,
               std::span<Id> ids) const override {
    flann_nearest(index_, queries, k, exact(), threads, ids);
  }
  void within(std::span<const Vec3f> queries, float radius, const Knobs&, int threads,
              Lists<Id>& lists) const override {
    flann_within(index_, queries, radius, exact(), threads, lists);
  }

 private:
  static flann::SearchParams exact() { return flann::SearchParams(flann::FLANN_CHECKS_UNLIMITED); }

  flann::KDTreeSingleIndex<flann::L2_3D<float>> index_;
};

[[maybe_unused]] const bool registered = Registry<Method>::instance().add(
    {.info = {.name = "flann_single",
              .family = "kd",
              .source = Source::peer,
              .peer_version = FLANN_VERSION_,
              .build_knobs = {{{"leaf_size", 10}}, {{"leaf_size", 20}}, {{"leaf_size", 32}}},
              .ladder = 31,
              .quick_builds = 2},
     .build = [](const Input& input, const Knobs& knobs) -> std::unique_ptr<Index> {
       return std::make_unique<FlannSingle>(input, knobs);
     }});

}  // namespace
}  // namespace treeline::bench::knn
