// The points a tree keeps: a reordered copy with ids, so that a leaf is one run of memory, scaled as the
// cloud's measure says. Coordinates are finite; bad ones are refused or dropped on the way in.
//
// Where scaling takes digits from coordinates that are tiny beside the others (in float 2^-70 of the largest
// allowed, in a cloud that reaches up there), the points are kept as they came, too, and settle what the
// scaled ones cannot: ranks in the wider type, small radii, boxes.
#pragma once

#include <bit>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "accel/concepts.hpp"
#include "accel/exponent_counts.hpp"

namespace treeline::accel {

template <class T, int D>
struct PointEntry {
  geometry::Vec<T, D> point;
  Id id;
};

/// A run of entries; `coincident` if all its points are equal, which then are in order of id.
struct PointLeaf {
  std::uint32_t first, count;
  bool coincident;
};

template <class T, int D>
struct PointSet : PointMeasure<T, D> {
  static constexpr std::size_t largest_size = (std::size_t{1} << 31) - 1;  // 32 bits then number nodes, too

  using Point = geometry::Vec<T, D>;
  using Box = geometry::Box<T, D>;
  using Measure = PointMeasure<T, D>;

  std::vector<PointEntry<T, D>> entries;  // scaled
  std::vector<Point> originals;           // by id, as they came, if the measure is lossy
  Box box;                                // of the entries
  std::size_t dropped = 0;

  PointSet(std::span<const Point> points, const BuildOptions& options) {
    if (options.leaf_size < 1)
      throw InvalidInput("leaf_size is " + std::to_string(options.leaf_size) + "; it must be at least 1");
    if (points.size() > largest_size)
      throw InvalidInput(std::to_string(points.size()) + " points; at most " + std::to_string(largest_size) +
                         " can be indexed");
    const bool finite = all_finite(points);
    entries.reserve(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (!finite && !geometry::is_finite(points[i])) {
        if (options.non_finite == NonFinite::refuse)
          throw InvalidInput("point " + std::to_string(i) + " has a coordinate that is not finite");
        ++dropped;
        continue;
      }
      entries.push_back({points[i], static_cast<Id>(i)});
    }
    if (dropped > 0) entries.shrink_to_fit();
    static_cast<Measure&>(*this) = Measure(exponents_of(std::span<const PointEntry<T, D>>(entries)));
    if (this->is_lossy) originals.assign(points.begin(), points.end());
    if (this->scale != T(1))
      for (auto& e : entries) e.point = e.point * this->scale;
    for (const auto& e : entries) box.grow(e.point);
  }

  std::size_t bytes() const {
    return entries.capacity() * sizeof(PointEntry<T, D>) + originals.capacity() * sizeof(Point);
  }

  /// An entry's point as it came.
  Point original(const PointEntry<T, D>& e) const {
    return originals.empty() ? e.point * this->inverse_scale : originals[e.id];
  }
  /// Of the points as they came, but for those dropped.
  Box original_box() const {
    if (originals.empty()) return {box.low * this->inverse_scale, box.high * this->inverse_scale};
    Box b;
    for (const Point& p : originals)
      if (geometry::is_finite(p)) b.grow(p);
    return b;
  }
  /// An entry's squared distance in the wider type, from a query that is wide_scaled().
  typename Measure::Wide wide_square(const PointEntry<T, D>& e, const typename Measure::WidePoint& q) const {
    return originals.empty() ? wide_distance2(e.point, q)
                             : squared_distance(this->wide_scaled(originals[e.id]), q);
  }
  /// A lower bound of wide_square() for the entries in a box.
  typename Measure::Wide wide_square(const Box& b, const typename Measure::WidePoint& q) const {
    const auto square = wide_distance2(b, q);
    // What scaling took is far below the wider type's digits of squares that overflow in T; of others nothing
    // is said.
    if (!originals.empty())
      return overflows(narrowed_square<T>(square)) ? square * (1 - typename Measure::Wide(0x1p-40)) : 0;
    return square;
  }

