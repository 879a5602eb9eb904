// How the points of a cloud are measured: the one function by which all trees compute a squared distance, the
// power of two by which a cloud is scaled, what ranks points where T's squares say too little, and what lies
// within a radius.
//
// Clouds so large or so small that squared distances would overflow or vanish are scaled by a power of two,
// which is exact but for coordinates that underflow. The scale is that of a typical point, so that one far
// outlier does not make the distances among all others vanish. Squares span only so much: where a query's
// distances overflow or vanish nevertheless (from far away, or in a cloud of parts of very different size),
// the points that T cannot tell apart are ranked in a wider type, whose squares span it all.
//
// How a point ranks depends on the query, the point and the cloud's measure, and on nothing else: not on the
// tree, not on what else is found, not on how many are asked for. So trees agree to the bit, and the first j
// of the k nearest are the j nearest.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

#include "accel/simd/registers.hpp"
#include "geometry/box.hpp"
#include "geometry/rounding.hpp"
#include "geometry/tolerances.hpp"

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

/// In a wider type S, by the same operations.
template <class T, class S, int D>
S wide_distance2(const geometry::Vec<T, D>& p, const geometry::Vec<S, D>& q) {
  return squared_distance(static_cast<geometry::Vec<S, D>>(p), q);
}
template <class T, class S, int D>
S wide_distance2(const geometry::Box<T, D>& box, const geometry::Vec<S, D>& q) {
  using Point = geometry::Vec<S, D>;
  return squared_distance(geometry::Box<S, D>{static_cast<Point>(box.low), static_cast<Point>(box.high)}, q);
}

/// Scaled coordinates stay below 2^query_exponent: differences of that size overflow when squared, yet their
/// sums and projections stay finite.
template <class T>
inline constexpr int query_exponent = std::numeric_limits<T>::max_exponent / 2 + 8;

/// Squared distances below have lost digits to underflow.
template <class T>
inline constexpr int vague_exponent =
    std::numeric_limits<T>::min_exponent + std::numeric_limits<T>::digits + 2;
template <class T>
T vague_square() {
  return std::ldexp(T(1), vague_exponent<T>);
}
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
template <class T>
using SquareOf = typename SquareType<T>::Type;

/// A squared distance in the wider type, to be turned into T where it does not overflow.
template <class T>
T narrowed_square(SquareOf<T> square) {
  return square <= static_cast<SquareOf<T>>(std::numeric_limits<T>::max())
             ? static_cast<T>(square)
             : std::numeric_limits<T>::infinity();
}

template <class T>
bool is_vague(T distance2) {
  return distance2 < vague_square<T>();
}
template <class T>
bool overflows(T distance2) {
  return !(distance2 <= std::numeric_limits<T>::max());
}

/// What ranks compare: the squared distance as T computes it; the wider one where that overflows, and, if the
/// query is `small`, where it has lost digits. Monotone in both arguments together (the three ranges stay
/// apart, whatever was rounded), so that a box, too, may be judged by its rank. In T it is what a search in T
/// compares, so that both rank alike.
template <class T>
SquareOf<T> rank_of(T distance2, SquareOf<T> wide, bool small) {
  using Wide = SquareOf<T>;
  constexpr Wide step = std::numeric_limits<Wide>::epsilon();
  if (overflows(distance2))
    return std::max(wide, static_cast<Wide>(std::numeric_limits<T>::max()) * (1 + step));
  if (small && is_vague(distance2)) return std::min(wide, static_cast<Wide>(vague_square<T>()) * (1 - step));
  return distance2;
}

/// What lies within a radius: points at most `square` away as T computes it, and at most `wide` in the wider
/// type, which is infinite where T tells.
template <class T>
struct Reach {
  T square = std::numeric_limits<T>::infinity();
  SquareOf<T> wide = std::numeric_limits<SquareOf<T>>::infinity();
  bool widely = false;  // T does not tell

  bool operator()(T distance2, SquareOf<T> wide_distance2) const {
    return distance2 <= square && wide_distance2 <= wide;
  }
};

/// A bound on squared_distance of all points whose true distance is at most `radius`: it takes D + 2
/// roundings, of which the difference's counts twice. The bound is the least such, but for rounding it once
/// and for less than two units in the wider type's last place, which cover that type's own roundings and what
/// underflow takes from squares above vague_square(). Points beyond the radius by no more than rounding may
/// be within it, too.
template <class T, int D>
T squared_reach(SquareOf<T> radius) {
  using Wide = SquareOf<T>;
  constexpr Wide slack =
      static_cast<Wide>(geometry::tolerance::gamma<T>(D + 2)) + 4 * std::numeric_limits<Wide>::epsilon();
  return narrowed_square<T>(radius * radius * (1 + slack));
}

/// The exponents on which a cloud's measure depends; zeros do not count.
struct Exponents {
  bool any = false;
  int typical = 0;                // the median of those of the points' largest coordinates
  int largest = 0, smallest = 0;  // of all coordinates
};

