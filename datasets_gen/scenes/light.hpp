// Lights on a command line.
#pragma once

#include <string_view>

#include "shading/scene.hpp"

namespace treeline::datasets {

/// How parse_light is told of a light; for help texts.
inline constexpr const char* light_syntax =
    "directional:DX,DY,DZ[:HALF_ANGLE_DEG] | point:X,Y,Z | spot:X,Y,Z:DX,DY,DZ:ANGLE_DEG | "
    "rectangle:X,Y,Z:DX,DY,DZ:WIDTH,HEIGHT | disc:X,Y,Z:DX,DY,DZ:RADIUS";

/// A light from its description. Directions need not be unit vectors. Angles in degrees: of a directional
/// light half of what its disc subtends, of a spot from its axis to its border. A rectangle's width runs
/// along direction × (0, 1, 0), or where that is short, direction × (1, 0, 0); its height is perpendicular to
/// both. Throws std::invalid_argument that tells what is wrong and at which part of the text.
shading::Light parse_light(std::string_view text);

/// What parse_light takes; reads back as the same light but for rounding, and an area light's turn about its
/// direction.
std::string format_light(const shading::Light&);

}  // namespace treeline::datasets
