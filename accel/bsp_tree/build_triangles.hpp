// Builder of a BSP tree over triangles: planes of any direction, chosen by the surface area heuristic.
//
// Source: Fuchs, Kedem and Naylor 1980 (planes through polygons); Ize, Wald and Parker 2008 (surface area
// heuristic, ray tracing). Candidates are axis planes at sides of sampled triangles' boxes, and planes
// through sampled triangles. Counts on either side are estimated from a sample of the node's triangles; a
// cell is measured as if it were the box around it (box_cut.hpp), so costs are estimates. Coordinates are
// taken relative to the centre of all triangles: far from the origin planes stay as exact as the triangles.
//
// Sides: corners within on_plane of a plane count as on it. A triangle is referenced where it has a corner
// clearly on that side; one that lies in the plane goes to the positive side. Triangles are not cut: a
// reference stands for the whole triangle. Depth and references are bounded as in a KD tree
// (kd_tree/build_triangles.hpp). Cost: O(n log n). Known weakness: large triangles reach into many cells.
#pragma once

#include <cstdint>
#include <vector>

#include "accel/bsp_tree/box_cut.hpp"
#include "accel/kd_tree/build_triangles.hpp"
#include "accel/triangle_set.hpp"
#include "geometry/plane.hpp"
#include "geometry/tolerances.hpp"

namespace treeline::accel {

struct BspTriangleOptions : BuildOptions {
  double max_references = 8;  ///< bound on references per triangle
  int axis_planes = 16;       ///< axis planes tried per axis and node, at most
  int oblique_planes = 4;     ///< planes through triangles tried per node
  int sample = 96;            ///< triangles by which candidates are compared
  double empty_bonus = 0.2;   ///< share of the cost taken off where one side is empty
  double step_cost = 1.2;     ///< of a node, in triangle tests
};

/// Inner: the negative side of the plane is the next node, the positive side node `link`.
/// Leaf: references link … link + count - 1.
template <class T>
struct BspTriangleNode {
  static constexpr std::uint32_t oblique = 3, leaf_kind = 4;  // below: an axis plane, and its axis

  geometry::Vec<T, 3> normal;  ///< of unit length
  T offset{};                  ///< oblique: relative to the tree's centre; axis plane: the coordinate itself
  std::uint32_t link = 0;
  std::uint32_t kind : 3 = leaf_kind;
  std::uint32_t count : 29 = 0;

  bool leaf() const { return kind == leaf_kind; }
  bool axis_plane() const { return kind < oblique; }
};

template <class T>
class BspTriangleBuilder {
 public:
  BspTriangleBuilder(const TriangleSet<T>& set, const BspTriangleOptions& options)
      : set_(set), options_(options), depth_limit_(kd_depth_limit(set.items.size())) {
    if (!(options.max_references >= 1)) throw InvalidInput("max_references must be at least 1");
    if (options.sample < 1 || options.axis_planes < 0 || options.oblique_planes < 0)
      throw InvalidInput("sample must be positive; axis_planes and oblique_planes must not be negative");
    const std::size_t n = set.items.size();
    if (n == 0) return;
    centre = set.bounds.centre();
    T widest = 0;
    for (int k = 0; k < 3; ++k)
      widest = std::max(widest, set.bounds.high[k] * T(0.5) - set.bounds.low[k] * T(0.5));
    radius = widest * T(1.7321);
    if (widest > T(0)) unit_ = static_cast<double>(widest);
    std::vector<std::uint32_t> refs(n);
    for (std::size_t i = 0; i < n; ++i) refs[i] = static_cast<std::uint32_t>(i);
    build(std::move(refs), {in_units(set.bounds.low), in_units(set.bounds.high)}, 1, 0,
          options.max_references * static_cast<double>(n));
    nodes.shrink_to_fit();
    references.shrink_to_fit();
  }

  geometry::Vec<T, 3> centre{};
  T radius = 0;  // no triangle is farther from the centre
  std::vector<BspTriangleNode<T>> nodes;
  std::vector<std::uint32_t> references;  // indices into the set's items
  std::size_t leaves = 0, depth = 0, largest_leaf = 0;
  double cost = 0;

 private:
  using Vec3d = geometry::Vec3d;
  using Plane = geometry::Plane3d;
  using Corners = std::array<Vec3d, 3>;
  using Refs = std::vector<std::uint32_t>;
  using Box = geometry::Box<T, 3>;
  using Node = BspTriangleNode<T>;
  struct Sides {
    bool negative, positive;
  };
  struct Split {
    double cost = std::numeric_limits<double>::infinity();
    std::uint32_t kind = Node::leaf_kind;
    T offset{};                  // of an axis plane
    Plane plane;                 // in units; as the node will store it, rounded to T
    std::array<double, 2> area;  // of the cell's parts
  };
  struct Sample {
    Corners corners;
    Box box;
  };

