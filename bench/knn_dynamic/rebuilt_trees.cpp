// Our wide bounding volume hierarchy, and no tree at all, made anew after every change.
#include "accel/brute_force/points.hpp"
#include "accel/bvh/wide_points.hpp"
#include "bench/core/registry.hpp"
#include "bench/knn_dynamic/rebuilt.hpp"

namespace treeline::bench::knn_dynamic {
namespace {

template <class Tree>
class Static {
 public:
  Static(std::span<const Vec3f> points, const Knobs&, int threads) : tree_(points, options(threads)) {}

  void nearest(std::span<const Vec3f> queries, std::size_t k, int threads, std::span<Id> ids) const {
    std::vector<accel::Neighbor<float>> found(queries.size() * k);
    tree_.nearest(queries, k, {}, std::span<accel::Neighbor<float>>(found), threads);
    for (std::size_t i = 0; i < found.size(); ++i) ids[i] = found[i].id;
  }

 private:
  static typename Tree::Options options(int threads) {
    typename Tree::Options options;
    if constexpr (requires { options.threads; }) options.threads = threads;
    return options;
  }

  Tree tree_;
};

template <class Tree>
std::unique_ptr<Index> make(const Input& input, const Knobs& knobs) {
  return std::make_unique<Rebuilt<Static<Tree>>>(input, knobs);
}

using Points = accel::Points<float, 3>;

[[maybe_unused]] const bool registered =
    Registry<Method>::instance().add({.info = {.name = "brute", .family = "brute", .largest_n = 10'000},
                                      .make = make<accel::BruteForce<Points>>,
                                      .by_the_piece = false,
                                      .keeps = false}) &&
    Registry<Method>::instance().add({.info = {.name = "rebuilt_bvh_wide", .family = "bvh", .ladder = 1},
                                      .make = make<accel::Bvh<Points, accel::Wide>>,
                                      .by_the_piece = false});

}  // namespace
}  // namespace treeline::bench::knn_dynamic
