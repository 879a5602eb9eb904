// PCL's KdTreeFLANN: FLANN's single tree behind PCL's clouds. It has no knobs (its leaf size is 15), takes
// true radii, and sorts the answers of radius queries unless told not to. No box query, no batches. It
// asserts that queries are finite.
#include <pcl/kdtree/kdtree_flann.h>

#include "accel/batch.hpp"
#include "bench/core/registry.hpp"
#include "bench/knn/pcl_points.hpp"

namespace treeline::bench::knn {
namespace {

class PclKdtree final : public Index {
 public:
  explicit PclKdtree(const Input& input) : tree_(/*sorted=*/false) { tree_.setInputCloud(pcl_cloud(input)); }

  void nearest(std::span<const Vec3f> queries, std::size_t k, const Knobs&, int threads,
               std::span<Id> ids) const override {
    accel::parallel_ranges(queries.size(), threads, [&](std::size_t begin, std::size_t end) {
      pcl::Indices indices;
      std::vector<float> distances;
      for (std::size_t i = begin; i < end; ++i) {
        const int found =
            tree_.nearestKSearch(pcl_point(queries[i]), static_cast<unsigned>(k), indices, distances);
        for (int j = 0; j < found; ++j)
          ids[i * k + static_cast<std::size_t>(j)] = static_cast<Id>(indices[j]);
      }
    });
  }

  void within(std::span<const Vec3f> queries, float radius, const Knobs&, int threads,
              Lists<Id>& lists) const override {
    accel::parallel_lists(queries.size(), threads, lists, [&](std::size_t i, std::vector<Id>& ids) {
      thread_local pcl::Indices indices;
      thread_local std::vector<float> distances;
      const int found = tree_.radiusSearch(pcl_point(queries[i]), radius, indices, distances);
      for (int j = 0; j < found; ++j) ids.push_back(static_cast<Id>(indices[j]));
    });
  }

 private:
  pcl::KdTreeFLANN<pcl::PointXYZ> tree_;
};

[[maybe_unused]] const bool registered = Registry<Method>::instance().add(
    {.info = {.name = "pcl_kdtree",
              .family = "kd",
              .source = Source::peer,
              .peer_version = PCL_VERSION_PRETTY,
              .ladder = 32},
     .build = [](const Input& input, const Knobs&) -> std::unique_ptr<Index> {
       return std::make_unique<PclKdtree>(input);
     }});

}  // namespace
}  // namespace treeline::bench::knn
