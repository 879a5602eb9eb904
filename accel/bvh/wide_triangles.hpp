// Wide bounding volume hierarchy over triangles: the fastest index here for rays and for closest points.
//
// Eight child boxes a node and eight triangles a leaf (WideOf: other numbers), each measured by one pass of
// vector instructions (Wald, Benthin and Boulos 2008; Ernst and Greiner 2008), children visited in order of
// distance without a branch on how many were met. Layout, box test, triangle test and traversal are described
// in wide_triangle_layout.hpp, wide_ray.hpp and wide_woop.hpp, the way there in build_binned.hpp and
// wide_collapse.hpp; any builder of binary trees can take the place of the default. Closest points are found
// in the same tree (wide_closest_search.hpp), and among the triangles of no area in a second one, if there
// are any. Cost: O(n log n) to build, O(log n) expected per ray, about 50 bytes a triangle, its corners
// included. Known weakness: float's, for triangles seen edge-on (see wide_woop.hpp); one ray at a time waits
// for memory at every level where the tree outgrows the caches.
#pragma once

#include "accel/bvh/build_binned.hpp"
#include "accel/bvh/triangle_input.hpp"
#include "accel/bvh/wide_closest_queries.hpp"
#include "accel/bvh/wide_collapse.hpp"
#include "accel/bvh/wide_exact.hpp"
#include "accel/bvh/wide_packet.hpp"
#include "accel/bvh/wide_ray.hpp"
#include "accel/bvh/wide_refit.hpp"
#include "accel/bvh/wide_stream.hpp"
#include "accel/ray_checks.hpp"
#include "accel/slice.hpp"

