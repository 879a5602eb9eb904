// Inside or outside by the side of what a ray first meets: the default for closed meshes.
//
// Method: the first face that a ray from the point meets is met from behind if and only if the point is
// inside; a ray that meets nothing began outside. Over the wide tree every step is exact
// (bvh/wide_crossing.hpp): a ray whose first crossing is an edge, a corner or several faces that look both
// ways gives no answer, and another direction is tried; after many, all crossings of a ray are counted with
// their signs. A ray runs towards the outside of the mesh's box, by the octant of the point, so that it meets
// something early or nothing at all. Over the other trees it is their contains(): rays in their own
// arithmetic, whose hits near edges or at grazing incidence have no vote (accel/volume.hpp).
//
// Exact means of the triangles that the tree keeps: those of a mesh whose typical coordinate is far from 1
// are scaled, and coordinates below 2^-149 of the typical one vanish then (triangle_scale.hpp): small parts
// of a mesh of mixed scale may be flat, or gone, for every query. Needs a closed, consistently oriented mesh
// that does not cross itself. With others it answers by the first face met: rays that leave by a hole call a
// point outside, faces turned around call the points near them wrong, a mesh inside out has the complement
// inside, and between two shells that face the same way points are called outside. Cost: one ray that ends at
// the first hit.
#pragma once

#include <array>

#include "accel/bvh/wide_crossing.hpp"
#include "accel/signed_distance/each_query.hpp"
#include "geometry/random.hpp"
#include "geometry/sampling.hpp"

namespace treeline::accel {

namespace detail {
template <class Tree>
inline constexpr bool is_wide = false;
template <class Policy, wide::TriangleLayout Layout>
inline constexpr bool is_wide<Bvh<Triangles<float, Policy>, Layout>> = true;
}  // namespace detail

/// Trees on which crossings are decided exactly.
template <class Tree>
concept ExactCrossings = detail::is_wide<Tree>;

/// The directions in which rays from a point are cast: the first outward by its octant about the middle of
/// the mesh, then random ones, the same for every point.
class ProbeDirections {
 public:
  using Point = geometry::Vec<float, 3>;
  /// Tried before a rule gives up: enough for any mesh on which a random ray meets an edge less often than
  /// not.
  static constexpr int most = 24;

  ProbeDirections() = default;
  explicit ProbeDirections(const Point& middle) : middle_(middle) {
    for (int i = 0; i < most; ++i)
      random_[static_cast<std::size_t>(i)] =
          Point(geometry::sample_sphere(geometry::uniform_at(7, 2 * static_cast<std::uint64_t>(i)),
                                        geometry::uniform_at(7, 2 * static_cast<std::uint64_t>(i) + 1)));
  }
  Point operator()(const Point& from, int attempt) const {
    if (attempt > 0) return random_[static_cast<std::size_t>(attempt)];
    // No two components of simple ratio, so that no face of a regular mesh is seen edge-on.
    constexpr float step[3] = {0.4813f, 0.3607f, 0.7989f};
    Point d;
    for (int k = 0; k < 3; ++k) d[k] = std::copysign(step[k], from[k] - middle_[k]);
    return d;
  }

 private:
  Point middle_{};
  std::array<Point, most> random_{};
};

struct FirstHit {
  struct Options {};

  template <class Tree>
  class Rule;
};

/// Over trees of double and over binary ones.
template <class Tree>
class FirstHit::Rule {
  static_assert(VolumeIndex<Tree>, "FirstHit needs a tree that answers contains()");

 public:
  using Mesh = geometry::Mesh<typename Tree::Scalar>;
  Rule(const Mesh&, const Tree&, const Options&, int /*threads*/) {}
  static constexpr std::size_t bytes() { return 0; }
  bool inside(const Tree& tree, const typename Tree::Point& q) const { return tree.contains(q); }
  void inside(const Tree& tree, std::span<const typename Tree::Point> queries, std::span<std::uint8_t> out,
              int threads) const {
    tree.contains(queries, out, threads);
  }
};

template <ExactCrossings Tree>
class FirstHit::Rule<Tree> {
 public:
  using Point = typename Tree::Point;
  using Mesh = geometry::Mesh<float>;

  Rule(const Mesh&, const Tree& tree, const Options&, int /*threads*/)
      : box_(tree.bounds()), directions_(box_.empty() ? Point{} : box_.centre()) {}
  static constexpr std::size_t bytes() { return 0; }

  bool inside(const Tree& tree, const Point& q) const {
    if (!box_.contains(q)) return false;
    const wide::Crossings<Tree> crossings(tree);
    const FirstCrossing first = crossings.first({q, directions_(q, 0)});
    return first == FirstCrossing::unclear ? tried_again(crossings, q) : says(first);
  }
  void inside(const Tree& tree, std::span<const Point> queries, std::span<std::uint8_t> out,
              int threads) const {
    const wide::Crossings<Tree> crossings(tree);
    check_threads(threads);
    std::vector<std::uint32_t> within = asking_order(queries, threads);  // the others need no ray
    std::fill(out.begin(), out.end(), std::uint8_t{0});
    std::erase_if(within, [&](std::uint32_t i) { return !box_.contains(queries[i]); });
    crossings.firsts(
        within.size(), threads,
        [&](std::size_t i) {
          const Point& q = queries[within[i]];
          return geometry::Ray<float>{q, directions_(q, 0)};
        },
        [&](std::size_t i, FirstCrossing first) {
          const std::size_t at = within[i];
          out[at] = first == FirstCrossing::unclear ? tried_again(crossings, queries[at]) : says(first);
        });
  }

 private:
  static bool says(FirstCrossing first) {
    return first == FirstCrossing::outward || first == FirstCrossing::surface;
  }
  [[gnu::noinline, gnu::cold]] bool tried_again(const wide::Crossings<Tree>& crossings,
                                                const Point& q) const {
    for (int attempt = 1; attempt < ProbeDirections::most; ++attempt)
      if (const auto first = crossings.first({q, directions_(q, attempt)}); first != FirstCrossing::unclear)
        return says(first);
    // Every way out leads through faces that lie in one another: count what remains of them.
    CrossingCount count;
    for (int attempt = 0; attempt < ProbeDirections::most; ++attempt) {
      count = crossings.count({q, directions_(q, attempt)});
      if (count.surface || !count.unclear) break;
    }
    return count.surface || count.outward > count.inward;
  }

  geometry::Box<float, 3> box_;
  ProbeDirections directions_;
};

}  // namespace treeline::accel
