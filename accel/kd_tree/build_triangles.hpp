// Builder of a KD tree over triangles by the surface area heuristic (MacDonald and Booth 1990; Wald and
// Havran 2006).
//
// Every side of every triangle's box is a candidate plane. The sides are sorted once, into one list of events
// an axis, where a box ends, lies in the plane or starts, in that order at equal places; a node finds its
// best plane by one walk along each list, and splits the lists for its children without sorting them again.
// Only triangles that straddle the plane get new events: a triangle is referenced on both sides by the box of
// the part of it that lies there, and those few events are sorted and merged in. A triangle that lies in the
// plane goes to the side where it costs less, and to no other.
//
// Three bounds hold whatever the input: the depth (8 + 1.3 log2 n; Wald and Havran), the number of references
// (max_references times n: a node whose children would exceed its share of them becomes a leaf), and a node
// is not split unless both children are smaller than it or one is empty. Cost: O(n log n), and 50 bytes a
// triangle while it builds. Known weakness: large triangles among small ones are referenced often.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "accel/clip_triangle.hpp"
#include "accel/padded_ray.hpp"
#include "accel/triangle_set.hpp"
#include "geometry/tolerances.hpp"

namespace treeline::accel {

struct KdTriangleOptions : BuildOptions {
  double max_references = 8;  ///< bound on references per triangle
  bool clip = true;           ///< reference by the part of a triangle in the cell, not by all of its box
  double empty_bonus = 0.2;   ///< share of the cost taken off where one side is empty
  double step_cost = 5;       ///< of a node, in triangle tests, which go eight at a time
};

/// Inner: what is below the plane is in the next node, what is above in node `link`; kept is the plane as the
/// two see it, widened (padded_ray.hpp): where the part below ends and where the part above begins.
/// Leaf: references link … link + count - 1.
template <class T>
struct KdTriangleNode {
  static constexpr std::uint32_t leaf_axis = 3;

  T border[2]{};
  std::uint32_t link = 0;
  std::uint32_t axis : 2 = leaf_axis;
  std::uint32_t count : 30 = 0;

  bool leaf() const { return axis == leaf_axis; }
};

/// Depth that no KD or BSP tree over n triangles exceeds.
inline std::size_t kd_depth_limit(std::size_t n) {
  return static_cast<std::size_t>(8 + 1.3 * std::log2(static_cast<double>(std::max<std::size_t>(n, 1))));
}
/// Enough for kd_depth_limit of as many triangles as there are ids.
inline constexpr std::size_t kd_stack_size = 64;

template <class T>
class KdTriangleBuilder {
 public:
  KdTriangleBuilder(const TriangleSet<T>& set, const KdTriangleOptions& options)
      : set_(set), options_(options), depth_limit_(kd_depth_limit(set.items.size())) {
    if (!(options.max_references >= 1)) throw InvalidInput("max_references must be at least 1");
    const std::size_t n = set.items.size();
    if (n == 0) return;
    double widest = 0;
    for (int k = 0; k < 3; ++k) widest = std::max(widest, set.bounds.high[k] * 0.5 - set.bounds.low[k] * 0.5);
    if (widest > 0) unit_ = 1 / widest;
    root_measure_ = measure(set.bounds);
    if (n > max_parts) throw InvalidInput(std::to_string(n) + " triangles; a KD tree takes 2^30");
    Lists lists;
    for (auto& list : lists) list.reserve(2 * n);
    for (std::size_t i = 0; i < n; ++i) {
      parts_.push_back({set.items[i].triangle.box(), static_cast<std::uint32_t>(i)});
      append_events(static_cast<std::uint32_t>(i), lists);
    }
    for (auto& list : lists) std::sort(list.begin(), list.end());
    side_.resize(n);
    build(std::move(lists), n, set.bounds, 0, options.max_references * static_cast<double>(n));
    nodes.shrink_to_fit();
    references.shrink_to_fit();
  }

  std::vector<KdTriangleNode<T>> nodes;
  std::vector<std::uint32_t> references;  // indices into the set's items
  std::size_t leaves = 0, depth = 0, largest_leaf = 0;
  double cost = 0;

 private:
  using Box = geometry::Box<T, 3>;
  static constexpr std::size_t max_parts = std::size_t{1} << 30;

  /// The part of a triangle that lies in a cell, by its box.
  struct Part {
    Box box;
    std::uint32_t triangle;
  };
  struct Event {
    enum Kind : std::uint32_t { end, planar, start };

    T at;
    std::uint32_t kind : 2;
    std::uint32_t part : 30;

