// Planes { x : dot(normal, x) = offset }; the positive side is where the normal points.
#pragma once

#include "geometry/vec.hpp"

namespace treeline::geometry {

template <class T, int D>
struct Plane {
  Vec<T, D> normal;  // of unit length unless said otherwise
  T offset{};

  /// Signed distance, if the normal is of unit length.
  constexpr T signed_distance(const Vec<T, D>& p) const { return dot(normal, p) - offset; }
};

using Plane3f = Plane<float, 3>;
using Plane3d = Plane<double, 3>;

}  // namespace treeline::geometry
