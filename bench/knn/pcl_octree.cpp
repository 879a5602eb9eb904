// PCL's octree: voxels of a fixed size at the bottom, each with a list of point numbers.
//
// Its one setting is that size, the resolution. It is swept in multiples of the cloud's spacing: 4 is best
// for even clouds, 8 for surfaces, 16 only for positions off a cloud, where few voxels are worth more than
// small ones. True radii; box queries. No batches.
#include <pcl/octree/octree_search.h>

#include "accel/batch.hpp"
#include "bench/core/registry.hpp"
#include "bench/knn/pcl_points.hpp"

namespace treeline::bench::knn {
namespace {

// PCL's search methods are not const, though they change nothing.
class PclOctree final : public Index {
 public:
  PclOctree(const Input& input, const Knobs& knobs)
      : tree_(std::make_unique<Tree>(resolution(input, knobs.at("resolution").get<double>()))) {
    tree_->setInputCloud(pcl_cloud(input));
    tree_->addPointsFromInputCloud();
  }

  void nearest(std::span<const Vec3f> queries, std::size_t k, const Knobs&, int threads,
               std::span<Id> ids) const override {
    accel::parallel_ranges(queries.size(), threads, [&](std::size_t begin, std::size_t end) {
      pcl::Indices indices;
      std::vector<float> distances;
      for (std::size_t i = begin; i < end; ++i) {
        tree_->nearestKSearch(pcl_point(queries[i]), static_cast<pcl::uindex_t>(k), indices, distances);
        for (std::size_t j = 0; j < std::min(k, indices.size()); ++j)
          ids[i * k + j] = static_cast<Id>(indices[j]);
      }
    });
  }

  void within(std::span<const Vec3f> queries, float radius, const Knobs&, int threads,
              Lists<Id>& lists) const override {
    accel::parallel_lists(queries.size(), threads, lists, [&](std::size_t i, std::vector<Id>& ids) {
      thread_local pcl::Indices indices;
      thread_local std::vector<float> distances;
      indices.clear(), distances.clear();
      tree_->radiusSearch(pcl_point(queries[i]), radius, indices, distances);
      ids.insert(ids.end(), indices.begin(), indices.end());
    });
  }

  void inside(std::span<const Box3f> boxes, const Knobs&, int threads, Lists<Id>& lists) const override {
    accel::parallel_lists(boxes.size(), threads, lists, [&](std::size_t i, std::vector<Id>& ids) {
      thread_local pcl::Indices indices;
      indices.clear();
      const Box3f& b = boxes[i];
      tree_->boxSearch({b.low[0], b.low[1], b.low[2]}, {b.high[0], b.high[1], b.high[2]}, indices);
      ids.insert(ids.end(), indices.begin(), indices.end());
    });
  }

 private:
  using Tree = pcl::octree::OctreePointCloudSearch<pcl::PointXYZ>;

  // Where most points coincide, the spacing is that of an even spread; where all do, any size will do.
  // Octrees of more than some 2^20 voxels a side exceed PCL's keys, so the resolution follows the box where
  // points are that uneven.
  static double resolution(const Input& input, double spacings) {
    Box3f box;
    for (const Vec3f& p : input.points)
      if (geometry::is_finite(p)) box.grow(p);
    const double widest = box.empty() ? 0.0 : box.extent()[box.widest_axis()];
    const double even =
        widest / std::cbrt(static_cast<double>(std::max<std::size_t>(input.points.size(), 1)));
    const double spacing = input.spacing > 0 ? input.spacing : even;
    const double size = std::max(spacings * spacing, std::ldexp(widest, -20));
    return size > 0 ? size : 1.0;
  }

  std::unique_ptr<Tree> tree_;
};

[[maybe_unused]] const bool registered = Registry<Method>::instance().add(
    {.info = {.name = "pcl_octree",
              .family = "octree",
              .source = Source::peer,
              .peer_version = PCL_VERSION_PRETTY,
              .build_knobs = {{{"resolution", 4}}, {{"resolution", 8}}, {{"resolution", 16}}},
              .ladder = 33,
              .quick_builds = 2,
              .scales = false},
     .build = [](const Input& input, const Knobs& knobs) -> std::unique_ptr<Index> {
       return std::make_unique<PclOctree>(input, knobs);
     }});

}  // namespace
}  // namespace treeline::bench::knn
