// nanoflann: one KD-tree with sliding-midpoint splits over the caller's points.
//
// Its documented settings: leaf size 10 to 50 pays (README, "10 is the default"); the dimension is given at
// compile time; answers of a radius query stay unsorted. It takes squared radii and leaves out points at
// exactly the radius. 1.4 has no box query and no batches. Points that are NaN mislead its bounding box.
#include <nanoflann.hpp>

#include "accel/batch.hpp"
#include "bench/core/registry.hpp"
#include "bench/knn/method.hpp"

namespace treeline::bench::knn {
namespace {

struct Adaptor {
  std::span<const Vec3f> points;

  std::size_t kdtree_get_point_count() const { return points.size(); }
  float kdtree_get_pt(std::size_t i, std::size_t axis) const { return points[i][static_cast<int>(axis)]; }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, Adaptor, float, Id>,
                                                 Adaptor, 3, Id>;

// Result set of a radius query that keeps ids only.
struct IdsWithin {
  float radius2;
  std::vector<Id>& ids;

  std::size_t size() const { return ids.size(); }
  bool full() const { return true; }
  bool addPoint(float distance2, Id id) {
    if (distance2 < radius2) ids.push_back(id);
    return true;
  }
  float worstDist() const { return radius2; }
};

class Nanoflann final : public Index {
 public:
  Nanoflann(const Input& input, const Knobs& knobs)
      : points_{input.points},
        tree_(3, points_,
              nanoflann::KDTreeSingleIndexAdaptorParams(knobs.at("leaf_size").get<std::size_t>())) {}

  void nearest(std::span<const Vec3f> queries, std::size_t k, const Knobs&, int threads,
               std::span<Id> ids) const override {
    accel::parallel_ranges(queries.size(), threads, [&](std::size_t begin, std::size_t end) {
      std::vector<float> distances(k);
      for (std::size_t i = begin; i < end; ++i)
        tree_.knnSearch(queries[i].v, k, &ids[i * k], distances.data());
    });
  }

  void within(std::span<const Vec3f> queries, float radius, const Knobs&, int threads,
              Lists<Id>& lists) const override {
    accel::parallel_lists(queries.size(), threads, lists, [&](std::size_t i, std::vector<Id>& ids) {
      IdsWithin found{radius * radius, ids};
      tree_.radiusSearchCustomCallback(queries[i].v, found);
    });
  }

 private:
  Adaptor points_;
  Tree tree_;
};

[[maybe_unused]] const bool registered = Registry<Method>::instance().add(
    {.info = {.name = "nanoflann",
              .family = "kd",
              .source = Source::peer,
              .peer_version = "1.4.3",
              .build_knobs = {{{"leaf_size", 10}}, {{"leaf_size", 20}}, {{"leaf_size", 32}}},
              .ladder = 30,
              .keeps_no_copy = true,
              .quick_builds = 2},
     .build = [](const Input& input, const Knobs& knobs) -> std::unique_ptr<Index> {
       return std::make_unique<Nanoflann>(input, knobs);
     }});

}  // namespace
}  // namespace treeline::bench::knn