    bool operator<(const Event& o) const { return at < o.at || (at == o.at && kind < o.kind); }
  };
  using Lists = std::array<std::vector<Event>, 3>;  // an axis each
  enum Side : std::uint8_t { both, below, above };
  struct Split {
    double cost = std::numeric_limits<double>::infinity();
    int axis = -1;
    T offset{};
    bool planar_below = false;         // where parts go that lie in the plane
    std::size_t below = 0, above = 0;  // parts on either side
  };

  double extent(const Box& b, int axis) const { return (b.high[axis] * 0.5 - b.low[axis] * 0.5) * unit_; }
  /// Surface area in units of the root's size, in which nothing overflows; of a flat box too.
  double measure(const Box& b) const {
    const double e[3] = {extent(b, 0), extent(b, 1), extent(b, 2)};
    return e[0] * e[1] + e[1] * e[2] + e[2] * e[0] + 1e-9 * (e[0] + e[1] + e[2]);
  }

  /// Returns the reach from the centre of the triangles referenced.
  T build(Lists&& lists, std::size_t n, const Box& cell, std::size_t level, double budget) {
    const Split split = level < depth_limit_ && n > 1 ? best_split(lists, n, cell) : Split{};
    if (!worthwhile(split, n, budget)) return add_leaf(lists[0], n, cell, level);

    const std::size_t here = nodes.size();
    nodes.emplace_back();
    nodes[here].axis = static_cast<std::uint32_t>(split.axis);
    if (root_measure_ > 0) cost += measure(cell) / root_measure_;
    Box below_cell = cell, above_cell = cell;
    below_cell.high[split.axis] = above_cell.low[split.axis] = split.offset;

    choose_sides(lists[static_cast<std::size_t>(split.axis)], split);
    Lists to_below, to_above;
    hand_down(lists, split, to_below, to_above);
    std::size_t n_below = split.below, n_above = split.above;
    cut_straddling(lists[0], below_cell, above_cell, to_below, to_above, n_below, n_above);
    for (auto& list : lists) std::vector<Event>().swap(list);

    const double total = static_cast<double>(n_below + n_above);
    const double below_budget = budget * (static_cast<double>(n_below) / std::max(total, 1.0));
    const T reach_below = build(std::move(to_below), n_below, below_cell, level + 1, below_budget);
    nodes[here].link = static_cast<std::uint32_t>(nodes.size());
    const T reach_above = build(std::move(to_above), n_above, above_cell, level + 1, budget - below_budget);
    const T reach = std::max(reach_below, reach_above);
    const Widened<T> plane(split.offset, split.offset, reach);
    nodes[here].border[0] = plane.high, nodes[here].border[1] = plane.low;
    return reach;
  }

  void append_events(std::uint32_t part, Lists& lists) const {
    const Box& box = parts_[part].box;
    for (int k = 0; k < 3; ++k) {
      auto& list = lists[static_cast<std::size_t>(k)];
      if (box.low[k] == box.high[k]) {
        list.push_back({box.low[k], Event::planar, part});
      } else {
        list.push_back({box.low[k], Event::start, part});
        list.push_back({box.high[k], Event::end, part});
      }
    }
  }

  void choose_sides(const std::vector<Event>& list, const Split& split) {
    for (const Event& e : list) {
      Side& side = side_[e.part];
      switch (e.kind) {
        case Event::start:
          side = e.at < split.offset ? both : above;
          break;
        case Event::end:
          if (e.at <= split.offset) side = below;
          break;
        default:
          side = e.at < split.offset || (e.at == split.offset && split.planar_below) ? below : above;
      }
    }
  }

  /// Events of parts on one side alone keep their order.
  void hand_down(const Lists& lists, const Split& split, Lists& to_below, Lists& to_above) const {
    for (std::size_t k = 0; k < 3; ++k) {
      to_below[k].reserve(2 * split.below), to_above[k].reserve(2 * split.above);
      for (const Event& e : lists[k]) {
        const Side side = side_[e.part];
        if (side == below) to_below[k].push_back(e);
        if (side == above) to_above[k].push_back(e);
      }
    }
  }