  /// Offers the points of a leaf to a visitor; visitor.offer(distance², id), or visitor.offer(entry,
  /// distance²), says whether it took the point.
  template <class Visitor, class W>
  void offer(const PointLeaf& leaf, const Point& q, Visitor& visitor, W& work) const {
    const PointEntry<T, D>* e = entries.data() + leaf.first;
    const PointEntry<T, D>* const end = e + leaf.count;
    if constexpr (requires { visitor.offer(*e, T(0)); }) {
      for (; e != end; ++e) {
        work.primitive();
        // Of equal points those that follow one not taken come later in order of id.
        const bool taken = visitor.offer(*e, squared_distance(e->point, q));
        if (!taken && leaf.coincident && originals.empty()) return;
      }
    } else {
      if constexpr (requires { visitor.enter_leaf(); }) visitor.enter_leaf();
      if (leaf.coincident) {
        // Equal points are taken in order of id until one is too far or too late: the rest are, too.
        const T distance2 = squared_distance(e->point, q);
        do work.primitive();
        while (visitor.offer(distance2, e->id) && ++e != end);
        return;
      }
      work.primitive(leaf.count);
      for (; e != end; ++e) visitor.offer(squared_distance(e->point, q), e->id);
    }
  }

 private:
  using Bits = std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint64_t>;
  static Bits magnitude(T x) { return std::bit_cast<Bits>(x) & (static_cast<Bits>(-1) >> 1); }

  /// By the bits of the coordinates, whose order is theirs: reductions of integers vectorise.
  static bool all_finite(std::span<const Point> points) {
    static_assert(sizeof(Point) == D * sizeof(T));
    const T* x = points.empty() ? nullptr : points.data()->v;
    Bits largest = 0;
    for (std::size_t i = 0; i < points.size() * D; ++i) largest = std::max(largest, magnitude(x[i]));
    return largest < std::bit_cast<Bits>(std::numeric_limits<T>::infinity());
  }

  /// Those that ExponentCounts finds, or others that give the same measure: the median need not be found
  /// where it is known to be ordinary.
  static Exponents exponents_of(std::span<const PointEntry<T, D>> entries) {
    const Bits low = std::bit_cast<Bits>(std::ldexp(T(1), Measure::lowest_ordinary)),
               high = std::bit_cast<Bits>(std::ldexp(T(1), Measure::highest_ordinary + 1));
    Bits largest = 0, smallest_less_one = static_cast<Bits>(-1);  // 0 less one is the last
    std::size_t zero = 0, below = 0, above = 0;
    for (const auto& e : entries) {
      Bits all = 0;
      for (int a = 0; a < D; ++a) {
        const Bits m = magnitude(e.point[a]);
        all = std::max(all, m);
        smallest_less_one = std::min(smallest_less_one, static_cast<Bits>(m - 1));
      }
      largest = std::max(largest, all);
      zero += all == 0, below += all < low, above += all >= high;
    }
    if (largest == 0) return {};
    const std::size_t middle = (entries.size() - zero) / 2;
    if (below - zero <= middle && middle < entries.size() - zero - above)
      return {true, Measure::lowest_ordinary, std::ilogb(std::bit_cast<T>(largest)),
              std::ilogb(std::bit_cast<T>(static_cast<Bits>(smallest_less_one + 1)))};
    ExponentCounts<T, D> counts;
    for (const auto& e : entries) counts.add(e.point);
    return counts.exponents();
  }
};

/// Bounds of the traversal stacks. Builders split as they please down to free_depth(n); below it they halve
/// by rank, which needs at most 32 more levels for 2^32 points.
inline constexpr int max_depth = 128;
constexpr int free_depth(std::size_t n) {
  int bits = 0;
  while (n >>= 1) ++bits;
  return 16 + 2 * bits;
}
static_assert(free_depth(no_id) + 32 < max_depth);

}  // namespace treeline::accel