namespace treeline::accel {

/// How a batch of rays is worked on; the answers are the same.
enum class RayBatch {
  automatic,  ///< streams where the tree is larger than the caches are likely to be
  singly,     ///< one after the other: for rays that follow each other closely
  streams,    ///< several in flight (wide_stream.hpp): for rays that go anywhere
  packets     ///< sixteen together (wide_packet.hpp): for neighbours that go the same way; else singly
};

struct WideTriangleOptions {
  NonFinite non_finite = NonFinite::refuse;
  double node_cost = 1;  ///< of a step through a binary node, in leaf tests
  int threads = 1;       ///< that build; the tree does not depend on it
};

namespace wide {
template <class Tree>
class Crossings;  // wide_crossing.hpp

/// Leaf test of a policy, for N triangles a leaf.
template <class Policy, int N>
struct LeafTestOf;
template <int N>
struct LeafTestOf<geometry::Watertight, N> {
  using Type = WoopTest<N>;
};
template <int N>
struct LeafTestOf<geometry::Exact, N> {
  using Type = ExactTest<N>;
};
template <class Policy>
concept HasLeafTest = requires {
  typename LeafTestOf<Policy, 8>::Type;
};
}  // namespace wide

template <class Policy, wide::TriangleLayout Name>
class Bvh<Triangles<float, Policy>, Name>
    : public WideClosestQueries<Bvh<Triangles<float, Policy>, Name>, typename wide::LayoutOf<Name>::Type> {
  friend WideClosestQueries<Bvh, typename wide::LayoutOf<Name>::Type>;
  static_assert(wide::HasLeafTest<Policy>,
                "wide trees over triangles take the ray tests geometry::Watertight and geometry::Exact");

 public:
  using Scalar = float;
  using Point = geometry::Vec<float, 3>;
  using Box = geometry::Box<float, 3>;
  using Ray = geometry::Ray<float>;
  using Triangle = geometry::Triangle<float>;
  using Options = WideTriangleOptions;
  using Layout = typename wide::LayoutOf<Name>::Type;

  /// Throw InvalidInput for triangles that are not finite (unless they are to be dropped), threads < 1, or a
  /// node_cost that is not positive and finite.
  explicit Bvh(std::span<const Triangle> triangles, const Options& options = {})
      : Bvh(triangles, options, build_binned) {}
  explicit Bvh(const geometry::Mesh<float>& mesh, const Options& options = {})
      : Bvh(mesh, options, build_binned) {}
  /// With another builder: build(std::span<const Triangle>, const BinaryBuildOptions&) gives a BinaryTree.
  template <class Input, class Build>
  Bvh(const Input& input, const Options& options, Build&& build)
      : Bvh(TriangleInput(input, options.non_finite, options.threads), options, build) {}

  Hit<float> closest_hit(const Ray& ray) const {
    NoWork work;
    return closest_hit(ray, work);
  }
  template <WorkCounter W>
  Hit<float> closest_hit(const Ray& ray, W& work) const {
    check_ray(ray);
    return closest(ray, work);
  }
  void closest_hit(std::span<const Ray> rays, std::span<Hit<float>> hits, int threads,
                   RayBatch how = RayBatch::automatic) const {
    closest_hits<true>(rays, hits, threads, how);
  }
  /// The same without the weights: u and v are 0. For whom the face and its distance are enough.
  void closest_face(std::span<const Ray> rays, std::span<Hit<float>> hits, int threads,
                    RayBatch how = RayBatch::automatic) const {
    closest_hits<false>(rays, hits, threads, how);
  }

  bool any_hit(const Ray& ray) const {
    NoWork work;
    return any_hit(ray, work);
  }
  template <WorkCounter W>
  bool any_hit(const Ray& ray, W& work) const {
    check_ray(ray);
    return any(ray, work);
  }
  void any_hit(std::span<const Ray> rays, std::span<std::uint8_t> answers, int threads,
               RayBatch how = RayBatch::automatic) const {
    check_rays(rays, answers.size());
    parallel_ranges(rays.size(), threads, [&](std::size_t begin, std::size_t end) {
      NoWork work;
      if (flies(how))
        fly_any(rays, answers, begin, end);
      else if (walks(how))
        walk<true>(
            rays, begin, end, [&](std::size_t i) { answers[i] = any(rays[i], work) ? 1 : 0; },
            [&](const Test&, const NearestHit&, std::size_t i, int, bool hit) { answers[i] = hit ? 1 : 0; });
      else
        for (std::size_t i = begin; i < end; ++i) answers[i] = any(rays[i], work) ? 1 : 0;
    });
  }

  /// Every hit in [t_min, t_max], nearest first, ties by lower id.
  void all_hits(const Ray& given, std::vector<Hit<float>>& hits) const {
    check_ray(given);
    hits.clear();
    if (tree_.root == wide::no_ref) return;
    placed(given, [&](const auto& ray, const Point& centre, int shift) {
      const BoxRay box_ray(ray, centre, place_.bounds);
      const Test test(ray, centre, place_.bounds, box_ray.reach);
      std::vector<NearestHit> met;
      wide::all(tree_.lines.data(), tree_.root, box_ray, test, end_of(ray),
                [&](const typename Layout::Leaf& leaf, Id id, std::uint32_t lane, float t) {
                  met.push_back({t, id, &leaf, lane});
                });
      // Ranked as closest_hit ranks them: before t is scaled back, when it may underflow.
      std::sort(met.begin(), met.end(), [](const NearestHit& a, const NearestHit& b) {
        return a.t < b.t || (a.t == b.t && a.id < b.id);
      });
      for (const NearestHit& hit : met)  // spatial splits keep a triangle in several leaves
        if (hits.empty() || hits.back().primitive != hit.id) hits.push_back(answer(given, shift, test, hit));
    });
  }

  /// Takes the same triangles with moved corners: answers become those of a tree built over them, the
  /// structure stays. Throws InvalidInput, and leaves the tree as it is, for another number of triangles, for
  /// one that was left out at the build and could be hit now, and as the build does for those not finite.
  template <class Input>
  void refit(const Input& moved, int threads = 1) requires wide::Refits<Layout> {
    const TriangleInput input(moved, non_finite_, threads);
    if (const std::size_t count = input.triangles().size() + input.dropped(), built = size() + stats_.dropped;
        count != built)
      throw InvalidInput(std::to_string(count) + " triangles to refit a tree over " + std::to_string(built));
    wide::Refit<Layout> refit(tree_, input.triangles(), input.ids());
    if (stats_.dropped > 0) refit.check(size() + stats_.dropped);
    place_ = input.place();
    if (input.triangles().empty()) place_.bounds = {Point{}, Point{}};
    refit.run(threads);
    set_aside(input, threads);
    count_triangles(input);
  }

  /// Number of triangles kept: those that rays can hit.
  std::size_t size() const { return stats_.primitives; }
  std::size_t bytes() const { return stats_.bytes; }
  TreeStats stats() const { return stats_; }
  /// Encloses all triangles; empty if there are none.
  Box bounds() const {
    return size() == 0 ? Box{} : Box{place_.to_user(place_.bounds.low), place_.to_user(place_.bounds.high)};
  }
  /// The boxes of the leaves.
  std::vector<SliceCell> slice(int axis, double offset) const;

 private:
  template <class Tree>
  friend class wide::Crossings;

  using Test = typename wide::LeafTestOf<Policy, Layout::leaf_size>::Type;
  using BoxRay = wide::BoxRay<Layout>;
  using NearestHit = wide::NearestHit<Layout>;

  template <class Build>
  Bvh(TriangleInput&& input, const Options& options, Build&& build)
      : place_(input.place()), non_finite_(options.non_finite) {
    check_cost("node_cost", options.node_cost);
    BinaryBuildOptions how;
    how.block = how.largest_leaf = Layout::leaf_size;
    how.node_cost = options.node_cost, how.threads = options.threads;
    const BinaryTree binary = build(input.triangles(), how);
    tree_ = wide::Collapse<Layout>(binary, input.triangles(), input.ids(), options.threads).run();
    built_size_ = input.triangles().size();
    set_aside(input, options.threads);
    count(input);
  }
  /// Keeps the triangles of no area in a tree of their own.
  void set_aside(const TriangleInput& input, int threads) {
    const TriangleInput rest = input.without_area(threads);
    aside_ = {};
    if (rest.triangles().empty()) return;
    BinaryBuildOptions how;
    how.block = how.largest_leaf = Layout::leaf_size, how.threads = threads;
    aside_ = {rest.place(), wide::Collapse<Layout>(build_binned(rest.triangles(), how), rest.triangles(),
                                                   rest.ids(), threads)
                                .run()};
  }
  void count(const TriangleInput& input);
  void count_triangles(const TriangleInput& input) {
    stats_.primitives = input.triangles().size(), stats_.dropped = input.dropped();
    stats_.sah_cost = tree_.sah_cost;
    stats_.bytes = sizeof(*this) + tree_.lines.bytes() + aside_.tree.lines.bytes();
  }
  template <class F>
  void each_closest_space(F&& f) const {
    f(wide::ClosestSpace{tree_, place_, size() < built_size_});
    if (aside_.tree.root != wide::no_ref) f(wide::ClosestSpace{aside_.tree, aside_.place, false, false});
  }

  /// Calls f(ray, centre, shift): the ray moved by -centre is in the tree's space, its t the given ray's
  /// times 2^shift. As a rule that is the ray as it stands.
  template <class F>
  auto placed(const Ray& given, F&& f) const {
    if (!place_.scale.scales() && TriangleScale<float>::is_comfortable(given))
      return f(given, place_.centre, 0);
    int shift;
    const Ray ray = place_.scale.scaled(given, shift);
    if constexpr (std::same_as<Policy, geometry::Exact>) {
      const auto time = [&](float t) { return std::ldexp(t, shift); };  // an end at infinity stays there
      const Ray open{ray.origin, ray.direction, time(given.t_min), time(given.t_max)};
      return f(wide::ScaledRay{open, given, place_.centre, place_.scale.factor(), shift},
               place_.scaled_centre, shift);
    } else {
      return f(ray, place_.scaled_centre, shift);
    }
  }
  template <bool weights>
  void closest_hits(std::span<const Ray> rays, std::span<Hit<float>> hits, int threads, RayBatch how) const {
    check_rays(rays, hits.size());
    parallel_ranges(rays.size(), threads, [&](std::size_t begin, std::size_t end) {
      NoWork work;
      if (flies(how))
        fly_closest<weights>(rays, hits, begin, end);
      else if (walks(how))
        walk<false>(
            rays, begin, end, [&](std::size_t i) { hits[i] = closest<weights>(rays[i], work); },
            [&](const Test& test, const NearestHit& best, std::size_t i, int shift, bool) {
              hits[i] = answer<weights>(rays[i], shift, test, best);
            });
      else
        for (std::size_t i = begin; i < end; ++i) hits[i] = closest<weights>(rays[i], work);
    });
  }
  template <bool weights = true, class W>
  Hit<float> closest(const Ray& given, W& work) const {
    if (tree_.root == wide::no_ref) return {};
    return placed(given, [&](const auto& ray, const Point& centre, int shift) {
      const BoxRay box_ray(ray, centre, place_.bounds);
      const Test test(ray, centre, place_.bounds, box_ray.reach);
      NearestHit best{end_of(ray)};
      wide::closest(tree_.lines.data(), tree_.root, box_ray, test, best, work);
      return answer<weights>(given, shift, test, best);
    });
  }
  template <bool weights = true>
  static Hit<float> answer(const Ray& given, int shift, const Test& test, const NearestHit& best) {
    Hit<float> hit;
    if (best.id == no_id) return hit;
    const auto& leaf = Layout::triangles(*best.leaf);
    if (shift == 0)
      hit.t = best.t;
    else if constexpr (requires { test.time(leaf, best.lane, shift); })
      hit.t = test.time(leaf, best.lane, shift);
    else
      hit.t = TriangleScale<float>::unscaled_t(best.t, shift, given);
    hit.primitive = best.id;
    if constexpr (weights) test.weights(leaf, best.lane, hit.u, hit.v);
    return hit;
  }
  template <class W>
  bool any(const Ray& given, W& work) const {
    if (tree_.root == wide::no_ref) return false;
    return placed(given, [&](const auto& ray, const Point& centre, int) {
      const BoxRay box_ray(ray, centre, place_.bounds);
      return wide::any(tree_.lines.data(), tree_.root, box_ray,
                       Test(ray, centre, place_.bounds, box_ray.reach), end_of(ray), work);
    });
  }

  static constexpr std::size_t cached_bytes = std::size_t{4} << 20;
  bool flies(RayBatch how) const {
    return tree_.root != wide::no_ref &&
           (how == RayBatch::streams || (how == RayBatch::automatic && tree_.lines.bytes() > cached_bytes));
  }
  bool walks(RayBatch how) const {
    return wide::WalksInPackets<Layout> && tree_.root != wide::no_ref && how == RayBatch::packets;
  }
  /// Rays follow each other into a packet until one does not go with it; what goes with none is alone(i).
  template <bool is_any, class Alone, class Finish>
  void walk(std::span<const Ray> rays, std::size_t begin, std::size_t end, Alone&& alone,
            Finish&& finish) const {
    if constexpr (wide::WalksInPackets<Layout>) {
      wide::Packet<Layout, Test> packet;
      const auto add = [&](std::size_t i) {
        return placed(rays[i], [&](const auto& ray, const Point& centre, int shift) {
          return packet.add(ray, centre, place_.bounds, i, shift);
        });
      };
      const auto go = [&] {
        packet.template walk<is_any>(tree_.lines.data(), tree_.root);
        packet.take(finish);
      };
      for (std::size_t i = begin; i < end; ++i) {
        if (packet.full()) go();
        if (add(i)) continue;
        if (!packet.empty()) go();
        if (!add(i)) alone(i);
      }
      if (!packet.empty()) go();
    }
  }
  template <bool weights>
  void fly_closest(std::span<const Ray> rays, std::span<Hit<float>> hits, std::size_t begin,
                   std::size_t end) const {
    wide::fly<wide::ClosestFlight<Layout, Test>>(
        tree_.lines.data(), begin, end, [&](auto& flight, std::size_t i) { start(flight, rays[i], i); },
        [&](const auto& flight) {
          hits[flight.index] = answer<weights>(rays[flight.index], flight.shift, flight.test, flight.best);
        });
  }
  void fly_any(std::span<const Ray> rays, std::span<std::uint8_t> answers, std::size_t begin,
               std::size_t end) const {
    wide::fly<wide::AnyFlight<Layout, Test>>(
        tree_.lines.data(), begin, end, [&](auto& flight, std::size_t i) { start(flight, rays[i], i); },
        [&](const auto& flight) { answers[flight.index] = flight.hit ? 1 : 0; });
  }
  template <class Flight>
  void start(Flight& flight, const Ray& given, std::size_t i) const {
    placed(given, [&](const auto& ray, const Point& centre, int shift) {
      flight.start(ray, centre, place_.bounds, tree_.root);
      flight.index = i, flight.shift = shift;
    });
  }

  TriangleInput::Place place_;
  NonFinite non_finite_;
  wide::RayTree tree_;
  struct Aside {
    TriangleInput::Place place;
    wide::RayTree tree;
  } aside_;
  std::size_t built_size_ = 0;
  TreeStats stats_;
};

template <class Policy, wide::TriangleLayout Name>
void Bvh<Triangles<float, Policy>, Name>::count(const TriangleInput& input) {
  count_triangles(input);
  stats_.references = tree_.references, stats_.inner_nodes = tree_.nodes, stats_.leaves = tree_.leaves;
  stats_.depth = tree_.depth, stats_.largest_leaf = tree_.largest_leaf;
}

template <class Policy, wide::TriangleLayout Name>
std::vector<SliceCell> Bvh<Triangles<float, Policy>, Name>::slice(int axis, double offset) const {
  const double factor = static_cast<double>(place_.scale.factor());
  const SlicePlane<3> plane(axis, (offset - static_cast<double>(place_.centre[axis])) * factor);
  std::vector<SliceCell> cells;
  struct Open {
    wide::Ref ref;
    Box box;
    std::size_t depth;
  };
  std::vector<Open> open;
  if (size() > 0) open.push_back({tree_.root, place_.bounds, 0});
  while (!open.empty()) {
    const Open o = open.back();
    open.pop_back();
    if (!plane.cuts(o.box)) continue;
    if (wide::is_leaf(o.ref)) {
      const auto& leaf = Layout::triangles(wide::leaf_at<Layout>(tree_.lines.data(), o.ref));
      std::size_t triangles = 1;
      while (triangles < Layout::leaf_size && leaf.id[triangles] != leaf.id[triangles - 1]) ++triangles;
      cells.push_back({plane.outline(o.box), o.depth, triangles});
      continue;
    }
    const auto& node = wide::node_at<Layout>(tree_.lines.data(), o.ref);
    for (int i = 0; i < Layout::count(node); ++i)
      open.push_back({Layout::child(node, static_cast<std::uint32_t>(i)), Layout::box(node, i), o.depth + 1});
  }
  cells = scaled(std::move(cells), static_cast<double>(place_.scale.inverse()));
  const int across[2] = {axis == 0 ? 1 : 0, axis == 2 ? 1 : 2};
  for (SliceCell& cell : cells)
    for (auto& corner : cell.outline)
      for (int i = 0; i < 2; ++i) corner[i] += static_cast<double>(place_.centre[across[i]]);
  return cells;
}

static_assert(RayIndex<Bvh<Triangles<float, geometry::Watertight>, Wide>>);
static_assert(ClosestPointIndex<Bvh<Triangles<float, geometry::Watertight>, Wide>>);
static_assert(Inspectable<Bvh<Triangles<float, geometry::Watertight>, Wide>>);

}  // namespace treeline::accel
