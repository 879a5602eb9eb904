// What light does in the room closed_box, without a random number: radiosity.
//
// All of its surfaces are diffuse and see each other, so that the light of each bounce follows from that of
// the one before by form factors (Goral et al. 1984). Those between two rectangles that are parallel or
// perpendicular have a closed form (Ehlert and Smith 1993); walls are split into such patches, lighted evenly
// each, and two grids, of m and of 2 m patches along a side, tell the error and take most of it away
// (Richardson). It knows nothing of the tracers' rays, directions or weights: a witness of its own, for every
// number of bounces.
//
// Cost: patches² closed forms; 0.6 s at m = 3. Known weakness: the even light of patches; on means over walls
// it leaves some 5e-5.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace treeline::bench::light_transport {

/// In the order of the room's materials.
enum class BoxWall { floor, left, right, back, front, ceiling, lamp };
inline constexpr std::size_t box_walls = 7;

struct BoxLight {
  /// Radiance that leaves each wall in the mean, by the number of bounces that it took: entry 0 is what the
  /// lamp emits, 1 what it lights directly, and so on; the last one holds all further bounces too.
  std::vector<std::array<double, box_walls>> bounces;
  double error = 0;  ///< the most that the two grids differed by, in a sum over all bounces, relative

  /// With so many bounces and no more.
  std::array<double, box_walls> sum(std::size_t most) const;
};

/// Of a box 2 m wide and high whose square lamp lies in the middle of the ceiling, both of one albedo; its
/// radiance is `emission`. Throws std::invalid_argument for an albedo outside [0, 1) or a lamp that is not
/// between the walls.
BoxLight box_radiosity(double albedo, double lamp_side, double emission, int m = 3);

/// The share of what leaves the first rectangle that reaches the second: each spans two axes of a box, given
/// as low and high; `across` is the axis that they are perpendicular to. For tests.
struct Patch {
  int across = 0;
  double at = 0;  ///< of its plane
  std::array<double, 3> low{}, high{};

  double area() const;
};
double form_factor(const Patch& from, const Patch& to);

}  // namespace treeline::bench::light_transport
