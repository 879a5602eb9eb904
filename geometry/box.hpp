// Axis-aligned boxes: closed sets [low, high] in D dimensions. An empty box has low > high.
#pragma once

#include "geometry/vec.hpp"

namespace treeline::geometry {

template <class T, int D>
struct Box {
  Vec<T, D> low = Vec<T, D>::filled(std::numeric_limits<T>::infinity());
  Vec<T, D> high = Vec<T, D>::filled(-std::numeric_limits<T>::infinity());

  constexpr bool operator==(const Box&) const = default;

  constexpr bool empty() const {
    for (int i = 0; i < D; ++i)
      if (!(low[i] <= high[i])) return true;
    return false;
  }
  constexpr void grow(const Vec<T, D>& p) { low = min(low, p), high = max(high, p); }
  constexpr void grow(const Box& b) { low = min(low, b.low), high = max(high, b.high); }
  constexpr bool contains(const Vec<T, D>& p) const {
    for (int i = 0; i < D; ++i)
      if (!(low[i] <= p[i] && p[i] <= high[i])) return false;
    return true;
  }
  constexpr bool contains(const Box& b) const { return contains(b.low) && contains(b.high); }
  constexpr bool overlaps(const Box& b) const {
    for (int i = 0; i < D; ++i)
      if (!(low[i] <= b.high[i] && b.low[i] <= high[i])) return false;
    return true;
  }
  constexpr Vec<T, D> extent() const { return high - low; }
  constexpr Vec<T, D> centre() const { return low * T(0.5) + high * T(0.5); }
  /// Axis along which the box is longest.
  int widest_axis() const { return largest_axis(extent()); }
};

using Box2f = Box<float, 2>;
using Box3f = Box<float, 3>;
using Box3d = Box<double, 3>;

/// Area of the faces; 0 for an empty box.
template <class T>
constexpr T surface_area(const Box<T, 3>& b) {
  if (b.empty()) return T(0);
  const Vec<T, 3> e = b.extent();
  return T(2) * (e[0] * e[1] + e[1] * e[2] + e[2] * e[0]);
}

template <class T, int D>
constexpr Box<T, D> merged(const Box<T, D>& a, const Box<T, D>& b) {
  return {min(a.low, b.low), max(a.high, b.high)};
}
template <class T, int D>
constexpr Box<T, D> intersection(const Box<T, D>& a, const Box<T, D>& b) {
  return {max(a.low, b.low), min(a.high, b.high)};
}

}  // namespace treeline::geometry
