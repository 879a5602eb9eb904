// Triangles that reach in front of the near plane, or so far beside the map that fixed point would overflow:
// what is left of them, after Sutherland and Hodgman 1974. Two triangles that share an edge cut it at the
// same point, because a cut is always computed from the corner that stays. Rare, one at a time, in double.
#pragma once

#include <array>
#include <vector>

#include "shading/raster/vertices.hpp"

namespace treeline::shading::raster {

/// A corner in homogeneous coordinates, linear in the world: fixed-point position times w, depth, w.
struct ClipCorner {
  std::array<double, 4> h;
  Vertex vertex;  ///< as place_vertices made it; outside: not yet known
};

inline ClipCorner clip_corner(const Frame& frame, const Vec3f& point, const Vertex& vertex) {
  const Vec3d d = Vec3d(point) - frame.origin;
  const auto along = [&](const Vec3d& axis) {
    return (times(d[0], axis[0]) + times(d[1], axis[1])) + times(d[2], axis[2]);
  };
  const double z = along(frame.z), w = frame.perspective ? z : 1;
  return {{along(frame.x) + times(frame.centre_x, w), along(frame.y) + times(frame.centre_y, w),
           times(z - frame.near, frame.inverse_range), w},
          vertex};
}

/// The vertex of a cut.
inline Vertex clipped_vertex(const Frame& frame, const ClipCorner& c) {
  if (c.vertex.x != Vertex::outside) return c.vertex;
  const auto fixed = [&](double a) {
    return static_cast<std::int32_t>(std::nearbyint(std::clamp(a / c.h[3], guard_low, guard_high)));
  };
  const double depth = std::max(c.h[2], 0.0);
  const double denominator = frame.perspective ? frame.near / c.h[3] : 1;
  return {fixed(c.h[0]), fixed(c.h[1]), float(times(depth, denominator)), float(denominator)};
}

/// Adds the triangles that are left of one, three vertices each.
inline void clip_triangle(const Frame& frame, const std::array<ClipCorner, 3>& triangle,
                          std::vector<Vertex>& out) {
  // Each plane adds a corner at most.
  std::array<ClipCorner, 8> polygon, next;
  std::size_t count = 3;
  for (std::size_t k = 0; k < 3; ++k) polygon[k] = triangle[k];
  const std::array<std::array<double, 4>, 5> planes{{{0, 0, 1, 0},
                                                     {1, 0, 0, -guard_low},
                                                     {-1, 0, 0, guard_high},
                                                     {0, 1, 0, -guard_low},
                                                     {0, -1, 0, guard_high}}};
  for (const auto& plane : planes) {
    const auto inside_by = [&](const ClipCorner& c) {
      return (times(c.h[0], plane[0]) + times(c.h[1], plane[1])) +
             (times(c.h[2], plane[2]) + times(c.h[3], plane[3]));
    };
    const auto cut = [&](const ClipCorner& in, const ClipCorner& gone) {
      const double a = inside_by(in), t = a / (a - inside_by(gone));
      ClipCorner r;
      for (std::size_t k = 0; k < 4; ++k) r.h[k] = in.h[k] + times(gone.h[k] - in.h[k], t);
      r.vertex.x = Vertex::outside;
      return r;
    };
    std::size_t kept = 0;
    for (std::size_t k = 0; k < count; ++k) {
      const ClipCorner &p = polygon[k], &q = polygon[(k + 1) % count];
      const bool p_in = inside_by(p) >= 0, q_in = inside_by(q) >= 0;
      if (p_in) next[kept++] = p;
      if (p_in != q_in) next[kept++] = p_in ? cut(p, q) : cut(q, p);
    }
    count = kept;
    std::swap(polygon, next);
    if (count < 3) return;
  }
  for (std::size_t k = 2; k < count; ++k)
    for (const std::size_t corner : {std::size_t{0}, k - 1, k})
      out.push_back(clipped_vertex(frame, polygon[corner]));
}

}  // namespace treeline::shading::raster