template <class T, int D>
struct PointMeasure {
  using Point = geometry::Vec<T, D>;
  using Wide = SquareOf<T>;
  using WidePoint = geometry::Vec<Wide, D>;
  using Limits = std::numeric_limits<T>;

  T scale = 1, inverse_scale = 1;  // powers of two
  bool has_small = false;          // a scaled coordinate below 2^small_exponent that is not 0
  bool is_lossy = false;           // scaling may have taken digits from a coordinate

  bool operator==(const PointMeasure&) const = default;

  PointMeasure() = default;
  explicit PointMeasure(const Exponents& all) {
    if (!all.any) return;
    int shift = 0;
    if (!is_ordinary(all.typical)) {
      shift =
          std::clamp(-all.typical, 8 - Limits::max_exponent, Limits::max_exponent - 2);  // both ways normal
      // Small coordinates keep their digits as far as typical squares stay finite.
      const int least = Limits::min_exponent - 1 - all.smallest;
      if (shift < 0)
        shift = std::min(std::max(shift, least), std::max(shift, Limits::max_exponent / 2 - 4 - all.typical));
    }
    shift =
        std::min(shift, query_exponent<T> - 1 - all.largest);  // outliers, too, must be told from infinity
    scale = std::ldexp(T(1), shift), inverse_scale = std::ldexp(T(1), -shift);
    has_small = all.smallest + shift < small_exponent<T>;
    is_lossy = shift < 0 && all.smallest + shift < Limits::min_exponent - 1;
  }

  /// Whether clouds of this exponent are measured as they are: queries may lie 2^digits times farther, gaps
  /// may be 2^-2digits of the whole.
  static constexpr int lowest_ordinary = Limits::min_exponent / 2 + 2 * Limits::digits,
                       highest_ordinary = Limits::max_exponent / 2 - Limits::digits;
  static constexpr bool is_ordinary(int exponent) {
    return lowest_ordinary <= exponent && exponent <= highest_ordinary;
  }

  /// The query in scaled coordinates, held where even a plane's projection stays finite; every distance to a
  /// point overflows on both sides of that limit.
  Point scaled(const Point& q) const {
    const T limit = std::ldexp(T(1), query_exponent<T>);
    Point r;
    for (int i = 0; i < D; ++i) r[i] = std::clamp(q[i] * scale, -limit, limit);
    return r;
  }
  /// In scaled coordinates, neither rounded nor held.
  WidePoint wide_scaled(const Point& p) const {
    WidePoint r;
    for (int a = 0; a < D; ++a) r[a] = static_cast<Wide>(p[a]) * static_cast<Wide>(scale);
    return r;
  }
  T unscaled_square(T distance2) const { return distance2 * inverse_scale * inverse_scale; }

  /// Whether ranks of vague squares take the wider type to tell points apart. (Where no coordinate of the
  /// query, or none of the points, is small, those at such a distance all coincide.)
  bool is_small(const Point& scaled_query) const {
    if (!has_small) return false;
    const T small = std::ldexp(T(1), small_exponent<T>);
    for (int a = 0; a < D; ++a)
      if (std::abs(scaled_query[a]) < small) return true;
    return false;
  }
  /// The squared distance that a rank stands for, in the caller's units.
  T told_square(Wide rank, bool small) const {
    const bool in_t =
        rank <= static_cast<Wide>(Limits::max()) && !(small && rank < static_cast<Wide>(vague_square<T>()));
    if (in_t) return unscaled_square(static_cast<T>(rank));
    return narrowed_square<T>(rank * static_cast<Wide>(inverse_scale) * static_cast<Wide>(inverse_scale));
  }

  /// A radius, in the caller's units, within which all lie whose told square is at most radius2: that may be
  /// less than the true one by the roundings of its digits and, where it is denormal, by one on each axis and
  /// two of the scale's.
  static T radius_over(T radius2) {
    if (std::isinf(radius2)) return radius2;
    const Wide square = static_cast<Wide>(radius2) + (D + 2) * static_cast<Wide>(Limits::denorm_min());
    const Wide radius = std::sqrt(square) * (1 + static_cast<Wide>(geometry::tolerance::gamma<T>(D + 4)));
    return std::nextafter(static_cast<T>(radius), Limits::infinity());
  }

  /// `radius`: in the caller's units.
  Reach<T> reach(T radius) const {
    if (std::isinf(radius)) return {};
    const Wide r = static_cast<Wide>(radius) * static_cast<Wide>(scale);
    const T square = squared_reach<T, D>(r);
    if (!is_vague(square) && !overflows(square)) return {.square = square};
    constexpr Wide slack = (D + 4) * std::numeric_limits<Wide>::epsilon();
    return {std::max(square, 2 * vague_square<T>()), r * r * (1 + slack), true};
  }
};

}  // namespace treeline::accel
