// One number for a colour: how bright it seems.
//
// Source: ITU-R BT.709-6, the primaries of linear sRGB; the weights add up to 1. Known weakness: colours of
// other primaries need other weights.
#pragma once

#include "shading/material.hpp"

namespace treeline::shading::light {

/// In the unit of the colour; linear in it. 1 for white (1, 1, 1).
template <class T>
constexpr T luminance(const geometry::Vec<T, 3>& rgb) {
  return T(0.2126) * rgb[0] + T(0.7152) * rgb[1] + T(0.0722) * rgb[2];
}

}  // namespace treeline::shading::light
