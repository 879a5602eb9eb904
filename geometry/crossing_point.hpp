// Where two triangles meet that cross_each_other(): a point to look at, in double.
//
// Method: along an edge of one, the distance to the other is convex, so that golden sections find its least;
// of the edges that tell whether the two meet (exact/triangle_triangle.hpp), the one that comes nearest. Of
// triangles that overlap beside a shared edge, that edge's middle. Cost: some thousand distances. Known
// weakness: it rounds, and so may lie off either triangle by some 1e-15 of the coordinates.
#pragma once

#include <limits>
#include <utility>

#include "geometry/distance.hpp"
#include "geometry/exact/triangle_triangle.hpp"

namespace treeline::geometry {

namespace detail {

struct NearestOfEdge {
  Vec3d point;
  double distance2;
};

inline NearestOfEdge nearest_of_edge(const Vec3d& from, const Vec3d& to, const Triangle3d& triangle) {
  constexpr double golden = 0.6180339887498949;
  constexpr int sections = 90;  // 1.6^-90 is below a double's last digit
  const auto at = [&](double u) { return from * (1 - u) + to * u; };
  const auto off = [&](double u) { return closest_point_on_triangle(at(u), triangle).distance2; };
  NearestOfEdge best{from, off(0)};
  const auto look = [&](double u) {
    const double d = off(u);
    if (d < best.distance2) best = {at(u), d};
    return d;
  };
  look(1);
  double low = 0, high = 1, left = 1 - golden, right = golden, d_left = look(left), d_right = look(right);
  for (int i = 0; i < sections; ++i)
    if (d_left <= d_right) {
      high = right, right = left, d_right = d_left;
      d_left = look(left = high - golden * (high - low));
    } else {
      low = left, left = right, d_left = d_right;
      d_right = look(right = low + golden * (high - low));
    }
  return best;
}

}  // namespace detail

/// Of triangles that cross each other; of others, some point of an edge.
inline Vec3d crossing_point(const Triangle3f& first, const Triangle3f& second) {
  const SharedCorners<float> shared(first, second);
  const auto corner = [](const std::array<Vec3f, 3>& of, int k) { return Vec3d(of[std::size_t(k % 3)]); };
  if (shared.count >= 2) return (corner(shared.s, 0) + corner(shared.s, 1)) * 0.5;
  const Triangle3d s{corner(shared.s, 0), corner(shared.s, 1), corner(shared.s, 2)},
      t{corner(shared.t, 0), corner(shared.t, 1), corner(shared.t, 2)};
  detail::NearestOfEdge best{s.a, std::numeric_limits<double>::infinity()};
  for (int k = shared.count; k < (shared.count == 1 ? 2 : 3); ++k)  // of a shared corner, what is across it
    for (const auto& [edges, other] : {std::pair(&shared.s, &t), std::pair(&shared.t, &s)})
      if (const auto near = detail::nearest_of_edge(corner(*edges, k), corner(*edges, k + 1), *other);
          near.distance2 < best.distance2)
        best = near;
  return best.point;
}

}  // namespace treeline::geometry