  // The builder works relative to the centre and in units of half the widest extent, so that nothing
  // overflows.
  double in_units(T x, int axis) const {
    return (static_cast<double>(x) * 0.5 - static_cast<double>(centre[axis]) * 0.5) * (2 / unit_);
  }
  Vec3d in_units(const geometry::Vec<T, 3>& p) const {
    return {in_units(p[0], 0), in_units(p[1], 1), in_units(p[2], 2)};
  }
  Corners corners(std::uint32_t i) const {
    const geometry::Triangle<T>& t = set_.items[i].triangle;
    return {in_units(t.a), in_units(t.b), in_units(t.c)};
  }
  /// What remains of a plane when it is stored.
  Plane stored(const Plane& p) const {
    return {Vec3d(geometry::Vec<T, 3>(p.normal)),
            static_cast<double>(static_cast<T>(p.offset * unit_)) / unit_};
  }

  static Sides sides(const Corners& corners, const Plane& plane) {
    constexpr double on_plane = 1.7321 * double(geometry::tolerance::on_plane<T>);
    const double d[3] = {plane.signed_distance(corners[0]), plane.signed_distance(corners[1]),
                         plane.signed_distance(corners[2])};
    const bool negative = std::min({d[0], d[1], d[2]}) < -on_plane;
    return {negative, !negative || std::max({d[0], d[1], d[2]}) > on_plane};
  }
  static Sides sides(const Box& box, int axis, T offset) {
    const bool positive = box.high[axis] > offset;
    return {box.low[axis] < offset || !positive, positive};
  }
  Sides sides(std::uint32_t i, const Split& split) const {
    if (split.kind == Node::oblique) return sides(corners(i), split.plane);
    return sides(set_.items[i].triangle.box(), static_cast<int>(split.kind), split.offset);
  }

  void build(Refs&& refs, const geometry::Box3d& cell, double share, std::size_t level, double budget) {
    const std::size_t n = refs.size();
    Split split;
    if (level < depth_limit_ && n > 1) split = best_split(refs, cell, level);
    Refs part[2];
    if (split.kind != Node::leaf_kind) {
      for (const std::uint32_t i : refs) {
        const Sides s = sides(i, split);
        if (s.negative) part[0].push_back(i);
        if (s.positive) part[1].push_back(i);
      }
    }
    const double whole = surface_area(cell);
    if (!worthwhile(split, whole, n, part[0].size(), part[1].size(), budget))
      return add_leaf(refs, share, level);
    Refs().swap(refs);

    const std::size_t here = nodes.size();
    Node& node = nodes.emplace_back();
    node.normal = geometry::Vec<T, 3>(split.plane.normal);
    node.offset = split.kind == Node::oblique ? static_cast<T>(split.plane.offset * unit_) : split.offset;
    node.kind = split.kind;
    cost += share;
    const double below = static_cast<double>(part[0].size()), above = static_cast<double>(part[1].size());
    const double below_budget = budget * (below / (below + above));
    const BoxCut parts = cut(cell, split.plane);
    const auto part_of_share = [&](int side) { return share * std::min(1.0, split.area[side] / whole); };
    build(std::move(part[0]), parts.bounds[0], part_of_share(0), level + 1, below_budget);
    nodes[here].link = static_cast<std::uint32_t>(nodes.size());
    build(std::move(part[1]), parts.bounds[1], part_of_share(1), level + 1, budget - below_budget);
  }

  double split_cost(const std::array<double, 2>& area, double whole, double below, double above) const {
    const double tests = (area[0] * below + area[1] * above) / whole;
    return options_.step_cost + (below == 0 || above == 0 ? (1 - options_.empty_bonus) * tests : tests);
  }

  bool worthwhile(const Split& split, double whole, std::size_t n, std::size_t below, std::size_t above,
                  double budget) const {
    if (below + above == 0 || static_cast<double>(below + above) > budget) return false;
    if (split_cost(split.area, whole, static_cast<double>(below), static_cast<double>(above)) <
        static_cast<double>(n))
      return true;
    return n > static_cast<std::size_t>(options_.leaf_size) && below < n && above < n &&
           below + above <= n + n / 2;
  }

