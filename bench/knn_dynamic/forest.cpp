// Our forest of static trees, of which parts are rebuilt: over the wide bounding volume hierarchy.
#include "accel/bvh/wide_points.hpp"
#include "accel/dynamic_points.hpp"
#include "bench/core/registry.hpp"
#include "bench/knn_dynamic/method.hpp"

namespace treeline::bench::knn_dynamic {
namespace {

using Tree = accel::Bvh<accel::Points<float, 3>, accel::Wide>;
using Neighbor = accel::Neighbor<float>;

Tree::Options tree_options(int threads) {
  Tree::Options options;
  options.threads = threads;
  return options;
}

class Forest final : public Index {
 public:
  Forest(const Input& input, const Knobs& knobs)
      : pool_(input.pool),
        points_(tree_options(input.threads),
                {.block = knobs.at("block").get<std::size_t>(), .growth = knobs.at("growth").get<double>()}) {
  }

  // It numbers points as they come, which is the pool's order.
  void change(std::span<const Id> gone, Id first, Id last) override {
    for (const Id id : gone) points_.erase(id);
    points_.insert(pool_.subspan(first, last - first));
  }

  void nearest(std::span<const Vec3f> queries, std::size_t k, int threads, std::span<Id> ids) const override {
    std::vector<Neighbor> found(queries.size() * k);
    points_.nearest(queries, k, found, threads);
    for (std::size_t i = 0; i < found.size(); ++i) ids[i] = found[i].id;
  }

  std::size_t trees() const override { return points_.tree_count(); }

 private:
  std::span<const Vec3f> pool_;
  accel::DynamicPoints<Tree> points_;
};

[[maybe_unused]] const bool registered = Registry<Method>::instance().add(
    {.info = {.name = "forest_bvh_wide",
              .family = "bvh",
              .build_knobs = {{{"block", 128}, {"growth", 4}},
                              {{"block", 128}, {"growth", 1}},
                              {{"block", 1024}, {"growth", 2}}},
              .ladder = 2,
              .quick_builds = 2},
     .make = [](const Input& input, const Knobs& knobs) -> std::unique_ptr<Index> {
       return std::make_unique<Forest>(input, knobs);
     }});

}  // namespace
}  // namespace treeline::bench::knn_dynamic
