// Builder of a BSP tree over triangles: planes of any direction, chosen by the surface area heuristic.
//
// Source: Fuchs, Kedem and Naylor 1980 (planes through polygons); Ize, Wald and Parker 2008 (surface area
// heuristic, ray tracing). Candidates are axis planes at sides of sampled fragments' boxes, and planes
// through sampled triangles. Counts on either side are taken from a sample of the node's fragments, all of
// them in small nodes; areas are those of the cell itself, a polytope, but for choosing among the axis
// planes, where its box stands for it. Triangles are cut as their cell is (fragments.hpp), so that a triangle
// is referenced only where a part of it is. The builder works relative to the centre of most triangles: far
// from the origin planes stay as exact as the triangles. Planes are judged as they are stored, rounded.
//
// Depth and references are bounded as in a KD tree (kd_tree/build_triangles.hpp), and large subtrees are
// built apart as there. Cost: O(n log n). Known weakness: planes through triangles peel a convex surface one
// by one; where that would leave a side too large for the depth that remains, they are a last resort.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "accel/bsp_tree/fragments.hpp"
#include "accel/bsp_tree/polytope.hpp"
#include "accel/kd_tree/build_triangles.hpp"
#include "accel/triangle_set.hpp"

namespace treeline::accel {

struct BspTriangleOptions : BuildOptions {
  double max_references = 8;  ///< bound on references per triangle
  int axis_planes = 16;       ///< axis planes tried per axis and node, at most
  int oblique_planes = 8;     ///< planes through triangles tried per node
  int sample = 96;            ///< fragments by which candidates are compared
  double empty_bonus = 0.2;   ///< share of the cost taken off where one side is empty
  double step_cost = 5;       ///< of a node with an axis plane, in triangle tests, eight at a time
  double oblique_cost = 7.5;  ///< of a node with any other plane
  int threads = 1;            ///< that build; the tree does not depend on it
};

/// Inner: what is on the negative side of the plane is in the next node, what is on the positive side in node
/// `link`; kept is the plane as the two see it, widened: where the negative part ends and where the positive
/// part begins. Leaf: references link … link + count - 1.
template <class T>
struct BspTriangleNode {
  static constexpr std::uint32_t oblique = 3, leaf_kind = 4;  // below: an axis plane, and its axis

  geometry::Vec<T, 3> normal;  ///< of unit length
  T border[2]{};               ///< oblique: relative to the tree's centre; axis plane: the coordinate itself
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
      : set_(set),
        options_(options),
        depth_limit_(kd_depth_limit(set.items.size())),
        tasks_(options.threads) {
    check_threads(options.threads);
    check_cost("step_cost", options.step_cost);
    check_cost("oblique_cost", options.oblique_cost);
    if (!(0 <= options.empty_bonus && options.empty_bonus <= 1))
      throw InvalidInput("empty_bonus is " + std::to_string(options.empty_bonus) + "; it must be in [0, 1]");
    if (!(options.max_references >= 1)) throw InvalidInput("max_references must be at least 1");
    if (options.sample < 1 || options.axis_planes < 0 || options.oblique_planes < 0)
      throw InvalidInput("sample must be positive; axis_planes and oblique_planes must not be negative");
    const std::size_t n = set.items.size();
    if (n == 0) return;
    double widest = 0;
    for (int k = 0; k < 3; ++k) widest = std::max(widest, set.bounds.high[k] * 0.5 - set.bounds.low[k] * 0.5);
    if (widest > 0) unit_ = std::ldexp(1.0, std::ilogb(widest));
    Fragments all;
    for (std::size_t i = 0; i < n; ++i) {
      const geometry::Triangle<T>& t = set.items[i].triangle;
      const Vec3d corners[3] = {in_units(t.a), in_units(t.b), in_units(t.c)};
      double reach = 0;
      for (const Vec3d& p : corners)
        for (int k = 0; k < 3; ++k) reach = std::max(reach, std::abs(p[k]));
      all.add({static_cast<std::uint32_t>(i), 0, 0, reach}, corners, 3);
    }
    tasks_.run([&] {
      build(std::move(all), Polytope({in_units(set.bounds.low), in_units(set.bounds.high)}), 1, 0,
            options.max_references * static_cast<double>(n));
    });
    tree.nodes.shrink_to_fit();
    tree.references.shrink_to_fit();
  }

  using Node = BspTriangleNode<T>;
  TriangleBranch<Node> tree;