  void add_leaf(const Refs& refs, double share, std::size_t level) {
    if (references.size() + refs.size() > 0xffffffffu)
      throw InvalidInput("more than 2^32 references; lower max_references");
    Node& leaf = nodes.emplace_back();
    leaf.link = static_cast<std::uint32_t>(references.size());
    leaf.count = static_cast<std::uint32_t>(refs.size());
    references.insert(references.end(), refs.begin(), refs.end());
    ++leaves;
    depth = std::max(depth, level);
    largest_leaf = std::max(largest_leaf, refs.size());
    cost += share * static_cast<double>(refs.size());
  }

  Split best_split(const Refs& refs, const geometry::Box3d& cell, std::size_t level) {
    const double whole = surface_area(cell);
    if (!(whole > 0)) return {};
    const std::size_t m = std::min(refs.size(), static_cast<std::size_t>(options_.sample));
    sample_.clear();
    for (std::size_t i = 0; i < m; ++i) {
      const std::uint32_t ref = refs[i * refs.size() / m];
      sample_.push_back({corners(ref), set_.items[ref].triangle.box()});
    }

    // A side that could not be halved down to leaves within the depth limit is a last resort: planes that
    // peel triangles off a convex surface one by one look cheap each, and lead nowhere.
    const double room = std::exp2(static_cast<double>(depth_limit_ - level - 1) / 1.3) * options_.leaf_size;
    Split best, last_resort;
    const double each = static_cast<double>(refs.size()) / static_cast<double>(m);
    const auto offer = [&](Split split, auto&& sides_of) {
      if (!(split.area[0] > 0 && split.area[1] > 0)) return;
      double below = 0, above = 0;
      for (const Sample& s : sample_) {
        const Sides on = sides_of(s);
        below += on.negative, above += on.positive;
      }
      split.cost = split_cost(split.area, whole, below * each, above * each);
      Split& rival = std::max(below, above) * each <= room ? best : last_resort;
      if (split.cost < rival.cost) rival = split;
    };
    offer_axis_planes(cell, offer);
    offer_triangle_planes(cell, offer);
    return best.kind != Node::leaf_kind ? best : last_resort;
  }

  template <class Offer>
  void offer_axis_planes(const geometry::Box3d& cell, Offer&& offer) {
    for (int axis = 0; axis < 3; ++axis) {
      const auto inside = [&](T x) {
        const double at = in_units(x, axis);
        return cell.low[axis] < at && at < cell.high[axis];
      };
      planes_.clear();
      for (const Sample& s : sample_)
        for (const T x : {s.box.low[axis], s.box.high[axis]})
          if (inside(x)) planes_.push_back(x);
      std::sort(planes_.begin(), planes_.end());
      planes_.erase(std::unique(planes_.begin(), planes_.end()), planes_.end());
      const std::size_t count = std::min(static_cast<std::size_t>(options_.axis_planes), planes_.size());
      for (std::size_t i = 0; i < count; ++i) {
        Split split;
        split.kind = static_cast<std::uint32_t>(axis);
        split.offset = planes_[count > 1 ? i * (planes_.size() - 1) / (count - 1) : 0];
        split.plane.normal[axis] = 1;
        split.plane.offset = in_units(split.offset, axis);
        geometry::Box3d below = cell, above = cell;
        below.high[axis] = above.low[axis] = split.plane.offset;
        split.area = {surface_area(below), surface_area(above)};
        offer(split, [&](const Sample& s) { return sides(s.box, axis, split.offset); });
      }
    }
  }

  template <class Offer>
  void offer_triangle_planes(const geometry::Box3d& cell, Offer&& offer) {
    const std::size_t count = std::min(sample_.size(), static_cast<std::size_t>(options_.oblique_planes));
    for (std::size_t i = 0; i < count; ++i) {
      const Corners& c = sample_[i * sample_.size() / count].corners;
      const Vec3d normal = cross(c[1] - c[0], c[2] - c[0]);
      const double size = length(normal);
      if (!(size > 0)) continue;
      Split split;
      split.kind = Node::oblique;
      split.plane = stored({normal / size, dot(normal / size, c[0])});
      split.area = cut(cell, split.plane).area;
      offer(split, [&](const Sample& s) { return sides(s.corners, split.plane); });
    }
  }

  const TriangleSet<T>& set_;
  BspTriangleOptions options_;
  std::size_t depth_limit_;
  double unit_ = 1;
  std::vector<Sample> sample_;  // of the node being split
  std::vector<T> planes_;       // of one axis of it
};

}  // namespace treeline::accel
