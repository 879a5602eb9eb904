// The public face that all trees share: what they are built from, what they are asked, what they answer.
//
// Trees are immutable once built and safe to query from many threads at once. Brute force is one of them.
#pragma once

#include <concepts>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <type_traits>
#include <utility>
#include <vector>

#include "geometry/box.hpp"
#include "geometry/intersect_triangle.hpp"
#include "geometry/ray.hpp"
#include "geometry/triangle.hpp"

namespace treeline::accel {

/// Thrown by builds and queries for input that has no answer (a point that is not finite, k = 0, a negative
/// radius, …); the message names what is wrong and, for arrays, the index.
struct InvalidInput : std::invalid_argument {
  using std::invalid_argument::invalid_argument;
};

using Id = std::uint32_t;
inline constexpr Id no_id = 0xffffffffu;

// ---- what a tree is built over -------------------------------------------------------------------------

/// Points in D dimensions: KdTree<Points<float, 3>>.
template <class T = float, int D = 3>
struct Points {
  using Scalar = T;
  static constexpr int dimension = D;
  using Point = geometry::Vec<T, D>;
  using Box = geometry::Box<T, D>;
  using Primitive = Point;
};

/// Triangles in space, with the ray test used at the leaves: Bvh<Triangles<float, geometry::MollerTrumbore>>.
template <class T = float, class RayTest = geometry::Watertight>
struct Triangles {
  using Scalar = T;
  static constexpr int dimension = 3;
  using Test = RayTest;
  using Point = geometry::Vec<T, 3>;
  using Box = geometry::Box<T, 3>;
  using Ray = geometry::Ray<T>;
  using Primitive = geometry::Triangle<T>;
};

template <class Primitives>
class BruteForce;
template <class Primitives>
class KdTree;
template <class Primitives>
class BspTree;
/// Layouts of a Bvh: two children a node, with pointers; or many that are measured at once: over points 16
/// children a node and no pointers, over triangles 8 children a node and 8 triangles a leaf.
struct Binary {};
struct Wide {};
/// The wide layout over triangles with 4, 8 or 16 children a node, and 4 or 8 triangles a leaf.
template <int Children, int LeafSize>
struct WideOf {};
/// The wide layout over triangles in half the memory: planes of 8 or 16 bits, corners that a leaf's triangles
/// share.
template <int Bits = 16>
struct WideCompact {};
namespace detail {
template <class...>
inline constexpr bool never = false;
}
template <class Primitives, class Layout = Binary>
class Bvh {
  static_assert(
      detail::never<Primitives, Layout>,
      "no such Bvh, or its header is missing (accel/bvh.hpp has all): of triangles, Wide, WideOf and "
      "WideCompact take Triangles<float, geometry::Watertight> and Triangles<float, geometry::Exact>; "
      "for doubles there is the binary layout");
};

// ---- build ---------------------------------------------------------------------------------------------

/// What to do with a primitive that has a NaN or infinite coordinate.
enum class NonFinite {
  refuse,  ///< throw InvalidInput naming its index
  drop     ///< leave it out; stats().dropped counts it; ids stay those of the input
};

/// Knobs common to most builders. Trees with knobs of their own have a struct that derives from this one, but
/// for those whose leaves have a fixed size, whose structs repeat what applies.
struct BuildOptions {
  NonFinite non_finite = NonFinite::refuse;
  int leaf_size = 8;  ///< at most so many primitives in a leaf, where they can be told apart
};

struct TreeStats {
  std::size_t primitives = 0;  ///< kept in the tree
  /// Left out because not finite; of triangles also those of exactly no area, which no ray hits (trees that
  /// answer closest points keep these apart, for closest points alone).
  std::size_t dropped = 0;
  std::size_t references = 0;  ///< primitive references over all leaves (≥ primitives where trees duplicate)
  std::size_t inner_nodes = 0;
  std::size_t oblique_nodes = 0;  ///< inner nodes whose plane is no axis plane (BSP)
  std::size_t leaves = 0;
  std::size_t depth = 0;  ///< edges from the root to the deepest leaf
  std::size_t largest_leaf = 0;
  std::size_t bytes = 0;  ///< memory held by the tree
  double sah_cost = 0;  ///< expected cost of a random line: node step 1, primitive test 1; 0 where undefined

  std::size_t node_count() const { return inner_nodes + leaves; }
};

/// One cell of a tree cut by an axis-aligned plane, for pictures: its outline in the two remaining axes.
struct SliceCell {
  std::vector<geometry::Vec2d> outline;  ///< convex, in order
  std::size_t depth = 0;
  std::size_t primitives = 0;
};

// ---- work counters: compiled out unless a Work is passed -----------------------------------------------

/// Counts what a query touched: `tree.nearest(q, k, out, work)`.
struct Work {
  std::uint64_t nodes = 0, primitives = 0;
  void node() { ++nodes; }
  void primitive(std::uint64_t n = 1) { primitives += n; }
};
struct NoWork {
  static constexpr void node() {}
  static constexpr void primitive(std::uint64_t = 1) {}
};
template <class W>
concept WorkCounter = requires(W w) {
  w.node();
  w.primitive(std::uint64_t{1});
};

// ---- answers -------------------------------------------------------------------------------------------

template <class T>
struct Neighbor {
  T distance2 = std::numeric_limits<T>::infinity();  ///< squared; NeighborIndex says where it vanishes
  Id id = no_id;

