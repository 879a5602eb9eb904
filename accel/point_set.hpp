// The points a tree keeps: a reordered copy with ids, so that a leaf is one run of memory, and the one
// function by which all trees measure a distance. Coordinates are finite; bad ones are refused or dropped on
// the way in.
//
// Clouds so large or so small that squared distances would overflow or vanish are scaled by a power of two,
// which is exact but for coordinates that underflow. The scale is that of a typical point, so that one far
// outlier does not make the distances among all others vanish. Squares span only so much: where a query's
// distances overflow or vanish nevertheless (from far away, or in a cloud of parts of very different size),
// all points that T cannot tell apart are ranked in a wider type, see candidates.hpp. What remains:
// coordinates 2^180 times smaller than the largest (float; 2^1500 for double) may lose digits.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "accel/concepts.hpp"
#include "accel/simd/registers.hpp"

namespace treeline::accel {

/// s + d·d with both operations rounded, on every machine: trees then agree to the last bit on what is near,
/// whatever instructions they were compiled to.
template <class T>
T add_square(T s, T d) {
  return s + simd::opaque(d * d);
}

// Why a pruned box never holds a true neighbour, rounding included. squared_length adds the axes in a fixed
// order, and each of its operations is monotone in |offset| because rounding is. For a point p of a box and a
// query q left of it on an axis, fl(low - q) <= fl(p - q), as low <= p; right of it likewise; between, 0 <=
// |fl(p - q)|. So squared_length of the box's offsets is at most that of the point's, as computed, not only
// as meant.

template <class T, int D>
T squared_length(const T* offsets) {
  T s = simd::opaque(offsets[0] * offsets[0]);
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

/// Squared distances below have lost digits to underflow.
template <class T>
inline constexpr int vague_exponent =
    std::numeric_limits<T>::min_exponent + std::numeric_limits<T>::digits + 2;
/// Points at such a distance that is not 0 differ on axes where both coordinates are below 2^this.
template <class T>
inline constexpr int small_exponent = vague_exponent<T> / 2 + std::numeric_limits<T>::digits + 1;

/// Squares of all differences fit: for float exactly so, for double where long double is wider.
template <class T>
struct SquareType {
  using Type = double;
};
template <>
struct SquareType<double> {
  using Type = long double;
};

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
  bool has_small = false;  // a coordinate below 2^small_exponent that is not 0

  PointSet(std::span<const Point> points, const BuildOptions& options) {
    if (options.leaf_size < 1)
      throw InvalidInput("leaf_size is " + std::to_string(options.leaf_size) + "; it must be at least 1");
    if (points.size() > largest_size)
      throw InvalidInput(std::to_string(points.size()) + " points; at most " + std::to_string(largest_size) +
                         " can be indexed");
    Magnitudes all = magnitudes(points);
    entries.reserve(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (!all.finite && !geometry::is_finite(points[i])) {
        if (options.non_finite == NonFinite::refuse)
          throw InvalidInput("point " + std::to_string(i) + " has a coordinate that is not finite");
        ++dropped;
        continue;
      }
      entries.push_back({points[i], static_cast<Id>(i)});
    }
    if (dropped > 0) entries.shrink_to_fit();
    if (!all.finite) all = magnitudes_kept();
    choose_scale(all);
    if (scale != T(1))
      for (auto& e : entries) e.point = e.point * scale;
    for (const auto& e : entries) box.grow(e.point);
    has_small = all.smallest * scale < std::ldexp(T(1), small_exponent<T>);
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

  using Wide = typename SquareType<T>::Type;
  geometry::Vec<Wide, D> wide_scaled(const Point& q) const {
    geometry::Vec<Wide, D> r;
    for (int a = 0; a < D; ++a) r[a] = static_cast<Wide>(q[a]) * static_cast<Wide>(scale);
    return r;
  }
  T unscaled_square(Wide distance2) const {
    const Wide d = distance2 * static_cast<Wide>(inverse_scale) * static_cast<Wide>(inverse_scale);
    return d <= static_cast<Wide>(std::numeric_limits<T>::max()) ? static_cast<T>(d)
                                                                 : std::numeric_limits<T>::infinity();
  }

  /// Whether the squared distances of a query's nearest points say less than the points' coordinates do.
  bool vague(const Point& scaled_query, T nearest2, T farthest2) const {
    if (!(farthest2 <= std::numeric_limits<T>::max())) return true;
    if (!has_small || nearest2 >= vague_square()) return false;
    const T small = std::ldexp(T(1), small_exponent<T>);
    for (int a = 0; a < D; ++a)
      if (std::abs(scaled_query[a]) < small) return true;
    return false;
  }
  static T vague_square() { return std::ldexp(T(1), vague_exponent<T>); }

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
        if (!visitor.offer(*e, squared_distance(e->point, q)) && leaf.coincident) return;
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
  /// Zeros do not count. Infinite and NaN coordinates do, if there are any.
  struct Magnitudes {
    T largest = 0, smallest = std::numeric_limits<T>::max();
    bool finite = true;
  };
  /// By the bits of the coordinates, whose order is theirs: reductions of integers vectorise.
  static Magnitudes magnitudes(std::span<const Point> points) {
    using Bits = std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint64_t>;
    static_assert(sizeof(Point) == D * sizeof(T));
    const T* x = points.empty() ? nullptr : points.data()->v;
    Bits largest = 0, smallest_less_one = static_cast<Bits>(-1);
    for (std::size_t i = 0; i < points.size() * D; ++i) {
      const Bits magnitude = std::bit_cast<Bits>(x[i]) & (static_cast<Bits>(-1) >> 1);
      largest = std::max(largest, magnitude);
      smallest_less_one =
          std::min(smallest_less_one, static_cast<Bits>(magnitude - 1));  // 0 becomes the last
    }
    Magnitudes all;
    all.finite = largest < std::bit_cast<Bits>(std::numeric_limits<T>::infinity());
    if (largest > 0) {
      all.largest = std::bit_cast<T>(largest);
      all.smallest = std::bit_cast<T>(static_cast<Bits>(smallest_less_one + 1));
    }
    return all;
  }

  /// Of those that were not dropped.
  Magnitudes magnitudes_kept() const {
    Magnitudes all;
    for (const auto& e : entries)
      for (int a = 0; a < D; ++a)
        if (const T x = std::abs(e.point[a]); x > 0)
          all.largest = std::max(all.largest, x), all.smallest = std::min(all.smallest, x);
    return all;
  }

  void choose_scale(const Magnitudes& all) {
    using Limits = std::numeric_limits<T>;
    constexpr int high = Limits::max_exponent / 2 - Limits::digits;  // queries may lie 2^digits times farther
    constexpr int low = Limits::min_exponent / 2 + 2 * Limits::digits;  // gaps may be 2^-2digits of the whole
    if (all.largest == 0) return;
    const int exponent = std::ilogb(typical_magnitude(all.largest)), highest = std::ilogb(all.largest);
    int shift = 0;
    if (exponent < low || exponent > high) {
      shift = std::clamp(-exponent, 8 - Limits::max_exponent, Limits::max_exponent - 2);  // both ways normal
      // Small coordinates keep their digits as far as typical squares stay finite.
      const int least = Limits::min_exponent - 1 - std::ilogb(all.smallest);
      if (shift < 0)
        shift = std::min(std::max(shift, least), std::max(shift, Limits::max_exponent / 2 - 4 - exponent));
    }
    shift = std::min(shift, query_exponent<T> - 1 - highest);  // outliers, too, must be told from infinity
    scale = std::ldexp(T(1), shift), inverse_scale = std::ldexp(T(1), -shift);
  }

  /// The median over a sample of the points' largest coordinates; zeros do not count.
  T typical_magnitude(T largest) const {
    std::vector<T> sample;
    for (std::size_t i = 0; i < entries.size(); i += entries.size() / 1024 + 1) {
      T magnitude = 0;
      for (int a = 0; a < D; ++a) magnitude = std::max(magnitude, std::abs(entries[i].point[a]));
      if (magnitude > 0) sample.push_back(magnitude);
    }
    if (sample.empty()) return largest;
    const auto middle = sample.begin() + static_cast<std::ptrdiff_t>(sample.size() / 2);
    std::nth_element(sample.begin(), middle, sample.end());
    return *middle;
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
