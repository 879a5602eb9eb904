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
// is not split unless both children are smaller than it or one is empty. Large subtrees are built apart
// (triangle_branch.hpp), at the same time on several threads; large nodes share out their axes. Cost:
// O(n log n), and some 150 bytes a triangle while it builds. Known weakness: large triangles among small ones
// are referenced often.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "accel/bvh/build_tasks.hpp"
#include "accel/clip_triangle.hpp"
#include "accel/kd_tree/triangle_branch.hpp"
#include "accel/padded_ray.hpp"
#include "accel/triangle_set.hpp"
#include "geometry/tolerances.hpp"

namespace treeline::accel {

struct KdTriangleOptions : BuildOptions {
  double max_references = 8;  ///< bound on references per triangle
  bool clip = true;           ///< reference by the part of a triangle in the cell, not by all of its box
  double empty_bonus = 0.2;   ///< share of the cost taken off where one side is empty
  double step_cost = 5;       ///< of a node, in triangle tests, which go eight at a time
  int threads = 1;            ///< that build; the tree does not depend on it
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
  using Node = KdTriangleNode<T>;

  KdTriangleBuilder(const TriangleSet<T>& set, const KdTriangleOptions& options)
      : set_(set),
        options_(options),
        depth_limit_(kd_depth_limit(set.items.size())),
        tasks_(options.threads) {
    if (!(options.max_references >= 1)) throw InvalidInput("max_references must be at least 1");
    check_threads(options.threads);
    check_cost("step_cost", options.step_cost);
    if (!(0 <= options.empty_bonus && options.empty_bonus <= 1))
      throw InvalidInput("empty_bonus is " + std::to_string(options.empty_bonus) + "; it must be in [0, 1]");
    const std::size_t n = set.items.size();
    if (n == 0) return;
    double widest = 0;
    for (int k = 0; k < 3; ++k) widest = std::max(widest, set.bounds.high[k] * 0.5 - set.bounds.low[k] * 0.5);
    if (widest > 0) unit_ = 1 / widest;
    root_measure_ = measure(set.bounds);
    if (n > max_parts) throw InvalidInput(std::to_string(n) + " triangles; a KD tree takes 2^30");
    Branch branch;
    branch.parts.reserve(n);
    for (std::size_t i = 0; i < n; ++i)
      branch.parts.push_back({set.items[i].triangle.box(), static_cast<std::uint32_t>(i)});
    branch.side.resize(n);
    tasks_.run([&] {
      Lists lists;
      each_axis(n, [&](std::size_t axis) {
        lists[axis].reserve(2 * n);
        for (std::size_t i = 0; i < n; ++i)
          append_events(branch.parts[i].box, static_cast<std::uint32_t>(i), axis, lists[axis]);
        sort(lists[axis].begin(), lists[axis].end());
      });
      build(branch, std::move(lists), n, set.bounds, 0, options.max_references * static_cast<double>(n));
    });
    tree = std::move(branch);
    tree.nodes.shrink_to_fit();
    tree.references.shrink_to_fit();
  }

  TriangleBranch<Node> tree;

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
  struct Branch : TriangleBranch<Node> {
    std::vector<Part> parts;  // that events name
    std::vector<Side> side;   // of each part, in the node being split
  };
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

  /// f(axis), at the same time if n parts are worth it.
  template <class F>
  void each_axis(std::size_t n, F&& f) const {
    tasks_.both(
        n, [&] { f(std::size_t{0}); },
        [&] {
          tasks_.both(
              n, [&] { f(1); }, [&] { f(2); });
        });
  }

  /// In an order that does not depend on threads, among equals too.
  void sort(typename std::vector<Event>::iterator begin, typename std::vector<Event>::iterator end) const {
    const auto n = static_cast<std::size_t>(end - begin);
    if (n < BuildTasks::piece) return std::sort(begin, end);
    const auto middle = begin + static_cast<std::ptrdiff_t>(n / 2);
    tasks_.both(
        n, [&] { sort(begin, middle); }, [&] { sort(middle, end); });
    std::inplace_merge(begin, middle, end);
  }