  /// Nearer first; ties by lower id.
  constexpr bool operator<(const Neighbor& o) const {
    return distance2 < o.distance2 || (distance2 == o.distance2 && id < o.id);
  }
  constexpr bool operator==(const Neighbor&) const = default;
};

/// How far a search for the nearest goes. Approximate searches err to one side only: what they return is
/// real, but something nearer may be missing.
template <class T>
struct NearestOptions {
  /// Inclusive: all that is within it counts, and what is beyond by no more than rounding may (see within).
  T max_distance = std::numeric_limits<T>::infinity();
  /// The i-th distance is at most (1 + epsilon) times the true i-th (of the distances as real numbers;
  /// epsilon below some units in the scalar's last place promises no more than an exact search does). Where
  /// fewer than k are within max_distance, none of them is missing.
  double epsilon = 0;
  /// Leaves measured, at least 1; no bound on the error. With a finite max_distance a search that has used
  /// them up ends with what it has found; without one it goes on until it has found k.
  std::size_t max_leaves = static_cast<std::size_t>(-1);

  bool exact() const { return epsilon == 0 && max_leaves == static_cast<std::size_t>(-1); }
};

struct WithinOptions {
  static constexpr std::size_t all = static_cast<std::size_t>(-1);
  bool sorted = false;        ///< nearest first, ties by lower id
  std::size_t at_most = all;  ///< only the nearest so many; these are sorted, however few there are

  bool ranked() const { return sorted || at_most != all; }
};

/// Variable-length answers of a batch: those of query i are items[offsets[i]] … items[offsets[i + 1] - 1].
template <class Item>
struct Lists {
  std::vector<std::size_t> offsets{0};
  std::vector<Item> items;

  std::size_t size() const { return offsets.size() - 1; }
  std::span<const Item> operator[](std::size_t i) const {
    return {items.data() + offsets[i], offsets[i + 1] - offsets[i]};
  }
  void clear() { offsets.assign(1, 0), items.clear(); }
};

template <class T>
struct Hit {
  T t = std::numeric_limits<T>::infinity();  ///< in lengths of the ray's direction
  Id primitive = no_id;
  T u = 0, v = 0;  ///< hit point = (1 - u - v)·a + u·b + v·c

  constexpr explicit operator bool() const { return primitive != no_id; }
  constexpr bool operator==(const Hit&) const = default;
};

/// Where on a triangle a closest point lies.
enum class Feature : std::uint8_t { face, edge_ab, edge_bc, edge_ca, vertex_a, vertex_b, vertex_c };

template <class T>
struct ClosestPoint {
  T distance2 = std::numeric_limits<T>::infinity();
  Id primitive = no_id;
  Feature feature = Feature::face;
  geometry::Vec<T, 3> point{};