 private:
  using Vec3d = geometry::Vec3d;
  using Plane = geometry::Plane3d;
  // Of computed corners; what is left of a flat wall when its plane is rounded. See tolerances.hpp.
  static constexpr double on_axis_plane = 2 * geometry::tolerance::clip_slack;
  static constexpr double on_plane = double(geometry::tolerance::on_plane<T>);

  struct Split {
    double cost = std::numeric_limits<double>::infinity();
    std::uint32_t kind = Node::leaf_kind;
    T offset{};                    // as the node keeps it
    Plane plane;                   // in units; rounded to T as the node keeps it
    std::array<double, 2> area{};  // of the cell's parts

    double tolerance() const { return kind == Node::oblique ? on_plane : on_axis_plane; }
  };
  struct Part {
    Fragments fragments;
    Polytope cell;
  };

  /// For a subtree.
  explicit BspTriangleBuilder(const BspTriangleBuilder* whole)
      : set_(whole->set_),
        options_(whole->options_),
        depth_limit_(whole->depth_limit_),
        tasks_(whole->tasks_),
        unit_(whole->unit_) {}

  // In units of a power of two near half the widest extent, so that nothing overflows.
  double in_units(T x, int axis) const {
    return (static_cast<double>(x) * 0.5 - static_cast<double>(set_.centre[axis]) * 0.5) * (2 / unit_);
  }
  Vec3d in_units(const geometry::Vec<T, 3>& p) const {
    return {in_units(p[0], 0), in_units(p[1], 1), in_units(p[2], 2)};
  }

  /// Returns the reach from the centre of the triangles referenced.
  T build(Fragments&& all, const Polytope& cell, double share, std::size_t level, double budget) {
    const std::size_t n = all.size();
    const double whole = cell.area();
    Split split;
    if (level < depth_limit_ && n > 1 && whole > 0) split = best_split(all, cell, whole, level);
    Fragments parts[2];
    if (split.kind != Node::leaf_kind) part(all, split.plane, split.tolerance(), parts);
    if (!worthwhile(split, whole, n, parts[0].size(), parts[1].size(), budget))
      return add_leaf(all, share, level);
    Fragments().items.swap(all.items), Fragments().corners.swap(all.corners);

    const std::size_t here = tree.nodes.size();
    tree.nodes.emplace_back();
    tree.nodes[here].normal = geometry::Vec<T, 3>(split.plane.normal);
    tree.nodes[here].kind = split.kind;
    tree.oblique_nodes += split.kind == Node::oblique;
    tree.cost += share;
    const double below = static_cast<double>(parts[0].size()), above = static_cast<double>(parts[1].size());
    const double below_budget = budget * (below / (below + above));
    auto cells = cell.cut(split.plane);
    T reach_of_side[2];
    const auto build_side = [&](BspTriangleBuilder& into, int side) {
      const double part_of_share = share * std::min(1.0, split.area[side] / whole);
      reach_of_side[side] = into.build(std::move(parts[side]), std::exchange(cells[side], {}), part_of_share,
                                       level + 1, side == 0 ? below_budget : budget - below_budget);
    };
    if (n >= BuildTasks::worth_a_task) {
      BspTriangleBuilder side[2] = {BspTriangleBuilder(this), BspTriangleBuilder(this)};
      tasks_.both(
          n, [&] { build_side(side[0], 0); }, [&] { build_side(side[1], 1); });
      tree.append(std::move(side[0].tree));
      tree.nodes[here].link = static_cast<std::uint32_t>(tree.nodes.size());
      tree.append(std::move(side[1].tree));
    } else {
      build_side(*this, 0);
      tree.nodes[here].link = static_cast<std::uint32_t>(tree.nodes.size());
      build_side(*this, 1);
    }
    const T reach = std::max(reach_of_side[0], reach_of_side[1]);
    const T slack = split.kind == Node::oblique
                        ? geometry::tolerance::oblique_slack<T> / geometry::tolerance::stored_slack<T>
                        : T(2);  // corners of fragments are computed, too
    const Widened<T> border(split.offset, split.offset, slack * reach);
    tree.nodes[here].border[0] = border.high, tree.nodes[here].border[1] = border.low;
    return reach;
  }

  double split_cost(const Split& split, double whole, double below, double above) const {
    const double tests = (split.area[0] * below + split.area[1] * above) / whole;
    return (split.kind == Node::oblique ? options_.oblique_cost : options_.step_cost) +
           (below == 0 || above == 0 ? (1 - options_.empty_bonus) * tests : tests);
  }

