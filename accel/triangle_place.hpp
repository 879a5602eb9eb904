// Where a tree over triangles keeps them: moved to where numbers are finest, then scaled.
//
// Problem: every slack of a traversal is relative to coordinates, so a mesh far from the origin
// (georeferenced: coordinates near 1e6, triangles of 1) is searched with boxes grown by as much as they are
// apart. Method: along each axis on which all coordinates have one sign and lie within a factor of two of
// each other, the origin moves to the middle: there the subtraction is exact (Sterbenz 1974), so every
// triangle is as it was; along the others little is to be won. What is then very large or small is scaled by
// a power of two (triangle_scale.hpp). Points of queries are moved alike: exactly near the mesh, rounded once
// elsewhere, by no more than the tests of the leaves themselves. Cost: three subtractions a query.
#pragma once

#include <utility>
#include <vector>

#include "accel/slice.hpp"
#include "accel/triangle_scale.hpp"

namespace treeline::accel {

/// The middle of the axes along which moving there is exact for all points of a box; 0 along the others.
template <class T>
geometry::Vec<T, 3> exact_centre(const geometry::Box<T, 3>& box) {
  geometry::Vec<T, 3> centre{};
  for (int k = 0; k < 3; ++k) {
    const T near = std::min(std::abs(box.low[k]), std::abs(box.high[k])),
            far = std::max(std::abs(box.low[k]), std::abs(box.high[k]));
    const bool one_sign = (box.low[k] > T(0)) == (box.high[k] > T(0));
    if (one_sign && near > T(0) && far / T(2) <= near) centre[k] = box.low[k] * T(0.5) + box.high[k] * T(0.5);
  }
  return centre;
}

template <class T>
class TrianglePlace {
 public:
  using Point = geometry::Vec<T, 3>;
  using Box = geometry::Box<T, 3>;
  using Ray = geometry::Ray<T>;

  TrianglePlace() = default;
  TrianglePlace(const Point& centre, const TriangleScale<T>& scale)
      : centre_(centre), scaled_centre_(scale.scaled(centre)), scale_(scale) {}

  const TriangleScale<T>& scale() const { return scale_; }
  bool changes() const { return scale_.scales() || centre_ != Point{}; }

  // ---- from the user's space to the tree's, and back ------------------------------------------------------

  Point kept(const Point& p) const { return scale_.scaled(moved(p)); }
  geometry::Triangle<T> kept(const geometry::Triangle<T>& t) const {
    return {kept(t.a), kept(t.b), kept(t.c)};
  }
  /// Its t is the given ray's times 2^shift.
  Ray kept(const Ray& ray, int& shift) const {
    return scale_.scaled({moved(ray.origin), ray.direction, ray.t_min, ray.t_max}, shift);
  }
  Point given(const Point& p) const { return scale_.unscaled(p) + centre_; }
  Box given(const Box& box) const {
    const Box unscaled = scale_.unscaled(box);
    return {unscaled.low + centre_, unscaled.high + centre_};
  }

  /// Held where its squared distance from the mesh is finite.
  Point kept_query(const Point& p) const { return scale_.scaled_query(moved(p)); }
  /// Whether kept_query() did not have to move it there.
  bool is_near(const Point& p) const { return scale_.is_near(moved(p)); }

  /// Largest coordinate of a point of the tree's space, measured from the user's origin in the tree's unit.
  T magnitude(const Point& p) const {
    T most = 0;
    for (int k = 0; k < 3; ++k) most = std::max(most, std::abs(p[k] + scaled_centre_[k]));
    return most;
  }

  // ---- slices ---------------------------------------------------------------------------------------------

  double kept_offset(int axis, double offset) const {
    if (axis >= 0 && axis < 3) offset -= static_cast<double>(centre_[axis]);
    return offset * static_cast<double>(scale_.factor());
  }
  std::vector<SliceCell> given(std::vector<SliceCell> cells, int axis) const {
    cells = scaled(std::move(cells), static_cast<double>(scale_.inverse()));
    const int across[2] = {axis == 0 ? 1 : 0, axis == 2 ? 1 : 2};
    for (SliceCell& cell : cells)
      for (auto& corner : cell.outline)
        for (int i = 0; i < 2; ++i) corner[i] += static_cast<double>(centre_[across[i]]);
    return cells;
  }

 private:
  Point moved(const Point& p) const {
    Point r = p - centre_;
    constexpr T most = std::numeric_limits<T>::max();
    for (int k = 0; k < 3; ++k) r[k] = std::clamp(r[k], -most, most);
    return r;
  }

  Point centre_{}, scaled_centre_{};
  TriangleScale<T> scale_;
};

}  // namespace treeline::accel
