// What the camera sees, as receivers of shadow: one a pixel.
//
// Left out are pixels that see nothing, those whose surface faces away from the light, and those from which
// not all of an area light is above the surface's plane or on its lit side: there the surface shades itself,
// which is the matter of shading and not of shadows. What is left out is 0 in no picture and counts in no
// error.
#pragma once

#include <vector>

#include "accel/bvh.hpp"
#include "shading/scene.hpp"
#include "shading/shadow/depth_map.hpp"

namespace treeline::bench::shadow {

using shading::shadow::Receiver;
using Tree = accel::Bvh<accel::Triangles<float>, accel::Wide>;

/// The sine of the light over the surface's plane, at least: below, the cosine makes its light nothing.
inline constexpr double least_sine = 0.02;

struct Receivers {
  int width = 0, height = 0;
  std::vector<Receiver> list;        ///< in the order of pixels
  std::vector<std::uint32_t> pixel;  ///< of each: row · width + column
};

/// Positions are on the triangles hit, in double; normals are those of the triangles, on the camera's side.
/// Throws shading::InvalidScene if nothing is seen that the light could reach.
Receivers receivers_of(const shading::Scene&, const Tree&, int threads);

}  // namespace treeline::bench::shadow
