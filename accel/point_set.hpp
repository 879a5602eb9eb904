// The points a tree keeps: a reordered copy with ids, so that a leaf is one run of memory, and the one
// function by which all trees measure a distance. Coordinates are finite; bad ones are refused or dropped on
// the way in.
//
// Clouds so large or so small that squared distances would overflow or vanish are scaled by a power of two,
// which is exact but for coordinates that underflow. The scale is that of a typical point, so that one far
// outlier does not make the distances among all others vanish. What remains: distances that overflow the
// scalar compare equal, so that their order falls back on ids.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "accel/concepts.hpp"

namespace treeline::accel {

/// s + d·d, rounded the same way wherever it is called: where the machine fuses, it fuses here by name, since
/// a compiler left to choose may fuse one call and not another.
inline float add_square(float s, float d) {
#if defined(__FMA__) || defined(__FP_FAST_FMAF)
  return std::fma(d, d, s);
#else
  return s + d * d;
#endif
}
inline double add_square(double s, double d) {
#if defined(__FMA__) || defined(__FP_FAST_FMA)
  return std::fma(d, d, s);
#else
  return s + d * d;
#endif
}

// Why a pruned box never holds a true neighbour, rounding included. squared_length adds the axes in a fixed
// order, and each of its operations is monotone in |offset| because rounding is. For a point p of a box and a
// query q left of it on an axis, fl(low - q) <= fl(p - q), as low <= p; right of it likewise; between, 0 <=
// |fl(p - q)|. So squared_length of the box's offsets is at most that of the point's, as computed, not only
// as meant.

template <class T, int D>
T squared_length(const T* offsets) {
  T s = offsets[0] * offsets[0];
  for (int i = 1; i < D; ++i) s = add_square(s, offsets[i]);
  return s;
}

template <class T, int D>
T squared_distance(const geometry::Vec<T, D>& p, const geometry::Vec<T, D>& q) {
  T offsets[D];
  for (int i = 0; i < D; ++i) offsets[i] = p[i] - q[i];
  return squared_length<T, D>(offsets);
}

/// Distance along one axis from q to [low, high]; 0 within.
template <class T>
T interval_offset(T low, T high, T q) {
  return std::max(std::max(low - q, q - high), T(0));
}

template <class T, int D>
T squared_distance(const geometry::Box<T, D>& box, const geometry::Vec<T, D>& q) {
  T offsets[D];
  for (int i = 0; i < D; ++i) offsets[i] = interval_offset(box.low[i], box.high[i], q[i]);
  return squared_length<T, D>(offsets);
}

/// Scaled coordinates stay below 2^query_exponent: differences of that size overflow when squared, yet their
/// sums and projections stay finite.
template <class T>
inline constexpr int query_exponent = std::numeric_limits<T>::max_exponent / 2 + 8;

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
struct PointSet {
  static constexpr std::size_t largest_size = (std::size_t{1} << 31) - 1;  // 32 bits then number nodes, too

  using Point = geometry::Vec<T, D>;
  using Box = geometry::Box<T, D>;

  std::vector<PointEntry<T, D>> entries;  // scaled
  Box box;                                // of the entries
  T scale = 1, inverse_scale = 1;         // powers of two
  std::size_t dropped = 0;

  PointSet(std::span<const Point> points, const BuildOptions& options) {
    if (options.leaf_size < 1)
      throw InvalidInput("leaf_size is " + std::to_string(options.leaf_size) + "; it must be at least 1");
    if (points.size() > largest_size)
      throw InvalidInput(std::to_string(points.size()) + " points; at most " + std::to_string(largest_size) +
                         " can be indexed");
    entries.reserve(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (!geometry::is_finite(points[i])) {
        if (options.non_finite == NonFinite::refuse)
          throw InvalidInput("point " + std::to_string(i) + " has a coordinate that is not finite");
        ++dropped;
        continue;
      }
      entries.push_back({points[i], static_cast<Id>(i)});
    }
    if (dropped > 0) entries.shrink_to_fit();
    choose_scale();
    for (auto& e : entries) e.point = e.point * scale, box.grow(e.point);
  }

  std::size_t bytes() const { return entries.capacity() * sizeof(PointEntry<T, D>); }

  /// The query in scaled coordinates, held where even a plane's projection stays finite; every distance to a
  /// point overflows on both sides of that limit.
  Point scaled(const Point& q) const {
    const T limit = std::ldexp(T(1), query_exponent<T>);
    Point r;
    for (int i = 0; i < D; ++i) r[i] = std::clamp(q[i] * scale, -limit, limit);
    return r;
  }
  T unscaled_square(T distance2) const { return distance2 * inverse_scale * inverse_scale; }

  /// Offers the points of a leaf to a visitor; visitor.offer(distance², id) says whether it took the point.
  template <class Visitor, class W>
  void offer(const PointLeaf& leaf, const Point& q, Visitor& visitor, W& work) const {
    const PointEntry<T, D>* e = entries.data() + leaf.first;
    const PointEntry<T, D>* const end = e + leaf.count;
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

 private:
  void choose_scale() {
    using Limits = std::numeric_limits<T>;
    constexpr int high = Limits::max_exponent / 2 - Limits::digits;  // queries may lie 2^digits times farther
    constexpr int low = Limits::min_exponent / 2 + 2 * Limits::digits;  // gaps may be 2^-2digits of the whole
    const auto [typical, largest] = magnitudes();
    if (largest == 0) return;
    const int exponent = std::ilogb(typical), highest = std::ilogb(largest);
    int shift = exponent < low || exponent > high ? std::clamp(-exponent, 8 - Limits::max_exponent, high) : 0;
    shift = std::min(shift, query_exponent<T> - 1 - highest);  // outliers, too, must be told from infinity
    scale = std::ldexp(T(1), shift), inverse_scale = std::ldexp(T(1), -shift);
  }

  /// Median over a sample, and maximum over all, of the points' largest coordinates; points at the origin do
  /// not count.
  std::pair<T, T> magnitudes() const {
    std::vector<T> sample;
    const std::size_t step = entries.size() / 1024 + 1;
    T largest = 0;
    for (std::size_t i = 0; i < entries.size(); ++i) {
      T magnitude = 0;
      for (int a = 0; a < D; ++a) magnitude = std::max(magnitude, std::abs(entries[i].point[a]));
      largest = std::max(largest, magnitude);
      if (magnitude > 0 && i % step == 0) sample.push_back(magnitude);
    }
    if (sample.empty()) return {largest, largest};
    const auto middle = sample.begin() + static_cast<std::ptrdiff_t>(sample.size() / 2);
    std::nth_element(sample.begin(), middle, sample.end());
    return {*middle, largest};
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