  /// Returns the reach from the centre of the triangles referenced.
  T build(Branch& branch, Lists&& lists, std::size_t n, const Box& cell, std::size_t level,
          double budget) const {
    const Split split = level < depth_limit_ && n > 1 ? best_split(lists, n, cell) : Split{};
    if (!worthwhile(split, n, budget)) return add_leaf(branch, lists[0], n, cell, level);

    const std::size_t here = branch.nodes.size();
    branch.nodes.emplace_back();
    branch.nodes[here].axis = static_cast<std::uint32_t>(split.axis);
    if (root_measure_ > 0) branch.cost += measure(cell) / root_measure_;
    Box below_cell = cell, above_cell = cell;
    below_cell.high[split.axis] = above_cell.low[split.axis] = split.offset;

    choose_sides(branch, lists[static_cast<std::size_t>(split.axis)], split);
    Lists lists_of[2];  // below, above
    hand_down(branch, lists, split, lists_of[0], lists_of[1]);
    std::size_t n_of[2] = {split.below, split.above};
    cut_straddling(branch, lists[0], below_cell, above_cell, lists_of[0], lists_of[1], n_of[0], n_of[1]);
    for (auto& list : lists) std::vector<Event>().swap(list);

    const double total = static_cast<double>(n_of[0] + n_of[1]);
    const double below_budget = budget * (static_cast<double>(n_of[0]) / std::max(total, 1.0));
    T reach_of_side[2];
    const auto build_side = [&](Branch& into, int side) {
      reach_of_side[side] =
          build(into, std::move(lists_of[side]), n_of[side], side == 0 ? below_cell : above_cell, level + 1,
                side == 0 ? below_budget : budget - below_budget);
    };
    if (n >= BuildTasks::worth_a_task) {
      Branch side[2];
      tasks_.both(
          n, [&] { take_parts(branch, lists_of[0], side[0]); },
          [&] { take_parts(branch, lists_of[1], side[1]); });
      std::vector<Part>().swap(branch.parts), std::vector<Side>().swap(branch.side);
      tasks_.both(
          n, [&] { build_side(side[0], 0); }, [&] { build_side(side[1], 1); });
      branch.append(std::move(side[0]));
      branch.nodes[here].link = static_cast<std::uint32_t>(branch.nodes.size());
      branch.append(std::move(side[1]));
    } else {
      build_side(branch, 0);
      branch.nodes[here].link = static_cast<std::uint32_t>(branch.nodes.size());
      build_side(branch, 1);
    }
    const T reach = std::max(reach_of_side[0], reach_of_side[1]);
    const Widened<T> plane(split.offset, split.offset, reach);
    branch.nodes[here].border[0] = plane.high, branch.nodes[here].border[1] = plane.low;
    return reach;
  }

  /// Gives a branch of its own the parts that the lists name, numbered anew.
  static void take_parts(const Branch& from, Lists& lists, Branch& to) {
    std::vector<std::uint32_t> number(from.parts.size());
    to.parts.reserve(lists[0].size() / 2);
    for (const Event& e : lists[0])
      if (e.kind != Event::end) {
        number[e.part] = static_cast<std::uint32_t>(to.parts.size());
        to.parts.push_back(from.parts[e.part]);
      }
    for (auto& list : lists)
      for (Event& e : list) e.part = number[e.part];
    to.side.resize(to.parts.size());
  }

  static void append_events(const Box& box, std::uint32_t part, std::size_t axis, std::vector<Event>& list) {
    const int k = static_cast<int>(axis);
    if (box.low[k] == box.high[k]) {
      list.push_back({box.low[k], Event::planar, part});
    } else {
      list.push_back({box.low[k], Event::start, part});
      list.push_back({box.high[k], Event::end, part});
    }
  }

