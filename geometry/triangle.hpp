// Triangles by value: three corners, counter-clockwise seen from the outside of a closed mesh.
#pragma once

#include "geometry/box.hpp"

namespace treeline::geometry {

template <class T>
struct Triangle {
  Vec<T, 3> a, b, c;

  constexpr bool operator==(const Triangle&) const = default;

  /// Normal of length twice the area; zero for a degenerate triangle.
  constexpr Vec<T, 3> area_normal() const { return cross(b - a, c - a); }
  T area() const { return T(0.5) * length(area_normal()); }
  constexpr Vec<T, 3> centroid() const { return (a + b + c) / T(3); }
  constexpr Box<T, 3> box() const {
    Box<T, 3> r;
    r.grow(a), r.grow(b), r.grow(c);
    return r;
  }
  template <class U>
  constexpr explicit operator Triangle<U>() const {
    return {Vec<U, 3>(a), Vec<U, 3>(b), Vec<U, 3>(c)};
  }
};

using Triangle3f = Triangle<float>;
using Triangle3d = Triangle<double>;

template <class T>
bool is_finite(const Triangle<T>& t) {
  return is_finite(t.a) && is_finite(t.b) && is_finite(t.c);
}

}  // namespace treeline::geometry
