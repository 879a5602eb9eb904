// Builder of a KD tree over triangles by the surface area heuristic (MacDonald and Booth 1990; Wald and
// Havran 2006).
//
// Candidate planes are sides of the triangles' boxes: all of them in small nodes, a sample in large ones
// (Hunt, Mark and Stoll 2006), which keeps the build O(n log n) without sorted event lists. A triangle that
// straddles a plane is referenced on both sides, by the box of the part of it that lies there; one that lies
// in the plane goes to the low side. Three bounds hold whatever the input: the depth (8 + 1.3 log2 n; Wald
// and Havran), the number of references (max_references times n: a node whose children would exceed its share
// of them becomes a leaf), and a node is not split unless both children are smaller than it or one is empty.
// Known weakness: large triangles among small ones are referenced often.
#pragma once

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
  int candidates = 32;        ///< planes tried per axis and node, about
  bool clip = true;           ///< reference by the part of a triangle in the cell, not by all of its box
  double empty_bonus = 0.2;   ///< share of the cost taken off where one side is empty
  double step_cost = 1;       ///< of a node, in triangle tests
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
    if (options.candidates < 2 || options.candidates > max_candidates - 2)
      throw InvalidInput("candidates is " + std::to_string(options.candidates) + "; it must be in [2, " +
                         std::to_string(max_candidates - 2) + "]");
    const std::size_t n = set.items.size();
    if (n == 0) return;
    double widest = 0;
    for (int k = 0; k < 3; ++k) widest = std::max(widest, set.bounds.high[k] * 0.5 - set.bounds.low[k] * 0.5);
    if (widest > 0) unit_ = 1 / widest;
    root_measure_ = measure(set.bounds);
    std::vector<Ref> refs(n);
    for (std::size_t i = 0; i < n; ++i)
      refs[i] = {set.items[i].triangle.box(), static_cast<std::uint32_t>(i)};
    build(std::move(refs), set.bounds, 0, options.max_references * static_cast<double>(n));
    nodes.shrink_to_fit();
    references.shrink_to_fit();
  }

  std::vector<KdTriangleNode<T>> nodes;
  std::vector<std::uint32_t> references;  // indices into the set's items
  std::size_t leaves = 0, depth = 0, largest_leaf = 0;
  double cost = 0;

 private:
  using Box = geometry::Box<T, 3>;
  static constexpr int max_candidates = 63;

  struct Ref {
    Box box;
    std::uint32_t index;
  };
  struct Split {
    double cost = std::numeric_limits<double>::infinity();
    int axis = -1;
    T offset{};
    std::size_t below = 0, above = 0;  // references on either side
  };
  /// Candidate planes of one axis, ascending; the rest is infinite, so that a search of fixed length finds
  /// its way.
  struct Planes {
    std::array<T, max_candidates> at;
    int count = 0;

    template <class Precedes>
    int preceding(T x, Precedes precedes) const {
      int i = 0;
      for (int step = (max_candidates + 1) / 2; step > 0; step /= 2)
        i += precedes(at[static_cast<std::size_t>(i + step - 1)], x) ? step : 0;
      return i;
    }
  };

  /// Surface area in units of the root's size, in which nothing overflows; of a flat box too.
  double measure(const Box& b) const {
    double e[3];
    for (int k = 0; k < 3; ++k) e[k] = (b.high[k] * 0.5 - b.low[k] * 0.5) * unit_;
    return e[0] * e[1] + e[1] * e[2] + e[2] * e[0] + 1e-9 * (e[0] + e[1] + e[2]);
  }

  static bool goes_below(const Box& b, int axis, T offset) {
    return b.low[axis] < offset || (b.low[axis] == offset && b.high[axis] == offset);
  }
  static bool goes_above(const Box& b, int axis, T offset) { return b.high[axis] > offset; }

  /// Returns the reach from the centre of the triangles referenced.
  T build(std::vector<Ref>&& refs, const Box& cell, std::size_t level, double budget) {
    const std::size_t n = refs.size();
    const Split split = level < depth_limit_ && n > 1 ? best_split(refs, cell) : Split{};
    if (!worthwhile(split, n, budget)) return add_leaf(refs, cell, level);

    const std::size_t here = nodes.size();
    nodes.emplace_back();
    nodes[here].axis = static_cast<std::uint32_t>(split.axis);
    if (root_measure_ > 0) cost += measure(cell) / root_measure_;

    Box below_cell = cell, above_cell = cell;
    below_cell.high[split.axis] = above_cell.low[split.axis] = split.offset;
    std::vector<Ref> below, above;
    below.reserve(split.below), above.reserve(split.above);
    for (const Ref& ref : refs) {
      const bool is_below = goes_below(ref.box, split.axis, split.offset);
      const bool is_above = goes_above(ref.box, split.axis, split.offset);
      const bool straddles = is_below && is_above;
      if (is_below) add(below, ref, below_cell, straddles);
      if (is_above) add(above, ref, above_cell, straddles);
    }
    std::vector<Ref>().swap(refs);
    const double total = static_cast<double>(below.size() + above.size());
    const double below_budget = budget * (static_cast<double>(below.size()) / std::max(total, 1.0));
    const T reach_below = build(std::move(below), below_cell, level + 1, below_budget);
    nodes[here].link = static_cast<std::uint32_t>(nodes.size());
    const T reach_above = build(std::move(above), above_cell, level + 1, budget - below_budget);
    const T reach = std::max(reach_below, reach_above);
    const Widened<T> plane(split.offset, split.offset, reach);
    nodes[here].border[0] = plane.high, nodes[here].border[1] = plane.low;
    return reach;
  }

  void add(std::vector<Ref>& side, const Ref& ref, const Box& cell, bool straddles) const {
    Ref part{intersection(ref.box, cell), ref.index};
    if (straddles && options_.clip) {
      part.box = clipped_box(set_.items[ref.index].triangle, part.box);
      if (part.box.empty()) return;
    }
    side.push_back(part);
  }

  bool worthwhile(const Split& split, std::size_t n, double budget) const {
    if (split.axis < 0 || static_cast<double>(split.below + split.above) > budget) return false;
    if (split.cost < static_cast<double>(n)) return true;
    return n > static_cast<std::size_t>(options_.leaf_size) && split.below < n && split.above < n &&
           split.below + split.above <= n + n / 2;
  }

  T add_leaf(const std::vector<Ref>& refs, const Box& cell, std::size_t level) {
    KdTriangleNode<T> leaf;
    leaf.link = static_cast<std::uint32_t>(references.size());
    leaf.count = static_cast<std::uint32_t>(refs.size());
    if (references.size() + refs.size() > 0xffffffffu)
      throw InvalidInput("more than 2^32 references; lower max_references");
    nodes.push_back(leaf);
    T reach = 0;
    for (const Ref& ref : refs) {
      references.push_back(ref.index);
      reach = std::max(reach, reach_of(set_.centre, set_.items[ref.index].triangle.box()));
    }
    ++leaves;
    depth = std::max(depth, level);
    largest_leaf = std::max(largest_leaf, refs.size());
    if (root_measure_ > 0) cost += static_cast<double>(refs.size()) * measure(cell) / root_measure_;
    return reach;
  }

  Planes candidates(const std::vector<Ref>& refs, const Box& cell, int axis) const {
    Planes planes;
    T low = std::numeric_limits<T>::infinity(), high = -low;
    for (const Ref& ref : refs)
      low = std::min(low, ref.box.low[axis]), high = std::max(high, ref.box.high[axis]);
    const auto offer = [&](T x) {
      if (cell.low[axis] < x && x < cell.high[axis]) planes.at[static_cast<std::size_t>(planes.count++)] = x;
    };
    offer(low), offer(high);
    const std::size_t n = refs.size(),
                      m = std::min<std::size_t>(n, static_cast<std::size_t>(options_.candidates) / 2);
    for (std::size_t i = 0; i < m; ++i) {
      const Box& box = refs[i * n / m].box;
      offer(box.low[axis]), offer(box.high[axis]);
    }
    const auto end = planes.at.begin() + planes.count;
    std::sort(planes.at.begin(), end);
    planes.count = static_cast<int>(std::unique(planes.at.begin(), end) - planes.at.begin());
    std::fill(planes.at.begin() + planes.count, planes.at.end(), std::numeric_limits<T>::infinity());
    return planes;
  }

  Split best_split(const std::vector<Ref>& refs, const Box& cell) const {
    Split best;
    const double whole = measure(cell);
    if (!(whole > 0)) return best;
    for (int axis = 0; axis < 3; ++axis) {
      const Planes planes = candidates(refs, cell, axis);
      if (planes.count == 0) continue;
      // begins[i]: references below planes i, i + 1, …; ends[i]: references above planes …, i - 2, i - 1.
      std::array<std::size_t, max_candidates + 1> begins{}, ends{};
      for (const Ref& ref : refs) {
        const T low = ref.box.low[axis], high = ref.box.high[axis];
        const int end = planes.preceding(high, [](T plane, T x) { return plane < x; });
        const int begin = low == high ? end : planes.preceding(low, [](T plane, T x) { return plane <= x; });
        ++begins[static_cast<std::size_t>(begin)], ++ends[static_cast<std::size_t>(end)];
      }
      std::size_t below = 0, above = refs.size();
      for (std::size_t i = 0; i < static_cast<std::size_t>(planes.count); ++i) {
        below += begins[i], above -= ends[i];
        Box below_cell = cell, above_cell = cell;
        below_cell.high[axis] = above_cell.low[axis] = planes.at[i];
        double cost = (measure(below_cell) * static_cast<double>(below) +
                       measure(above_cell) * static_cast<double>(above)) /
                      whole;
        if (below == 0 || above == 0) cost *= 1 - options_.empty_bonus;
        cost += options_.step_cost;
        if (cost < best.cost) best = {cost, axis, planes.at[i], below, above};
      }
    }
    return best;
  }

  const TriangleSet<T>& set_;
  KdTriangleOptions options_;
  std::size_t depth_limit_;
  double unit_ = 0, root_measure_ = 0;
};

}  // namespace treeline::accel
