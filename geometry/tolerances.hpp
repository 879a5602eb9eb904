// Every tolerance of the project, named, relative to a scale, with its derivation.
#pragma once

#include <limits>

namespace treeline::geometry::tolerance {

/// Unit roundoff: half an ulp of 1, relative error of one rounded operation.
template <class T>
inline constexpr T unit_roundoff = std::numeric_limits<T>::epsilon() / T(2);

/// Bound gamma(n) = n·u / (1 - n·u) on the relative error of n chained roundings (Higham 2002, lemma 3.1).
template <class T>
constexpr T gamma(int n) {
  return (n * unit_roundoff<T>) / (T(1) - n * unit_roundoff<T>);
}

/// Padding of a box in a slab test, relative to the distance of its corners from the ray's origin: 8
/// roundings, 6 of them used up; the derivation is in intersect_box.hpp.
template <class T>
inline constexpr T slab_padding = T(8) * unit_roundoff<T>;

/// Slack of a point's distance bound from a plane of computed unit normal, relative to the coordinates'
/// distance from the local origin: 1 rounding to shift and D to project for each of the two points, D + 4 for
/// the length of the normal, (D + 2) / 2 for the compared distance, and the bound's own; 2 D + 8 covers
/// either sum.
template <class T>
constexpr T plane_bound(int dimension) {
  return gamma<T>(2 * dimension + 8);
}

}  // namespace treeline::geometry::tolerance
