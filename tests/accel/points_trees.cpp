// Every tree of points under every option, behind the face that the tests use.
#include "accel/brute_force/points.hpp"
#include "accel/bsp_tree/points.hpp"
#include "accel/bsp_tree/spill_points.hpp"
#include "accel/bvh/points.hpp"
#include "accel/bvh/wide_points.hpp"
#include "accel/kd_tree/points.hpp"
#include "points_common.hpp"

namespace treeline::accel::test {
namespace {

template <class Tree, class T, int D>
struct Wrapped final : AnyTree<T, D> {
  using Base = AnyTree<T, D>;
  using typename Base::Box;
  using typename Base::Found;
  using typename Base::Point;

  Tree tree;

  Wrapped(std::string name, const Vecs<T, D>& points, const typename Tree::Options& options)
      : tree(points, options) {
    this->name = std::move(name);
  }
  std::size_t nearest(const Point& q, std::size_t k, std::span<Found> out) const override {
    return tree.nearest(q, k, out);
  }
  std::size_t nearest(const Point& q, std::size_t k, std::span<Found> out, Work& work) const override {
    return tree.nearest(q, k, out, work);
  }
  std::size_t nearest(const Point& q, std::size_t k, const NearestOptions<T>& options, std::span<Found> out,
                      Work& work) const override {
    return tree.nearest(q, k, options, out, work);
  }
  void within(const Point& q, T radius, std::vector<Found>& out) const override {
    tree.within(q, radius, out);
  }
  void within(const Point& q, T radius, const WithinOptions& options, std::vector<Found>& out,
              Work& work) const override {
    tree.within(q, radius, options, out, work);
  }
  void inside(const Box& box, std::vector<Id>& out) const override { tree.inside(box, out); }
  void nearest(std::span<const Point> q, std::size_t k, std::span<Found> out, int threads) const override {
    tree.nearest(q, k, out, threads);
  }
  void within(std::span<const Point> q, T radius, Lists<Found>& out, int threads) const override {
    tree.within(q, radius, out, threads);
  }
  void inside(std::span<const Box> boxes, Lists<Id>& out, int threads) const override {
    tree.inside(boxes, out, threads);
  }
  std::size_t size() const override { return tree.size(); }
  std::size_t bytes() const override { return tree.bytes(); }
  TreeStats stats() const override { return tree.stats(); }
  Box box() const override { return tree.box(); }
  std::vector<SliceCell> slice(int axis, double offset) const override { return tree.slice(axis, offset); }
};

}  // namespace

template <class T, int D>
Trees<T, D> all_trees(const Vecs<T, D>& points, int leaf_size, NonFinite non_finite) {
  using P = Points<T, D>;
  Trees<T, D> trees;
  const auto add = [&]<class Tree>(std::type_identity<Tree>, const char* name, auto options) {
    if constexpr (requires { options.leaf_size; }) options.leaf_size = leaf_size;
    options.non_finite = non_finite;
    trees.push_back(std::make_unique<Wrapped<Tree, T, D>>(name, points, options));
  };
  add(std::type_identity<BruteForce<P>>{}, "brute force", BuildOptions{});
  using Kd = KdPointOptions;
  add(std::type_identity<KdTree<P>>{}, "kd sliding midpoint", Kd{});
  add(std::type_identity<KdTree<P>>{}, "kd median", Kd{{}, Kd::Split::median});
  add(std::type_identity<KdTree<P>>{}, "kd sliding midpoint, boxes",
      Kd{{}, Kd::Split::sliding_midpoint, Kd::Bounds::tight_box});
  add(std::type_identity<KdTree<P>>{}, "kd median, boxes", Kd{{}, Kd::Split::median, Kd::Bounds::tight_box});
  BspPointOptions bsp;
  add(std::type_identity<BspTree<P>>{}, "bsp principal axis", bsp);
  bsp.bounds = BspPointOptions::Bounds::box_and_plane;
  add(std::type_identity<BspTree<P>>{}, "bsp principal axis, boxes", bsp);
  bsp.split = BspPointOptions::Split::random_projection;
  add(std::type_identity<BspTree<P>>{}, "bsp random projection, boxes", bsp);
  bsp.bounds = BspPointOptions::Bounds::planes;
  add(std::type_identity<BspTree<P>>{}, "bsp random projection", bsp);
  SpillPointOptions spill;
  spill.search = SpillPointOptions::Search::backtracking;
  add(std::type_identity<SpillTree<P>>{}, "bsp spill with backtracking", spill);
  using Bv = BvhPointOptions;
  add(std::type_identity<Bvh<P>>{}, "bvh rank", Bv{});
  add(std::type_identity<Bvh<P>>{}, "bvh sah", Bv{{}, Bv::Split::sah});
  add(std::type_identity<Bvh<P>>{}, "bvh rank, balls", Bv{{}, Bv::Split::rank, Bv::Bounds::ball});
  add(std::type_identity<Bvh<P>>{}, "bvh sah, balls", Bv{{}, Bv::Split::sah, Bv::Bounds::ball});
  WidePointOptions wide;
  add(std::type_identity<Bvh<P, accel::Wide>>{}, "bvh wide", wide);
  wide.split = WidePointOptions::Split::perimeter;
  add(std::type_identity<Bvh<P, accel::Wide>>{}, "bvh wide, by perimeter", wide);
  wide.threads = 2;
  add(std::type_identity<Bvh<P, accel::Wide>>{}, "bvh wide, built by two", wide);
  return trees;
}

template Trees<float, 2> all_trees<float, 2>(const Vecs<float, 2>&, int, NonFinite);
template Trees<float, 3> all_trees<float, 3>(const Vecs<float, 3>&, int, NonFinite);
template Trees<double, 2> all_trees<double, 2>(const Vecs<double, 2>&, int, NonFinite);
template Trees<double, 3> all_trees<double, 3>(const Vecs<double, 3>&, int, NonFinite);

}  // namespace treeline::accel::test
