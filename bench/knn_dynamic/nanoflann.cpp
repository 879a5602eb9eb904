// nanoflann over points that come and go, two ways: its dynamic adaptor, and its static tree made anew after
// every change.
//
// The dynamic adaptor keeps trees of sizes that double (the logarithmic method). It wants points numbered as
// they come, marks what goes, and never drops it: its trees hold every point that ever came. Its settings:
// leaf size 10 to 50 pays (README, "10 is the default"). Its own table of trees is made for as many points as
// it is told may come: those of the pool.
#include <nanoflann.hpp>

#include "accel/batch.hpp"
#include "bench/core/registry.hpp"
#include "bench/knn_dynamic/rebuilt.hpp"

namespace treeline::bench::knn_dynamic {
namespace {

struct Adaptor {
  std::span<const Vec3f> points;
  bool empty_at_first = false;  // the dynamic adaptor takes what is there in its constructor

  std::size_t kdtree_get_point_count() const { return empty_at_first ? 0 : points.size(); }
  float kdtree_get_pt(std::size_t i, std::size_t axis) const { return points[i][static_cast<int>(axis)]; }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

using Distance = nanoflann::L2_Simple_Adaptor<float, Adaptor, float, Id>;
using StaticTree = nanoflann::KDTreeSingleIndexAdaptor<Distance, Adaptor, 3, Id>;
using DynamicTrees = nanoflann::KDTreeSingleIndexDynamicAdaptor<Distance, Adaptor, 3, Id>;

nanoflann::KDTreeSingleIndexAdaptorParams params(const Knobs& knobs) {
  return nanoflann::KDTreeSingleIndexAdaptorParams(knobs.at("leaf_size").get<std::size_t>());
}

template <class Tree>
void nearest_of(const Tree& tree, std::span<const Vec3f> queries, std::size_t k, int threads,
                std::span<Id> ids) {
  accel::parallel_ranges(queries.size(), threads, [&](std::size_t begin, std::size_t end) {
    std::vector<float> distances(k);
    for (std::size_t i = begin; i < end; ++i) {
      nanoflann::KNNResultSet<float, Id> found(k);
      found.init(&ids[i * k], distances.data());
      tree.findNeighbors(found, queries[i].v, nanoflann::SearchParams());
    }
  });
}

class Static {
 public:
  Static(std::span<const Vec3f> points, const Knobs& knobs, int)
      : points_{points}, tree_(3, points_, params(knobs)) {}

  void nearest(std::span<const Vec3f> queries, std::size_t k, int threads, std::span<Id> ids) const {
    nearest_of(tree_, queries, k, threads, ids);
  }

 private:
  Adaptor points_;
  StaticTree tree_;
};

class Dynamic final : public Index {
 public:
  Dynamic(const Input& input, const Knobs& knobs)
      : pool_{input.pool, true},
        trees_(3, pool_, params(knobs), std::max<std::size_t>(input.pool.size(), 2)) {}

  void change(std::span<const Id> gone, Id first, Id last) override {
    for (const Id id : gone) trees_.removePoint(id);
    if (last > first) trees_.addPoints(first, last - 1);
  }

  void nearest(std::span<const Vec3f> queries, std::size_t k, int threads, std::span<Id> ids) const override {
    nearest_of(trees_, queries, k, threads, ids);
  }

  std::size_t trees() const override {
    std::size_t r = 0;
    for (const auto& tree : trees_.getAllIndices()) r += tree.vAcc.empty() ? 0 : 1;
    return r;
  }

 private:
  Adaptor pool_;
  DynamicTrees trees_;
};

template <class Made>
std::unique_ptr<Index> make(const Input& input, const Knobs& knobs) {
  return std::make_unique<Made>(input, knobs);
}

const std::vector<Knobs> leaves{{{"leaf_size", 10}}, {{"leaf_size", 20}}, {{"leaf_size", 32}}};

[[maybe_unused]] const bool registered =
    Registry<Method>::instance().add({.info = {.name = "nanoflann_dynamic",
                                               .family = "kd",
                                               .source = Source::peer,
                                               .peer_version = "1.4.3",
                                               .build_knobs = leaves,
                                               .ladder = 31,
                                               .keeps_no_copy = true,
                                               .quick_builds = 2},
                                      .make = make<Dynamic>}) &&
    Registry<Method>::instance().add({.info = {.name = "rebuilt_nanoflann",
                                               .family = "kd",
                                               .source = Source::peer,
                                               .peer_version = "1.4.3",
                                               .build_knobs = leaves,
                                               .ladder = 30,
                                               .quick_builds = 1},
                                      .make = make<Rebuilt<Static>>,
                                      .by_the_piece = false});

}  // namespace
}  // namespace treeline::bench::knn_dynamic
