// The grid of whole numbers that the corners of a solid are moved to.
//
// Problem: exact planes need whole coordinates of few bits (Trettner, Nehring-Wirxel and Kobbelt 2022, EMBER:
// 26 bits). Method: a spacing that is a power of two, so that the extent takes at most 2^26 steps, and a
// centre on the grid; a coordinate moves by half a step at most, 2^-26 of the extent. Input that lies on a
// coarser grid of powers of two of the same size is not moved at all. Known weakness: faces may lose their
// area, and surfaces closer than a step may touch; neither opens a closed mesh.
#pragma once

#include <string>

#include "accel/concepts.hpp"
#include "geometry/box.hpp"

namespace treeline::accel {

struct SolidGrid {
  static constexpr double reach = 0x1p25;  ///< coordinates in steps are at most this

  double spacing = 0;        ///< a power of two; 0: none yet
  geometry::Vec3d centre{};  ///< in steps, whole

  bool operator==(const SolidGrid&) const = default;

  /// The finest that holds a box. Solids that are to be merged need one in common, over both.
  static SolidGrid over(const geometry::Box<double, 3>& box) {
    double extent = 0, farthest = 0;
    for (int k = 0; k < 3; ++k) {
      extent = std::max(extent, box.high[k] - box.low[k]);
      farthest = std::max({farthest, std::abs(box.low[k]), std::abs(box.high[k])});
    }
    if (!(extent > 0x1p-900 && farthest < 0x1p900))
      throw InvalidInput("solid: an extent below 2^-900, or coordinates beyond 2^900, have no grid");
    SolidGrid g;
    g.spacing = std::ldexp(1.0, std::ilogb(extent) - 25);  // extent < 2^26 steps
    if (extent / g.spacing > 0x1p26 - 2) g.spacing *= 2;   // room to round the centre
    // Far from the origin neighbouring doubles are further apart than that, and nothing is lost by a coarser
    // one.
    g.spacing = std::max(g.spacing, std::ldexp(1.0, std::ilogb(farthest) - 51));
    for (int k = 0; k < 3; ++k) g.centre[k] = std::rint((box.low[k] / 2 + box.high[k] / 2) / g.spacing);
    return g;
  }

  /// In steps, rounded to double alone.
  geometry::Vec3d steps(const geometry::Vec3d& p) const {
    return {p[0] / spacing - centre[0], p[1] / spacing - centre[1], p[2] / spacing - centre[2]};
  }
  geometry::Vec3d position(const geometry::Vec3d& steps) const { return (steps + centre) * spacing; }
};

}  // namespace treeline::accel