  /// `list`: of any axis. Where a part turns out not to reach a side, that side's count goes down.
  void cut_straddling(const std::vector<Event>& list, const Box& below_cell, const Box& above_cell,
                      Lists& to_below, Lists& to_above, std::size_t& n_below, std::size_t& n_above) {
    Lists new_below, new_above;
    for (const Event& e : list) {
      if (e.kind == Event::end || side_[e.part] != both) continue;
      const Part whole = parts_[e.part];
      std::uint32_t id = e.part;  // its number passes to the first part that remains
      for (const bool is_above : {false, true}) {
        Part part{intersection(whole.box, is_above ? above_cell : below_cell), whole.triangle};
        if (options_.clip) part.box = clipped_box(set_.items[whole.triangle].triangle, part.box);
        if (part.box.empty()) {
          --(is_above ? n_above : n_below);
          continue;
        }
        if (id == parts_.size()) {
          if (id >= max_parts) throw InvalidInput("more than 2^30 references; lower max_references");
          parts_.push_back(part), side_.push_back(both);
        } else {
          parts_[id] = part;
        }
        append_events(id, is_above ? new_above : new_below);
        id = static_cast<std::uint32_t>(parts_.size());
      }
    }
    const auto merge = [](std::vector<Event>& list, std::vector<Event>& fresh) {
      std::sort(fresh.begin(), fresh.end());
      const auto middle = static_cast<std::ptrdiff_t>(list.size());
      list.insert(list.end(), fresh.begin(), fresh.end());
      std::inplace_merge(list.begin(), list.begin() + middle, list.end());
    };
    for (std::size_t k = 0; k < 3; ++k) merge(to_below[k], new_below[k]), merge(to_above[k], new_above[k]);
  }

  bool worthwhile(const Split& split, std::size_t n, double budget) const {
    if (split.axis < 0 || static_cast<double>(split.below + split.above) > budget) return false;
    if (split.cost < static_cast<double>(n)) return true;
    return n > static_cast<std::size_t>(options_.leaf_size) && split.below < n && split.above < n &&
           split.below + split.above <= n + n / 2;
  }

  T add_leaf(const std::vector<Event>& list, std::size_t n, const Box& cell, std::size_t level) {
    KdTriangleNode<T> leaf;
    leaf.link = static_cast<std::uint32_t>(references.size());
    leaf.count = static_cast<std::uint32_t>(n);
    if (references.size() + n > 0xffffffffu)
      throw InvalidInput("more than 2^32 references; lower max_references");
    nodes.push_back(leaf);
    T reach = 0;
    for (const Event& e : list) {
      if (e.kind == Event::end) continue;
      const std::uint32_t triangle = parts_[e.part].triangle;
      references.push_back(triangle);
      reach = std::max(reach, reach_of(set_.centre, set_.items[triangle].triangle.box()));
    }
    ++leaves;
    depth = std::max(depth, level);
    largest_leaf = std::max(largest_leaf, n);
    if (root_measure_ > 0) cost += static_cast<double>(n) * measure(cell) / root_measure_;
    return reach;
  }

  Split best_split(const Lists& lists, std::size_t n, const Box& cell) const {
    Split best;
    const double whole = measure(cell);
    if (!(whole > 0)) return best;
    for (int axis = 0; axis < 3; ++axis) {
      const std::vector<Event>& list = lists[static_cast<std::size_t>(axis)];
      // The cell's measure up to a plane is linear in where the plane is.
      Box face = cell;
      face.high[axis] = face.low[axis];
      const double flat = measure(face), slope = (whole - flat) / extent(cell, axis);
      std::size_t started = 0, ended = 0;
      const auto offer = [&](T at, double below_share, double above_share, std::size_t below,
                             std::size_t above, bool planar_below) {
        double tests = below_share * static_cast<double>(below) + above_share * static_cast<double>(above);
        if (below == 0 || above == 0) tests *= 1 - options_.empty_bonus;
        if (tests + options_.step_cost < best.cost)
          best = {tests + options_.step_cost, axis, at, planar_below, below, above};
      };
      for (std::size_t i = 0; i < list.size();) {
        const T at = list[i].at;
        std::size_t of_kind[3] = {};
        for (; i < list.size() && list[i].at == at; ++i) ++of_kind[list[i].kind];
        ended += of_kind[Event::end] + of_kind[Event::planar];
        if (cell.low[axis] < at && at < cell.high[axis]) {
          const double from_low = (at * 0.5 - cell.low[axis] * 0.5) * unit_,
                       from_high = (cell.high[axis] * 0.5 - at * 0.5) * unit_;
          const double below_share = (flat + slope * from_low) / whole,
                       above_share = (flat + slope * from_high) / whole;
          const std::size_t flat_parts = of_kind[Event::planar];
          offer(at, below_share, above_share, started + flat_parts, n - ended, true);
          if (flat_parts > 0) offer(at, below_share, above_share, started, n - ended + flat_parts, false);
        }
        started += of_kind[Event::start] + of_kind[Event::planar];
      }
    }
    return best;
  }

  const TriangleSet<T>& set_;
  KdTriangleOptions options_;
  std::size_t depth_limit_;
  double unit_ = 0, root_measure_ = 0;
  std::vector<Part> parts_;
  std::vector<Side> side_;  // of each part, in the node being split
};

}  // namespace treeline::accel
