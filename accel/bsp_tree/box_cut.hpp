// A box cut by a plane: area and bounds of the part on either side.
//
// Each face is clipped to both sides; the area of the cut itself follows from the others, because the area
// vectors of a closed surface add up to zero. Cost: about 500 operations.
#pragma once

#include <array>

#include "geometry/box.hpp"
#include "geometry/plane.hpp"

namespace treeline::accel {

/// Index 0: where the plane's signed distance is negative; 1: where it is positive.
struct BoxCut {
  std::array<double, 2> area{};
  std::array<geometry::Box3d, 2> bounds;
};

inline BoxCut cut(const geometry::Box3d& box, const geometry::Plane3d& plane) {
  using geometry::Vec3d;
  std::array<Vec3d, 8> corner;
  std::array<double, 8> distance;
  for (std::size_t i = 0; i < 8; ++i) {
    for (int k = 0; k < 3; ++k) corner[i][k] = (i >> k & 1) ? box.high[k] : box.low[k];
    distance[i] = plane.signed_distance(corner[i]);
  }
  static constexpr std::array<std::array<std::size_t, 4>, 6> faces{
      {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};  // outward
  BoxCut result;
  std::array<Vec3d, 2> total{};
  for (const auto& face : faces) {
    for (std::size_t side = 0; side < 2; ++side) {
      const double sign = side == 0 ? 1 : -1;
      std::array<Vec3d, 6> part;
      std::size_t n = 0;
      for (std::size_t i = 0; i < 4; ++i) {
        const std::size_t p = face[i], q = face[(i + 1) % 4];
        const double dp = sign * distance[p], dq = sign * distance[q];
        if (dp <= 0) part[n++] = corner[p];
        if ((dp < 0 && dq > 0) || (dp > 0 && dq < 0))
          part[n++] = corner[p] + (corner[q] - corner[p]) * (dp / (dp - dq));
      }
      Vec3d twice{};
      for (std::size_t i = 0; i < n; ++i) result.bounds[side].grow(part[i]);
      for (std::size_t i = 1; i + 1 < n; ++i) twice += cross(part[i] - part[0], part[i + 1] - part[0]);
      total[side] += twice * 0.5;
      result.area[side] += 0.5 * length(twice);
    }
  }
  for (std::size_t side = 0; side < 2; ++side) result.area[side] += length(total[side]);
  return result;
}

}  // namespace treeline::accel
