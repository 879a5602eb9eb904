// Inside or outside a closed, oriented mesh.
//
// Method: the first face that a ray from the point meets is seen from behind if and only if the point is
// inside; a ray that meets nothing started outside. A hit near an edge or at grazing incidence could be told
// from the wrong one of two faces, so it has no vote; rays in fixed directions are cast until one answer
// leads by two votes or the directions run out, and the majority holds. Points within rounding of the surface
// count as inside, by the coordinates of the nearest triangle. Cost: one closest-point query of tiny radius
// and, as a rule, two rays. Known weakness: with a ray test that is not watertight a ray may slip out between
// two faces; it takes two such rays to be wrong. For open meshes the answer means nothing in particular.
#pragma once

#include <array>

#include "geometry/tolerances.hpp"
#include "geometry/triangle.hpp"

namespace treeline::accel {

/// Directions without symmetry among themselves or with the axes.
template <class T>
inline constexpr std::array<geometry::Vec<T, 3>, 9> probe_directions{{{T(0.48), T(0.36), T(0.79)},
                                                                      {T(-0.61), T(0.27), T(-0.75)},
                                                                      {T(0.83), T(-0.51), T(-0.23)},
                                                                      {T(-0.33), T(-0.69), T(0.64)},
                                                                      {T(0.17), T(0.94), T(-0.29)},
                                                                      {T(-0.91), T(0.13), T(0.39)},
                                                                      {T(0.29), T(-0.21), T(-0.93)},
                                                                      {T(0.67), T(0.71), T(-0.19)},
                                                                      {T(-0.41), T(-0.87), T(-0.27)}}};

/// `cast(ray)` gives an object with hit() and stored(), the triangle that was hit.
template <class T, class Cast>
bool votes_inside(const geometry::Vec<T, 3>& point, Cast&& cast) {
  constexpr T clear = geometry::tolerance::clear_hit<T>;
  int lead = 0, unclear_lead = 0;
  for (const auto& direction : probe_directions<T>) {
    const auto query = cast(geometry::Ray<T>{point, direction});
    const auto& hit = query.hit();
    if (!hit) {
      --lead;
    } else {
      const geometry::Triangle<double> face(query.stored()->triangle);
      const geometry::Vec<double, 3> normal = face.area_normal(), d(direction);
      const double facing = dot(normal, d);
      const bool is_clear = std::min({hit.u, hit.v, T(1) - hit.u - hit.v}) > clear &&
                            std::abs(facing) > double(clear) * length(normal) * length(d);
      (is_clear ? lead : unclear_lead) += facing > 0 ? 1 : -1;
    }
    if (std::abs(lead) >= 2) break;
  }
  return lead != 0 ? lead > 0 : unclear_lead > 0;
}

}  // namespace treeline::accel