  constexpr explicit operator bool() const { return primitive != no_id; }
};

// ---- the four surfaces ---------------------------------------------------------------------------------
//
// Batches take `threads`: the number of threads that share the batch (at least 1). Answers do not depend on
// it.

/// Neighbours of a point among points.
/// nearest: the k nearest, nearest first, ties by lower id; writes min(k, size) of them (fewer, if options
///   say so) to out, which must hold min(k, size), and returns how many. The batch writes k per query,
///   padding with no_id and infinite distance.
/// within: all at a distance ≤ radius, as real numbers, and none farther by more than rounding (a relative
///   (D + 2) / 2 units in the last place of the scalar), in no particular order unless the options ask for
///   one; within_squared: at a squared distance, as the index computes it, ≤ radius2; count_within: how many.
///   inside: ids of all in the closed box, exactly.
/// Squared distances are those of the caller's units in the tree's scalar, the same from every call for the
/// same query and point. They lose digits where they are denormal (for float at distances below some 1e-19),
/// are 0 though the distance is not where not even the least denormal number is left of them (below some
/// 2e-23), and infinite though it is finite where they overflow (above some 1e19). The ranking does not
/// suffer: points are ranked by distances of a wider range then, and ties are only those that the scalar's
/// digits could not tell apart. Radii and max_distance are true distances, and keep their meaning there;
/// within_squared compares what is told, so that radius2 = 0 also finds those whose squares vanish, and an
/// infinite one finds all. All throw InvalidInput for k = 0, a
/// negative or NaN radius, options out of range, a query that is not finite, or a box with NaN.
template <class I>
concept NeighborIndex = requires(
    const I& index, const typename I::Point& q, const typename I::Box& box, typename I::Scalar radius,
    typename I::Scalar radius2, std::size_t k, const NearestOptions<typename I::Scalar>& nearest_options,
    const WithinOptions& within_options, std::span<Neighbor<typename I::Scalar>> out,
    std::vector<Neighbor<typename I::Scalar>>& list, std::vector<Id>& ids,
    std::span<const typename I::Point> queries, std::span<const typename I::Box> boxes,
    Lists<Neighbor<typename I::Scalar>>& lists, Lists<Id>& id_lists, int threads, Work& work) {
  { index.nearest(q, k, out) } -> std::same_as<std::size_t>;
  { index.nearest(q, k, out, work) } -> std::same_as<std::size_t>;
  { index.nearest(q, k, nearest_options, out) } -> std::same_as<std::size_t>;
  { index.nearest(q, k, nearest_options, out, work) } -> std::same_as<std::size_t>;
  index.within(q, radius, list);
  index.within(q, radius, list, work);
  index.within(q, radius, within_options, list);
  index.within(q, radius, within_options, list, work);
  index.within_squared(q, radius2, list);
  { index.count_within(q, radius) } -> std::same_as<std::size_t>;
  index.inside(box, ids);
  index.inside(box, ids, work);
  index.nearest(queries, k, out, threads);
  index.nearest(queries, k, nearest_options, out, threads);
  index.within(queries, radius, lists, threads);
  index.inside(boxes, id_lists, threads);
};

/// Rays against triangles; triangles are closed sets and hit from both sides, but not by rays in their plane
/// (geometry::Exact included). A t beyond the range of the scalar is no hit, whatever t_min and t_max.
/// closest_hit: the hit of smallest t in [t_min, t_max] (ties: lower id). any_hit: whether there is one.
/// Where a ray or a mesh is so large or small that t may underflow, hits are ranked by t in the tree's own
/// unit (triangle_scale.hpp): of two that are both told a t of 0 the nearer one is first, whatever its id.
/// (u, v) of a triangle seen almost edge-on may be off, t is then still within the triangle: the point that
/// they name was found up to 2.4 % of the reach (of the triangle from the ray's origin) beside the ray's.
/// Those of geometry::Exact are the true ones, to their last place.
/// All throw InvalidInput for a ray with a NaN, an infinite origin or direction, or a zero direction.
///
/// The wide trees over triangles (bvh/wide_triangles.hpp; float only) have more than every tree has:
/// - geometry::Exact for their ray test: hits decided without an error, t rounded once; no other tree takes
///   it.
/// - closest_hit and any_hit of a span take a RayBatch: singly, streams (several rays in flight), packets
///   (sixteen neighbours together) or automatic; the answers are the same.
/// - all_hits(ray, hits): every hit in [t_min, t_max], nearest first, ties by lower id.
/// - refit(triangles or mesh, threads): the same triangles with moved corners (not for WideCompact).
/// - Bvh(triangles or mesh, options, build): with another builder, build(triangles, BinaryBuildOptions) →
///   BinaryTree: build_binned (the default), build_sweep, build_spatial, build_ploc (bvh/build_*.hpp), each
///   followed by reinserted (bvh/reinsertion.hpp) or not.
template <class I>
concept RayIndex = requires(const I& index, const typename I::Ray& ray, std::span<const typename I::Ray> rays,
                            std::span<Hit<typename I::Scalar>> hits, std::span<std::uint8_t> any, int threads,
                            Work& work) {
  { index.closest_hit(ray) } -> std::same_as<Hit<typename I::Scalar>>;
  { index.closest_hit(ray, work) } -> std::same_as<Hit<typename I::Scalar>>;
  { index.any_hit(ray) } -> std::same_as<bool>;
  { index.any_hit(ray, work) } -> std::same_as<bool>;
  index.closest_hit(rays, hits, threads);
  index.any_hit(rays, any, threads);
};

/// The nearest point of a set of triangles, if at a distance ≤ max_distance.
template <class I>
concept ClosestPointIndex = requires(const I& index, const typename I::Point& q,
                                     typename I::Scalar max_distance,
                                     std::span<const typename I::Point> queries,
                                     std::span<ClosestPoint<typename I::Scalar>> out, int threads,
                                     Work& work) {
  { index.closest_point(q) } -> std::same_as<ClosestPoint<typename I::Scalar>>;
  { index.closest_point(q, max_distance) } -> std::same_as<ClosestPoint<typename I::Scalar>>;
  { index.closest_point(q, max_distance, work) } -> std::same_as<ClosestPoint<typename I::Scalar>>;
  index.closest_point(queries, max_distance, out, threads);
};

/// Whether a point lies inside a closed, consistently oriented mesh (its surface included as far as the
/// scalar type can tell). What it answers for an open mesh is unspecified, but it answers.
template <class I>
concept VolumeIndex = requires(const I& index, const typename I::Point& q,
                               std::span<const typename I::Point> queries, std::span<std::uint8_t> out,
                               int threads) {
  { index.contains(q) } -> std::same_as<bool>;
  index.contains(queries, out, threads);
};

/// What every tree can tell of itself.
template <class I>
concept Inspectable = requires(const I& index, int axis, double offset) {
  { index.size() } -> std::same_as<std::size_t>;
  { index.bytes() } -> std::same_as<std::size_t>;
  { index.stats() } -> std::same_as<TreeStats>;
  { index.slice(axis, offset) } -> std::same_as<std::vector<SliceCell>>;
};

}  // namespace treeline::accel