  bool worthwhile(const Split& split, double whole, std::size_t n, std::size_t below, std::size_t above,
                  double budget) const {
    if (below + above == 0 || static_cast<double>(below + above) > budget) return false;
    if (split_cost(split, whole, static_cast<double>(below), static_cast<double>(above)) <
        static_cast<double>(n))
      return true;
    return n > static_cast<std::size_t>(options_.leaf_size) && below < n && above < n &&
           below + above <= n + n / 2;
  }

  T add_leaf(const Fragments& all, double share, std::size_t level) {
    if (tree.references.size() + all.size() > 0xffffffffu)
      throw InvalidInput("more than 2^32 references; lower max_references");
    Node& leaf = tree.nodes.emplace_back();
    leaf.link = static_cast<std::uint32_t>(tree.references.size());
    leaf.count = static_cast<std::uint32_t>(all.size());
    T reach = 0;
    for (const Fragment& f : all.items) {
      tree.references.push_back(f.triangle);
      reach = std::max(reach, reach_of(set_.centre, set_.items[f.triangle].triangle.box()));
    }
    ++tree.leaves;
    tree.depth = std::max(tree.depth, level);
    tree.largest_leaf = std::max(tree.largest_leaf, all.size());
    tree.cost += share * static_cast<double>(all.size());
    return reach;
  }

  Split best_split(const Fragments& all, const Polytope& cell, double whole, std::size_t level) {
    const std::size_t m = std::min(all.size(), static_cast<std::size_t>(options_.sample));
    sample_.clear(), boxes_.clear();
    for (std::size_t i = 0; i < m; ++i) {
      sample_.push_back(all.items[i * all.size() / m]);
      boxes_.push_back(all.box(sample_.back()));
    }
    // A side that could not be halved down to leaves within the depth limit is a last resort: planes that
    // peel triangles off a convex surface one by one look cheap each, and lead nowhere.
    const double room = std::exp2(static_cast<double>(depth_limit_ - level - 1) / 1.3) * options_.leaf_size;
    const double each = static_cast<double>(all.size()) / static_cast<double>(m);
    Split best, last_resort;
    const auto offer = [&](Split split) {
      split.area = cell.areas(split.plane);
      if (!(split.area[0] > 0 && split.area[1] > 0)) return;
      double below = 0, above = 0;
      for (const Fragment& f : sample_) {
        const Sides to = sides(all, f, split.plane, split.tolerance());
        below += to.negative, above += to.positive;
      }
      split.cost = split_cost(split, whole, below * each, above * each);
      Split& rival = std::max(below, above) * each <= room ? best : last_resort;
      if (split.cost < rival.cost) rival = split;
    };
    find_gaps(all);
    const geometry::Box3d box = cell.box();
    for (int axis = 0; axis < 3; ++axis) {
      const Split split = best_axis_plane(box, axis, each);
      if (split.kind != Node::leaf_kind) offer(split);
    }
    double reach = 0;
    for (const Fragment& f : all.items) reach = std::max(reach, f.reach);
    offer_triangle_planes(double(geometry::tolerance::oblique_slack<T>) * reach, offer);
    return best.kind != Node::leaf_kind ? best : last_resort;
  }

  /// What a sample overlooks: where along each axis the fragments begin and end, and the widest gap between
  /// them; beyond and within is empty space.
  void find_gaps(const Fragments& all) {
    constexpr std::size_t bins = 32;
    geometry::Box3d filled;
    for (const Vec3d& p : all.corners) filled.grow(p);
    for (int axis = 0; axis < 3; ++axis) {
      gaps_[axis] = {filled.low[axis], filled.high[axis]};
      const double scale = double(bins) / (filled.high[axis] - filled.low[axis]);
      if (!std::isfinite(scale) || all.size() <= sample_.size()) continue;
      std::array<double, bins> low, high;
      low.fill(std::numeric_limits<double>::infinity()), high.fill(-low[0]);
      for (const Fragment& f : all.items) {
        double from = std::numeric_limits<double>::infinity(), to = -from;
        for (std::uint32_t i = 0; i < f.count; ++i) {
          const double x = all.polygon(f)[i][axis];
          from = std::min(from, x), to = std::max(to, x);
        }
        const auto bin = std::min(bins - 1, static_cast<std::size_t>((from - filled.low[axis]) * scale));
        low[bin] = std::min(low[bin], from), high[bin] = std::max(high[bin], to);
      }
      double reached = high[0], widest = 0;
      std::array<double, 2> gap{filled.low[axis], filled.high[axis]};
      for (std::size_t i = 1; i < bins; ++i) {
        if (std::isfinite(low[i]) && low[i] - reached > widest)
          widest = low[i] - reached, gap = {reached, low[i]};
        reached = std::max(reached, high[i]);
      }
      gaps_[axis].insert(gaps_[axis].end(), gap.begin(), gap.end());
    }
  }

