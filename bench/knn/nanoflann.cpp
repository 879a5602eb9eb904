// nanoflann: one KD-tree with sliding-midpoint splits over the caller's points.
//
// Its documented settings: leaf size 10 to 50 pays (README, "10 is the default"); the dimension is given at
// compile time; answers of a radius query stay unsorted. It takes squared radii and leaves out points at
// exactly the radius. 1.4 has no box query and no batches. Points that are NaN mislead its bounding box.
// Clouds that need doubles it takes as such, or rounded.
#include <nanoflann.hpp>

#include "accel/batch.hpp"
#include "bench/core/registry.hpp"
#include "bench/knn/rounded.hpp"

namespace treeline::bench::knn {
namespace {

template <class T>
struct Adaptor {
  std::span<const geometry::Vec<T, 3>> points;

  std::size_t kdtree_get_point_count() const { return points.size(); }
  T kdtree_get_pt(std::size_t i, std::size_t axis) const { return points[i][static_cast<int>(axis)]; }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

template <class T>
using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<T, Adaptor<T>, T, Id>,
                                                 Adaptor<T>, 3, Id>;

// Result set of a radius query that keeps ids only.
template <class T>
struct IdsWithin {
  T radius2;
  std::vector<Id>& ids;

  std::size_t size() const { return ids.size(); }
  bool full() const { return true; }
  bool addPoint(T distance2, Id id) {
    if (distance2 < radius2) ids.push_back(id);
    return true;
  }
  T worstDist() const { return radius2; }
};

template <class T>
class Nanoflann final : public IndexOf<T> {
  using Point = geometry::Vec<T, 3>;

 public:
  Nanoflann(const InputOf<T>& input, const Knobs& knobs)
      : points_{input.points},
        tree_(3, points_,
              nanoflann::KDTreeSingleIndexAdaptorParams(knobs.at("leaf_size").get<std::size_t>())) {}

  void nearest(std::span<const Point> queries, std::size_t k, const Knobs&, int threads,
               std::span<Id> ids) const override {
    accel::parallel_ranges(queries.size(), threads, [&](std::size_t begin, std::size_t end) {
      std::vector<T> distances(k);
      for (std::size_t i = begin; i < end; ++i)
        tree_.knnSearch(queries[i].v, k, &ids[i * k], distances.data());
    });
  }

  void within(std::span<const Point> queries, T radius, const Knobs&, int threads,
              Lists<Id>& lists) const override {
    accel::parallel_lists(queries.size(), threads, lists, [&](std::size_t i, std::vector<Id>& ids) {
      IdsWithin<T> found{radius * radius, ids};
      tree_.radiusSearchCustomCallback(queries[i].v, found);
    });
  }

 private:
  Adaptor<T> points_;
  Tree<T> tree_;
};

template <class T>
std::unique_ptr<IndexOf<T>> build(const InputOf<T>& input, const Knobs& knobs) {
  return std::make_unique<Nanoflann<T>>(input, knobs);
}

const std::vector<Knobs> leaves{{{"leaf_size", 10}}, {{"leaf_size", 20}}, {{"leaf_size", 32}}};

[[maybe_unused]] const bool registered = Registry<Method>::instance().add({.info = {.name = "nanoflann",
                                                                                    .family = "kd",
                                                                                    .source = Source::peer,
                                                                                    .peer_version = "1.4.3",
                                                                                    .build_knobs = leaves,
                                                                                    .ladder = 30,
                                                                                    .keeps_no_copy = true,
                                                                                    .quick_builds = 2},
                                                                           .build = build<float>});
[[maybe_unused]] const bool registered_double =
    Registry<Method>::instance().add({.info = {.name = "nanoflann_double",
                                               .family = "kd",
                                               .source = Source::peer,
                                               .peer_version = "1.4.3",
                                               .build_knobs = leaves,
                                               .ladder = 40,
                                               .keeps_no_copy = true,
                                               .quick_builds = 2,
                                               .scales = false},
                                      .build_double = build<double>});
[[maybe_unused]] const bool registered_rounded = Registry<Method>::instance().add(
    {.info = {.name = "nanoflann_rounded",
              .family = "kd",
              .source = Source::peer,
              .claim = Claim::approximate,
              .peer_version = "1.4.3",
              .build_knobs = with_origins({leaves[0]}),
              .ladder = 35,
              .scales = false},
     .build_double = [](const InputOf<double>& input,
                        const Knobs& knobs) -> std::unique_ptr<IndexOf<double>> {
       return std::make_unique<Rounded>(input, build<float>, knobs);
     },
     .rounds_points = true});

}  // namespace
}  // namespace treeline::bench::knn