  static void choose_sides(Branch& branch, const std::vector<Event>& list, const Split& split) {
    for (const Event& e : list) {
      Side& side = branch.side[e.part];
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
  void hand_down(const Branch& branch, const Lists& lists, const Split& split, Lists& to_below,
                 Lists& to_above) const {
    each_axis(branch.parts.size(), [&](std::size_t k) {
      to_below[k].reserve(2 * split.below), to_above[k].reserve(2 * split.above);
      for (const Event& e : lists[k]) {
        const Side side = branch.side[e.part];
        if (side == below) to_below[k].push_back(e);
        if (side == above) to_above[k].push_back(e);
      }
    });
  }

  /// `list`: of any axis. Where a part turns out not to reach a side, that side's count goes down.
  void cut_straddling(Branch& branch, const std::vector<Event>& list, const Box& below_cell,
                      const Box& above_cell, Lists& to_below, Lists& to_above, std::size_t& n_below,
                      std::size_t& n_above) const {
    Lists new_below, new_above;
    for (const Event& e : list) {
      if (e.kind == Event::end || branch.side[e.part] != both) continue;
      const Part whole = branch.parts[e.part];
      std::uint32_t id = e.part;  // its number passes to the first part that remains
      for (const bool is_above : {false, true}) {
        Part part{intersection(whole.box, is_above ? above_cell : below_cell), whole.triangle};
        if (options_.clip) part.box = clipped_box(set_.items[whole.triangle].triangle, part.box);
        if (part.box.empty()) {
          --(is_above ? n_above : n_below);
          continue;
        }
        if (id == branch.parts.size()) {
          if (id >= max_parts) throw InvalidInput("more than 2^30 references; lower max_references");
          branch.parts.push_back(part), branch.side.push_back(both);
        } else {
          branch.parts[id] = part;
        }
        Lists& fresh = is_above ? new_above : new_below;
        for (std::size_t k = 0; k < 3; ++k) append_events(part.box, id, k, fresh[k]);
        id = static_cast<std::uint32_t>(branch.parts.size());
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

  T add_leaf(Branch& branch, const std::vector<Event>& list, std::size_t n, const Box& cell,
             std::size_t level) const {
    Node leaf;
    leaf.link = static_cast<std::uint32_t>(branch.references.size());
    leaf.count = static_cast<std::uint32_t>(n);
    if (branch.references.size() + n > 0xffffffffu)
      throw InvalidInput("more than 2^32 references; lower max_references");
    branch.nodes.push_back(leaf);
    T reach = 0;
    for (const Event& e : list) {
      if (e.kind == Event::end) continue;
      const std::uint32_t triangle = branch.parts[e.part].triangle;
      branch.references.push_back(triangle);
      reach = std::max(reach, reach_of(set_.centre, set_.items[triangle].triangle.box()));
    }
    ++branch.leaves;
    branch.depth = std::max(branch.depth, level);
    branch.largest_leaf = std::max(branch.largest_leaf, n);
    if (root_measure_ > 0) branch.cost += static_cast<double>(n) * measure(cell) / root_measure_;
    return reach;
  }

  Split best_split(const Lists& lists, std::size_t n, const Box& cell) const {
    const double whole = measure(cell);
    std::array<Split, 3> of_axis;
    if (whole > 0)
      each_axis(n, [&](std::size_t axis) {
        of_axis[axis] = best_split(lists[axis], n, cell, static_cast<int>(axis), whole);
      });
    return *std::min_element(of_axis.begin(), of_axis.end(),
                             [](const Split& a, const Split& b) { return a.cost < b.cost; });
  }

  Split best_split(const std::vector<Event>& list, std::size_t n, const Box& cell, int axis,
                   double whole) const {
    Split best;
    // The cell's measure up to a plane is linear in where the plane is.
    Box face = cell;
    face.high[axis] = face.low[axis];
    const double flat = measure(face), slope = (whole - flat) / extent(cell, axis);
    std::size_t started = 0, ended = 0;
    const auto offer = [&](T at, double below_share, double above_share, std::size_t below, std::size_t above,
                           bool planar_below) {
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
    return best;
  }

  const TriangleSet<T>& set_;
  KdTriangleOptions options_;
  std::size_t depth_limit_;
  BuildTasks tasks_;
  double unit_ = 0, root_measure_ = 0;
};

}  // namespace treeline::accel