  /// By the cell's box and the fragments' boxes.
  Split best_axis_plane(const geometry::Box3d& cell, int axis, double each) {
    planes_.clear(), lows_.clear(), highs_.clear();
    const auto offer = [&](double x) {
      if (cell.low[axis] < x && x < cell.high[axis]) planes_.push_back(x);
    };
    for (const geometry::Box3d& b : boxes_) {
      lows_.push_back(b.low[axis]), highs_.push_back(b.high[axis]);
      offer(b.low[axis]), offer(b.high[axis]);
    }
    std::sort(planes_.begin(), planes_.end());
    planes_.erase(std::unique(planes_.begin(), planes_.end()), planes_.end());
    std::sort(lows_.begin(), lows_.end()), std::sort(highs_.begin(), highs_.end());
    const std::size_t count = std::min(static_cast<std::size_t>(options_.axis_planes), planes_.size());
    for (std::size_t i = 0; i < count; ++i)
      planes_[i] = planes_[count > 1 ? i * (planes_.size() - 1) / (count - 1) : 0];
    planes_.resize(count);
    for (const double x : gaps_[axis]) offer(x);
    Split best;
    const double whole = surface_area(cell);
    for (const double at : planes_) {
      Split split;
      split.kind = static_cast<std::uint32_t>(axis);
      split.offset = static_cast<T>(at * unit_ + static_cast<double>(set_.centre[axis]));
      split.plane.normal[axis] = 1;
      split.plane.offset = in_units(split.offset, axis);
      geometry::Box3d parts[2] = {cell, cell};
      parts[0].high[axis] = parts[1].low[axis] = split.plane.offset;
      split.area = {surface_area(parts[0]), surface_area(parts[1])};
      const auto below = std::lower_bound(lows_.begin(), lows_.end(), split.plane.offset) - lows_.begin();
      const auto above = highs_.end() - std::upper_bound(highs_.begin(), highs_.end(), split.plane.offset);
      split.cost =
          split_cost(split, whole, static_cast<double>(below) * each, static_cast<double>(above) * each);
      if (split.cost < best.cost) best = split;
    }
    return best;
  }

  /// A plane that rays see blurred by more than the size of its triangle (because a triangle far away is
  /// among the fragments) would tell nothing apart.
  template <class Offer>
  void offer_triangle_planes(double blur, Offer&& offer) {
    const std::size_t count = std::min(sample_.size(), static_cast<std::size_t>(options_.oblique_planes));
    for (std::size_t i = 0; i < count; ++i) {
      const geometry::Triangle<T>& t = set_.items[sample_[i * sample_.size() / count].triangle].triangle;
      const Vec3d a = in_units(t.a), normal = cross(in_units(t.b) - a, in_units(t.c) - a);
      const double size = length(normal);
      if (!(size > blur * blur)) continue;
      Split split;
      split.kind = Node::oblique;
      split.plane.normal = Vec3d(geometry::Vec<T, 3>(normal / size));
      split.offset = static_cast<T>(dot(split.plane.normal, a) * unit_);
      split.plane.offset = static_cast<double>(split.offset) / unit_;
      const Vec3d& stored = split.plane.normal;
      if (std::max({std::abs(stored[0]), std::abs(stored[1]), std::abs(stored[2])}) < 1)
        offer(split);  // a triangle that lies across an axis has axis planes at its sides
    }
  }

  const TriangleSet<T>& set_;
  BspTriangleOptions options_;
  std::size_t depth_limit_;
  BuildTasks tasks_;
  double unit_ = 1;
  std::vector<Fragment> sample_;  // of the node being split, and their boxes
  std::vector<geometry::Box3d> boxes_;
  std::vector<double> planes_, lows_, highs_;  // along one axis of it
  std::array<std::vector<double>, 3> gaps_;
};

}  // namespace treeline::accel
